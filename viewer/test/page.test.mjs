// The page in headless Chromium: it opens from a file, asks for nothing, and does what its controls say.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import puppeteer from 'puppeteer-core';
import {makeCity, readReport, readVtu, run} from './support.mjs';

const folder = mkdtempSync(join(tmpdir(), 'tetropolis-page-'));
const out = makeCity(folder, {surfaces: {water: [-10, 40, 310, 75]}});
const report = readReport(out);
const said = [], asked = [];
const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';
const firefox = process.env.FIREFOX;
let browser, page;

/** Chromium, or the Firefox that the variable names. `plain`: without WebGL. */
const launch = (plain = false) => puppeteer.launch(firefox ? {
  browser: 'firefox', executablePath: firefox, protocolTimeout: 300_000,
  extraPrefsFirefox: plain ? {'webgl.disabled': true} : {'ui.prefersReducedMotion': 1},
} : {
  executablePath: chromium, protocolTimeout: 300_000,
  args: ['--no-sandbox', ...(plain ? ['--disable-3d-apis'] : ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'])],
});

before(async () => {
  browser = await launch();
  page = await browser.newPage();
  await page.setViewport({width: 1200, height: 800});
  if (!firefox) await page.emulateMediaFeatures([{name: 'prefers-reduced-motion', value: 'reduce'}]);
  page.on('console', (message) => { if (['error', 'warn'].includes(message.type())) said.push(message.text()); });
  page.on('pageerror', (error) => said.push(error.message));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) asked.push(request.url()); });
  await page.goto(`file://${join(out, 'index.html')}`);
  await page.waitForFunction('window.tetropolis', {timeout: 120_000});
});

after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
});

const text = (selector) => page.$eval(selector, (element) => element.textContent);
/** Lets what was asked for be drawn. */
const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)))));

/** Of the picture of the city: how many colours, and the mean of red, green and blue. */
async function look() {
  await settle();
  const box = await page.$eval('#stage', (e) => { const {x, y, width, height} = e.getBoundingClientRect(); return {x, y, width, height}; });
  const png = await page.screenshot({encoding: 'base64', clip: {x: box.x + 100, y: box.y + 150, width: box.width - 200, height: box.height - 300}});
  return page.evaluate(async (encoded) => {
    const bytes = Uint8Array.from(atob(encoded), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], {type: 'image/png'}));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const {data} = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const colours = new Set(), mean = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4) {
      colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
      for (let k = 0; k < 3; ++k) mean[k] += data[i + k] / (data.length / 4);
    }
    return {colours: colours.size, mean};
  }, png);
}

const difference = (a, b) => Math.hypot(...a.mean.map((v, k) => v - b.mean[k]));

/** Where a place of the scene (metres) is on the screen. */
const toScreen = (place) => page.evaluate(([x, y, z]) => {
  const {view} = window.tetropolis, box = document.getElementById('city').getBoundingClientRect();
  const p = view.camera.position.clone().set(x, y, z).project(view.camera);
  return [box.x + (p.x + 1) / 2 * box.width, box.y + (1 - p.y) / 2 * box.height];
}, place);

test('opens without a word and without a request', () => {
  assert.deepEqual(said, []);
  assert.deepEqual(asked, []);
});

test('has the mesh of the report', async () => {
  assert.equal(await page.evaluate(() => tetropolis.cells), report.volume_mesh.cells);
  const shown = await text('#panel');
  assert.ok(shown.includes(report.volume_mesh.cells.toLocaleString('en')));
  assert.doesNotMatch(shown, /prism/);
  assert.ok(shown.includes(`${report.volume_mesh.dihedral_deg.min.toFixed(1)}°`));
});

test('shows a city', async () => {
  const {colours} = await look();
  assert.ok(colours > 300, `${colours} colours`);
});

test('picks the building under the pointer', async () => {
  const roofs = await page.evaluate(() => {
    const {view, model} = tetropolis;
    view.flyTo(view.controls.target.clone().set(0, 0, 0), 700, 180, 88, false);
    // The middle of the largest triangle of each roof.
    const {position: p, feature, triangles} = model.surface;
    const best = new Map();
    for (let f = 0; f < triangles; ++f) {
      if ((feature[3 * f] & 3) !== 1) continue;
      const i = 9 * f, building = (feature[3 * f] >> 5) - 1;
      const area = (p[i + 3] - p[i]) * (p[i + 7] - p[i + 1]) - (p[i + 6] - p[i]) * (p[i + 4] - p[i + 1]);
      if (area > (best.get(building)?.area ?? 0))
        best.set(building, {area, building, place: [0, 1, 2].map((k) => (p[i + k] + p[i + 3 + k] + p[i + 6 + k]) / 3)});
    }
    return [...best.values()];
  });
  await settle();
  assert.ok(roofs.length > 20);
  for (const {building, place} of roofs.filter((_, i) => i % 8 === 0)) {
    await page.mouse.click(...(await toScreen(place)));
    assert.match(await text('#building'), new RegExp(`b${building} · `));
    const [x, y] = await toScreen(place);
    const found = await page.evaluate((x, y) => tetropolis.view.pickPlace(x, y)?.toArray(), x, y);
    assert.ok(Math.hypot(...found.map((v, k) => v - place[k])) < 0.5, `${found} for ${place}`);
  }
  // Beside the city there is nothing.
  await page.mouse.click(...(await toScreen([-200, 0, 0])));
  assert.match(await text('#building'), /Click a building/);
});

test('names the surface layer under the pointer', async () => {
  assert.match(await text('#legend'), /ground.*water.*roof/);
  const [x, y] = await toScreen([-140, -90, 0]);
  await page.mouse.click(x, y);
  assert.equal(await text('#tip'), 'water');
  assert.match(await text('#building'), /Click a building/);
});

test('hides what it tells while the city moves', async () => {
  const [x, y] = await toScreen([-140, -90, 0]);
  await page.mouse.move(x, y);
  await page.waitForFunction(() => !document.getElementById('tip').hidden);
  await page.mouse.down();
  await page.mouse.move(x + 60, y, {steps: 4});
  assert.equal(await page.$eval('#tip', (e) => e.hidden), true);
  await page.mouse.up();
  await page.mouse.move(5, 5);
});

test('finds buildings and footprints by their ids', async () => {
  const {footprints, buildings} = await page.evaluate(() => tetropolis.model.facts);
  const find = async (id) => {
    await page.$eval('.find input', (e) => { e.value = ''; });
    await page.type('.find input', id);
    await page.keyboard.press('Enter');
    return text('#building');
  };
  const merged = buildings.findIndex((b) => b.sources.length > 1);
  for (const source of buildings[merged].sources) assert.match(await find(source), new RegExp(`${buildings[merged].id} · `));
  assert.match(await find(buildings[merged].id.toUpperCase()), new RegExp(`${buildings[merged].id} · `));
  const dropped = footprints.find((f) => f.building < 0);
  assert.match(await find(dropped.source), new RegExp(`Footprint ${dropped.source} was dropped: `));
  assert.equal(await page.$eval('#map', (e) => e.hidden), false);
  await page.click('#views [data-value=city]');
  assert.match(await find('no such id'), /Nothing has the id no such id/);
  assert.match(await find(' '), /Click a building/);
});

test('picks what a plane cuts', async () => {
  await page.evaluate(() => tetropolis.view.flyTo(tetropolis.view.controls.target.clone().set(0, 0, 0), 700, 180, 88, false));
  await page.click('#cuts [data-value=z]');
  await settle();
  const cut = await page.evaluate(() => {
    const {view, model} = tetropolis, z = Number(document.getElementById('place').value) - model.frame.centre[2] * model.frame.step;
    const {position: p, feature, triangles} = model.surface;
    const found = new Map();
    for (let f = 0; f < triangles; ++f) {
      if ((feature[3 * f] & 3) !== 1 || ![2, 5, 8].every((k) => p[9 * f + k] > z + 0.5)) continue;
      const centre = [0, 1].map((k) => (p[9 * f + k] + p[9 * f + 3 + k] + p[9 * f + 6 + k]) / 3);
      found.set((feature[3 * f] >> 5) - 1, [...centre, z]);
    }
    return [...found];
  });
  assert.ok(cut.length > 5);
  for (const [building, place] of cut.filter((_, i) => i % 3 === 0)) {
    await page.mouse.click(...(await toScreen(place)));
    assert.match(await text('#building'), new RegExp(`b${building} · `));
  }
  await page.click('#cuts [data-value=off]');
});

test('cuts the cells that are at the plane', async () => {
  const {points, cells} = readVtu(join(out, 'volume.vtu'));
  for (const [axis, name] of ['x', 'y', 'z'].entries()) {
    await page.click(`#cuts [data-value=${name}]`);
    await settle();
    const shown = Number((await text('#cut-count')).replace(/\D/g, ''));
    // Moved a little off nodes, as the page does.
    const at = Math.floor(await page.$eval('#place', (e) => Number(e.value)) * 1000) / 1000 + 0.0005;
    let cut = 0;
    for (let c = 0; c < cells.length; c += 4) {
      const along = [0, 1, 2, 3].map((k) => Math.round(points[3 * Number(cells[c + k]) + axis] * 1000) / 1000);
      if (Math.min(...along) < at && Math.max(...along) > at) ++cut;
    }
    assert.ok(Math.abs(shown - cut) <= 0.002 * cut, `${name}: ${shown} shown, ${cut} cut`);
    assert.ok(cut > 100);
  }
  const whole = await look();
  await page.click('#whole');
  const section = await look();
  assert.ok(whole.colours !== section.colours);
  await page.click('#cuts [data-value=off]');
});

test('changes colours', async () => {
  await page.click('#home');
  const looks = {};
  for (const colours of ['class', 'height', 'quality', 'flags']) {
    await page.click(`#colours [data-value=${colours}]`);
    await new Promise((done) => setTimeout(done, 500));
    looks[colours] = await look();
  }
  for (const [a, b] of [['class', 'height'], ['height', 'quality'], ['quality', 'flags'], ['flags', 'class']])
    assert.ok(difference(looks[a], looks[b]) > 1, `${a} and ${b} look alike`);
  await page.click('#edges');
  assert.ok(difference(looks.flags, await look()) > 0.5, 'no edges');
  await page.click('#edges');
  await page.click('#theme');
  const dark = await look();
  assert.ok(difference(looks.flags, dark) > 3 && dark.mean[1] < looks.flags.mean[1], 'no dark theme');
  await page.click('#theme');
});

test('colours buildings by the height of each place above their ground', async () => {
  await page.click('#colours [data-value=height]');
  const {alphas, grounds, tops, heights, legend} = await page.evaluate(() => ({
    alphas: tetropolis.model.facts.buildings.map((_, b) => tetropolis.view.uniforms.buildings.value.image.data[4 * b + 3]),
    grounds: tetropolis.model.facts.buildings.map((b) => b.ground),
    tops: tetropolis.model.facts.buildings.map((b) => b.top),
    heights: tetropolis.view.uniforms.heights.value.toArray(),
    legend: document.querySelector('#legend').textContent}));
  const low = Math.min(...grounds), range = Math.max(...grounds) - low, most = Math.max(...grounds.map((ground, b) => tops[b] - ground));
  assert.ok(range > 0.1 && Math.abs(heights[1] - range) < 1e-6 && Math.abs(heights[2] - most) < 1e-6, heights);
  grounds.forEach((ground, b) => assert.ok(Math.abs(alphas[b] / 255 * range - (ground - low)) <= range / 255));
  assert.match(legend, new RegExp(`Height above the ground.*${most.toFixed(0)} m`));
  await page.click('#colours [data-value=class]');
});

test('flies to the worst cells', async () => {
  await page.click('#worst button');
  await settle();
  const [x, y] = report.volume_mesh.worst_cells[0].position;
  const found = await page.evaluate(() => {
    const {view} = tetropolis;
    return {marked: view.marked(), target: view.controls.target.toArray()};
  });
  // The mark is the cell: its centre is the one reported.
  const domain = report.domain;
  const centre = [0, 1, 2].map((k) => found.marked.filter((_, i) => i % 3 === k).reduce((a, b) => a + b) / 4);
  assert.ok(Math.abs(centre[0] - (x - (domain[0] + domain[2]) / 2)) < 0.01);
  assert.ok(Math.abs(centre[1] - (y - (domain[1] + domain[3]) / 2)) < 0.01);
  centre.forEach((v, k) => assert.ok(Math.abs(v - found.target[k]) < 0.01));
});

test('tells on the map what became of footprints', async () => {
  await page.click('#views [data-value=map]');
  await settle();
  const box = await page.$eval('#map', (e) => { const {x, y, width, height} = e.getBoundingClientRect(); return {x, y, width, height}; });
  const told = new Set();
  for (let i = 1; i < 12; ++i)
    for (let j = 2; j < 11; ++j) {
      await page.mouse.move(box.x + (i * box.width) / 12, box.y + (j * box.height) / 12);
      if (!(await page.$eval('#tip', (e) => e.hidden))) told.add((await text('#tip')).replace(/[\d.]+/g, '').trim().slice(0, 12));
    }
  assert.ok(told.size > 1, [...told].join('; '));
  await page.click('#views [data-value=city]');
});

test('can be used without a mouse', async () => {
  await page.focus('#city');
  const before = await look();
  for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('-');
  assert.ok(difference(before, await look()) > 0.2);
  await page.keyboard.press('e');
  assert.equal(await page.$eval('#edges', (e) => e.getAttribute('aria-pressed')), 'true');
  await page.click('#colours [data-value=flags]');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.$eval('#colours [aria-checked=true]', (e) => e.dataset.value), 'class');
});

test('follows the theme of the system until one is chosen', {skip: firefox !== undefined}, async () => {
  const other = await browser.newPage();
  const is = (theme) => other.waitForFunction((wanted) => document.documentElement.dataset.theme === wanted, {timeout: 60_000}, theme);
  const system = (value) => other.emulateMediaFeatures([{name: 'prefers-color-scheme', value}]);
  await other.bringToFront();
  await system('dark');
  await other.goto(`file://${join(out, 'index.html')}`);
  await other.evaluate(() => localStorage.clear());
  await other.reload();
  await other.waitForFunction('window.tetropolis', {timeout: 120_000});
  await is('dark');
  await system('light');
  await is('light');
  // Chosen: dark, and dark it stays.
  await other.click('#theme');
  await is('dark');
  await other.evaluate(() => { window.changes = 0; matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => ++window.changes); });
  await system('dark');
  await other.waitForFunction('window.changes === 1', {timeout: 60_000});
  await system('light');
  await other.waitForFunction('window.changes === 2', {timeout: 60_000});
  await is('dark');
  await other.evaluate(() => localStorage.clear());
  await other.close();
});

test('tells what heights rest on, and settings as options, without points', async () => {
  const plain = join(folder, 'plain');
  run('build', '--footprints', join(folder, 'in', 'footprints.shp'), '--id-attribute', 'id', '--out', plain);
  const other = await browser.newPage();
  await other.goto(`file://${join(plain, 'index.html')}`);
  await other.waitForFunction('window.tetropolis', {timeout: 120_000});
  await other.click('#colours [data-value=flags]');
  assert.equal(await other.$eval('#legend', (e) => e.textContent), `roof from attribute${readReport(plain).city.buildings}`);
  await other.evaluate(() => tetropolis.page.select(0, false));
  assert.match(await other.$eval('#building', (e) => e.textContent), /roof from attribute/);
  const warnings = await other.$eval('#warnings', (e) => e.textContent);
  assert.match(warnings, /level at 0 m \(--ground-level\); give a raster with --dtm /);
  assert.match(warnings, /'height' is taken for heights above ground in metres; name another with --height-attribute /);
  await other.close();
});

test('fits on a telephone', async () => {
  await page.setViewport({width: 390, height: 844, hasTouch: true, isMobile: true});
  await page.reload();
  await page.waitForFunction('window.tetropolis', {timeout: 120_000});
  const {scroll, client} = await page.evaluate(() => ({scroll: document.documentElement.scrollWidth, client: document.documentElement.clientWidth}));
  assert.ok(scroll <= client, `${scroll} wide on ${client}`);
  assert.ok((await look()).colours > 100);
});

test('shows map and numbers without WebGL', async () => {
  const plain = await launch(true);
  const other = await plain.newPage();
  await other.goto(`file://${join(out, 'index.html')}`);
  await other.waitForSelector('#panel section');
  assert.match(await other.$eval('#legend', (e) => e.textContent), /merged.*needs WebGL 2/);
  assert.equal(await other.$eval('#map', (e) => e.hidden), false);
  await plain.close();
});

test('has said nothing all the while', () => {
  assert.deepEqual(said, []);
  assert.deepEqual(asked, []);
});
