// Runs of the program, the page's modules for node, and readers of what the program wrote.
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {build} from 'esbuild';

const program = process.env.TETROPOLIS_PROGRAM ?? fileURLToPath(new URL('../../build/tetropolis', import.meta.url));

export function temporaryFolder(test) {
  const folder = mkdtempSync(join(tmpdir(), 'tetropolis-viewer-'));
  test.after(() => rmSync(folder, {recursive: true, force: true}));
  return folder;
}

export const run = (...args) => execFileSync(program, [...args, '--quiet']);

/** Rectangles (xmin, ymin, xmax, ymax; of synthetic cities, in metres from their corner) of surface layers, by kind. */
function surfaceLayers(folder, surfaces) {
  return Object.entries(surfaces).flatMap(([kind, [a, b, c, d]]) => {
    const path = join(folder, `${kind}.geojson`);
    writeFileSync(path, JSON.stringify({
      type: 'FeatureCollection', crs: {type: 'name', properties: {name: 'urn:ogc:def:crs:EPSG::3006'}},
      features: [{type: 'Feature', properties: {}, geometry: {type: 'Polygon', coordinates: [[[a, b], [c, b], [c, d], [a, d], [a, b]].map(([x, y]) => [319000 + x, 6396000 + y])]}}],
    }));
    return ['--surface-layers', `${path}:${kind}`];
  });
}

/** A synthetic city in `folder`/in, meshed into `folder`/out. */
export function makeCity(folder, {synth = ['--kind', 'blocks', '--size', '300', '--seed', '7'], build = [], surfaces = {}} = {}) {
  const input = join(folder, 'in'), out = join(folder, 'out');
  run('synth', ...synth, '--out', input);
  build = [...build, ...surfaceLayers(input, surfaces)];
  run('build', '--footprints', join(input, 'footprints.shp'), '--points', input, '--id-attribute', 'id', '--out', out, ...build);
  return out;
}

/** A module of the page, made from TypeScript. */
export async function load(folder, source) {
  const outfile = join(folder, source.replaceAll('/', '_') + '.mjs');
  await build({entryPoints: [fileURLToPath(new URL(`../src/${source}`, import.meta.url))], bundle: true,
               format: 'esm', outfile, logLevel: 'error'});
  return import(pathToFileURL(outfile));
}

export const readReport = (out) => JSON.parse(readFileSync(join(out, 'report.json'), 'utf8'));

/** The blocks of data in a page. */
export function readBlocks(out) {
  const html = readFileSync(join(out, 'index.html'), 'utf8');
  return JSON.parse(html.match(/<script id="run" type="application\/json">([^<]*)<\/script>/)[1]);
}

/** Points and cells of a volume.vtu that is not compressed. */
export function readVtu(path) {
  const file = readFileSync(path);
  const start = file.indexOf('<AppendedData');
  const data = file.indexOf('_', start) + 1;
  const header = file.subarray(0, start).toString();
  const wide = /header_type="UInt64"/.test(header) ? 8 : 4;
  const array = (pattern) => {
    const tag = header.match(/<DataArray[^>]*>/g).find((t) => pattern.test(t));
    const type = tag.match(/type="(\w+)"/)[1];
    const offset = data + Number(tag.match(/offset="(\d+)"/)[1]);
    const bytes = wide === 8 ? Number(file.readBigUInt64LE(offset)) : file.readUInt32LE(offset);
    const copy = file.buffer.slice(file.byteOffset + offset + wide, file.byteOffset + offset + wide + bytes);
    return new ({Float64: Float64Array, Int32: Int32Array, Int64: BigInt64Array}[type])(copy);
  };
  return {points: array(/Name="Points"/), cells: array(/Name="connectivity"/)};
}
