// node picture.mjs INDEX.html OUT.png [WIDTH HEIGHT]: a picture of a page in headless Chromium, as docs/page.png is one.
import {resolve} from 'node:path';
import puppeteer from 'puppeteer-core';

const [index, out, width = '1280', height = '800'] = process.argv.slice(2);
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage();
await page.setViewport({width: Number(width), height: Number(height)});
await page.goto(`file://${resolve(index)}`);
await page.waitForFunction('window.tetropolis');
await new Promise((done) => setTimeout(done, 1000));
await page.screenshot({path: out});
await browser.close();
