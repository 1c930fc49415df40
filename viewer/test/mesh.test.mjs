// The page's mesh is that of volume.vtu, its surface that of boundary.vtp, its sections cut them.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {test} from 'node:test';
import {load, makeCity, readBlocks, readReport, readVtu, temporaryFolder} from './support.mjs';

const cities = {
  'blocks': {},
  'fine mesh': {build: ['--mesh-size', '4']},
  'random city on hills': {synth: ['--buildings', '40', '--size', '400', '--relief', '30', '--seed', '3']},
  'uniform layers': {build: ['--layering', 'uniform']},
};

for (const [name, options] of Object.entries(cities)) {
  test(name, async (t) => {
    const folder = temporaryFolder(t);
    const out = makeCity(folder, options);
    const {readColumns, cellCount} = await load(folder, 'mesh/columns.ts');
    const {Climb} = await load(folder, 'mesh/climb.ts');
    const report = readReport(out);
    const blocks = readBlocks(out);
    const mesh = await readColumns(blocks, true);
    const vtu = readVtu(join(out, 'volume.vtu'));

    assert.equal(cellCount(mesh), report.volume_mesh.cells);
    assert.equal(mesh.z.length, report.volume_mesh.vertices);
    let worst = 0;
    for (let v = 0; v < mesh.x.length; ++v)
      for (let n = mesh.first[v]; n < mesh.first[v + 1]; ++n)
        [mesh.x[v], mesh.y[v], mesh.z[n]].forEach((steps, k) => {
          worst = Math.max(worst, Math.abs(steps / 1000 - vtu.points[3 * n + k]));
        });
    assert.ok(worst <= 0.002, `${worst} m off`);

    const climb = new Climb(mesh);
    let next = 0;
    for (let triangle = 0; triangle < mesh.region.length; ++triangle) {
      climb.start(triangle);
      for (let i; (i = climb.next()) < 3; climb.advance(i)) {
        const cell = [climb.at[0], climb.at[1], climb.at[2], climb.at[i] + 1];
        for (let k = 0; k < 4; ++k)
          if (cell[k] !== Number(vtu.cells[next + k])) assert.fail(`cell ${next / 4}: ${cell}`);
        next += 4;
      }
    }
    assert.equal(next, vtu.cells.length);
  });
}
