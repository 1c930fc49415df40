// node build.mjs [--check]: makes dist/viewer.html, one file with all of the page but its data, and after
// a mark its program, packed as src/io/page packs the data; with --check compares it with the one that is
// there instead.
import {readFile, writeFile} from 'node:fs/promises';
import {fileURLToPath} from 'node:url';
import {deflateSync, inflateSync} from 'node:zlib';
import {build} from 'esbuild';

const at = (path) => fileURLToPath(new URL(path, import.meta.url));

const bundled = async (entry, options = {}) => {
  const {outputFiles} = await build({
    entryPoints: [at(entry)], bundle: true, minify: true, write: false, target: 'es2022',
    legalComments: 'none', ...options,
  });
  return outputFiles[0].text.trim();
};

const [page, style, code, licence] = await Promise.all([
  readFile(at('src/page.html'), 'utf8'),
  bundled('src/style.css'),
  bundled('src/main.ts', {format: 'iife'}),
  readFile(at('node_modules/three/LICENSE'), 'utf8'),
]);
const notice = `three.js, which is part of this page:\n\n${licence.trim()}\n`;
const parts = {STYLE: style, LICENCE: notice};
const shell = page.replace(/@@(STYLE|LICENCE)@@/g, (_, name) => parts[name]);

const target = at('dist/viewer.html');
if (process.argv.includes('--check')) {
  // Other versions of zlib pack the same program into other bytes.
  const there = await readFile(target, 'utf8');
  const packed = there.startsWith(shell) ? there.slice(shell.length) : '';
  if (packed === '' || inflateSync(Buffer.from(packed, 'base64')).toString() !== code) {
    console.error('viewer: dist/viewer.html is not what its sources make; run npm run build');
    process.exit(1);
  }
} else {
  await writeFile(target, shell + deflateSync(code, {level: 9}).toString('base64'));
}
