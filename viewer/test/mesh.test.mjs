// The page's mesh is that of volume.vtu, its surface that of boundary.vtp, its sections cut them.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {test} from 'node:test';
import {load, makeCity, readBlocks, readReport, readVtu, run, temporaryFolder} from './support.mjs';

const cities = {
  'blocks': {},
  'fine mesh': {build: ['--mesh-size', '4']},
  'random city on hills': {synth: ['--buildings', '40', '--size', '400', '--relief', '30', '--seed', '3']},
  'surface layers': {surfaces: {water: [-10, 40, 310, 75], vegetation: [180, 180, 290, 250]}},
  'layers of prisms': {build: ['--boundary-layers', '5'], surfaces: {water: [-10, 40, 310, 75]}},
  'layers on hills': {synth: ['--buildings', '40', '--size', '400', '--relief', '30', '--seed', '3'], build: ['--boundary-layers', '3', '--first-layer', '0.3']},
  'prisms only': {build: ['--cells', 'prisms']},
  'uniform layers': {build: ['--layering', 'uniform']},
};

const minus = (a, b) => a.map((v, k) => v - b[k]);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
const dot = (a, b) => a.reduce((sum, v, k) => sum + v * b[k], 0);
const kPairs = [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];

/** Of a tet, degrees: between the parts of the other corners' edges that are perpendicular to each edge. */
const leastAngle = (tet) => Math.min(...kPairs.map(([a, b, c, d]) => {
  const along = minus(tet[b], tet[a]);
  const [u, v] = [c, d].map((k) => cross(along, minus(tet[k], tet[a])));
  return Math.acos(dot(u, v) / Math.sqrt(dot(u, u) * dot(v, v))) * 180 / Math.PI;
}));

/** Whether a vertical line meets a tet: it does not where all corners are on one side of it in plan. */
const isOver = (tet, x, y, margin) => {
  const turns = tet.map(([px, py]) => Math.atan2(py - y, px - x)).sort((a, b) => a - b);
  return turns.every((turn, k) => (k < 3 ? turns[k + 1] : turns[0] + 2 * Math.PI) - turn < Math.PI + margin);
};

for (const [name, options] of Object.entries(cities)) {
  test(name, async (t) => {
    const folder = temporaryFolder(t);
    const out = makeCity(folder, options);
    const {readColumns, cellCount, prismCount} = await load(folder, 'mesh/columns.ts');
    const {readText} = await load(folder, 'payload.ts');
    const {Climb} = await load(folder, 'mesh/climb.ts');
    const report = readReport(out);
    const blocks = readBlocks(out);
    const facts = JSON.parse(await readText(blocks, 'facts'));
    const mesh = await readColumns(blocks, facts);
    const vtu = readVtu(join(out, 'volume.vtu'));

    assert.equal(cellCount(mesh), report.volume_mesh.cells);
    assert.equal(facts.cells, report.volume_mesh.cells);
    assert.equal(mesh.z.length + mesh.upper.z.length, report.volume_mesh.vertices);
    // The file numbers nodes of columns, those above, those of layers; the page has layers in columns.
    const open = new Uint8Array(mesh.x.length);
    mesh.corners.forEach((v, c) => { if (mesh.regionBuilding[mesh.region[(c / 3) | 0]] < 0) open[v] = 1; });
    const layered = open.reduce((sum, is) => sum + is * mesh.layers, 0), numbers = [];
    for (let v = 0, own = 0, layer = mesh.z.length - layered + mesh.upper.z.length; v < mesh.x.length; ++v)
      for (let n = mesh.first[v]; n < mesh.first[v + 1]; ++n)
        numbers.push(n - mesh.first[v] < open[v] * mesh.layers ? layer++ : own++);
    for (let i = 0; i < mesh.upper.z.length; ++i) numbers.push(mesh.z.length - layered + i);
    let worst = 0;
    const compare = (n, ...place) => place.forEach((steps, k) => {
      worst = Math.max(worst, Math.abs(steps / 1000 - vtu.points[3 * numbers[n] + k]));
    });
    for (let v = 0; v < mesh.x.length; ++v)
      for (let n = mesh.first[v]; n < mesh.first[v + 1]; ++n) compare(n, mesh.x[v], mesh.y[v], mesh.z[n]);
    mesh.upper.z.forEach((z, i) => {
      const v = mesh.upper.vertex[mesh.z.length + i];
      compare(mesh.z.length + i, mesh.x[v], mesh.y[v], z);
    });
    assert.ok(worst <= 0.002, `${worst} m off`);

    const climb = new Climb(mesh);
    let next = 0;
    for (let triangle = 0; triangle < mesh.region.length; ++triangle) {
      climb.start(triangle);
      for (let i; (i = climb.next()) < 3; climb.advance(i)) {
        const cell = [climb.at[0], climb.at[1], climb.at[2], climb.at[i] + 1].map((n) => numbers[n]);
        for (let k = 0; k < 4; ++k)
          if (cell[k] !== Number(vtu.cells[next + k])) assert.fail(`cell ${next / 4}: ${cell}`);
        next += 4;
      }
    }
    // Those above in an order of their own.
    const prisms = report.volume_mesh.prisms?.cells ?? 0, endOfTets = vtu.cells.length - 6 * prisms;
    const sorted = (cells, map = Number) => Array.from({length: cells.length / 4}, (_, c) => [...cells.subarray(4 * c, 4 * c + 4)].map(map).sort((a, b) => a - b).join(' ')).sort();
    const above = sorted(mesh.upper.cells, (n) => numbers[n]);
    if (!/uniform|only/.test(name)) assert.ok(above.length > 1000);
    assert.deepEqual(above, sorted(vtu.cells.subarray(next, endOfTets)));
    next = endOfTets;
    for (let triangle = 0; triangle < mesh.region.length; ++triangle)
      for (let n = 0; n < prismCount(mesh, triangle); ++n, next += 6) {
        const floor = [0, 2, 1].map((k) => mesh.floor[3 * triangle + k] + n);  // VTK's order
        const cell = [...floor, ...floor.map((node) => node + 1)].map((node) => numbers[node]);
        for (let k = 0; k < 6; ++k)
          if (cell[k] !== Number(vtu.cells[next + k])) assert.fail(`prism ${next}: ${cell}`);
      }
    assert.equal(next, vtu.cells.length);
    assert.equal(prisms > 0, /prisms|hills$/.test(name) && options.build !== undefined);

    // The surface has the faces of the boundary.
    const {makeSurface} = await load(folder, 'mesh/surface.ts');
    const frame = {step: 0.001, centre: [0, 0, 0]};
    const surface = makeSurface(mesh, frame, -10000, new Int32Array(report.city.buildings));
    const kinds = [0, 0, 0, 0], ground = [0, 0, 0, 0];
    for (let f = 0; f < surface.triangles; ++f) {
      const kind = surface.feature[3 * f] & 3;
      ++kinds[kind];
      if (kind === 0) ++ground[-(surface.feature[3 * f] >> 5)];
    }
    const faces = report.surface_mesh.faces_by_patch;
    assert.equal(kinds[1], faces.roof);
    // Sides of prisms are one face each there.
    if (prisms === 0) assert.equal(kinds[2], faces.wall);
    assert.deepEqual(ground, ['ground', 'water', 'road', 'vegetation'].map((patch) => faces[patch] ?? 0));
    assert.equal(ground[1] > 0, 'surfaces' in options);

    // What is painted on a triangle is the least angle of the tets over its centre.
    const {leastAnglesOver} = await load(folder, 'mesh/quality.ts');
    const angles = await leastAnglesOver(mesh, async () => {});
    const tets = Array.from({length: endOfTets / 4}, (_, c) => [0, 1, 2, 3].map((k) => {
      const n = 3 * Number(vtu.cells[4 * c + k]);
      return [vtu.points[n], vtu.points[n + 1], vtu.points[n + 2]];
    }));
    for (let n = 0; n < 40; ++n) {
      const t = Math.floor(n * mesh.region.length / 40);
      const [x, y] = [mesh.x, mesh.y].map((along) => [0, 1, 2].reduce((sum, k) => sum + along[mesh.corners[3 * t + k]], 0) / 3000);
      // Cells that the line touches may count or not.
      const near = tets.filter((tet) => Math.min(...tet.map((p) => p[0])) <= x + 0.1 && Math.max(...tet.map((p) => p[0])) >= x - 0.1);
      const [least, most] = [2e-3, -2e-3].map((margin) => Math.min(180, ...near.filter((tet) => isOver(tet, x, y, margin)).map(leastAngle)));
      assert.ok(angles[t] > least - 0.5 && angles[t] < most + 0.5, `triangle ${t}: ${angles[t]}, not ${least} to ${most}`);
    }

    // A section and the solids below it have the area of what they cut.
    const {cutCells, cutSolids} = await load(folder, 'mesh/section.ts');
    const areaOf = ({position: p}) => {
      let sum = 0;
      for (let i = 0; i < p.length; i += 9) {
        const [u, v] = [0, 1, 2].map((k) => [p[i + 3 + k] - p[i + k], p[i + 6 + k] - p[i + k]]).reduce(([a, b], [c, d]) => [[...a, c], [...b, d]], [[], []]);
        sum += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
      }
      return sum;
    };
    const [width, depth] = [report.domain[2] - report.domain[0], report.domain[3] - report.domain[1]];
    const low = -20, top = report.volume_mesh.top;
    for (const [axis, at, area] of [['x', width / 3, depth * (top - low)], ['y', depth / 3, width * (top - low)], ['z', 12.3, width * depth]]) {
      const cells = cutCells(mesh, frame, {axis, at}, false);
      const whole = areaOf(cells) + areaOf(cutSolids(mesh, frame, {axis, at}, low / frame.step, new Int32Array(report.city.buildings)));
      assert.ok(Math.abs(whole - area) < 1e-4 * area, `${axis}: ${whole} m² of ${area}`);
      assert.equal(cutCells(mesh, frame, {axis, at}, true).cells, cells.cells);
    }
  });
}

// Ground, roofs and walls of a city that is not meshed close its block of soil: their faces add up to the domain.
test('city without a mesh', async (t) => {
  const folder = temporaryFolder(t), input = join(folder, 'in'), out = join(folder, 'out');
  run('synth', '--kind', 'blocks', '--size', '400', '--roofs', 'sloped', '--relief', '20', '--seed', '1', '--out', input);
  run('city', '--footprints', join(input, 'footprints.shp'), '--points', input, '--out', out);
  const {readModel} = await load(folder, 'model.ts');
  const {facts, mesh, surface} = await readModel(readBlocks(out));
  assert.ok(mesh !== null && !facts.volume && facts.cells === 0);
  const sum = [0, 0, 0];
  let roofs = 0, highest = -Infinity;
  for (let f = 0; f < surface.triangles; ++f) {
    const [a, b, c] = [0, 3, 6].map((k) => Array.from(surface.position.subarray(9 * f + k, 9 * f + k + 3)));
    cross(minus(b, a), minus(c, a)).forEach((v, k) => { sum[k] += v / 2; });
    if ((surface.feature[3 * f] & 3) !== 1) continue;
    if (new Set([a[2], b[2], c[2]]).size > 1) ++roofs;
    highest = Math.max(highest, a[2], b[2], c[2]);
  }
  const [xmin, ymin, xmax, ymax] = facts.domain, area = (xmax - xmin) * (ymax - ymin);
  [0, 0, area].forEach((of, k) => assert.ok(Math.abs(sum[k] - of) < 1e-5 * area, `${sum}, not 0, 0, ${area}`));
  assert.ok(roofs > 50, `${roofs} sloped triangles of roofs`);
  const low = Math.min(...Array.from(mesh.floor, (node) => mesh.z[node])) / 1000;
  const top = Math.max(...facts.buildings.map((b) => b.top));
  assert.ok(Math.abs(highest + low - top) < 0.3, `${highest + low} m, not ${top}`);
});
