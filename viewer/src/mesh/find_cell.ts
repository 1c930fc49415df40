// Which cell is at a place.

import {Climb} from './climb.js';
import {type ColumnMesh, triangleCount, upperCorners, upperCount} from './columns.js';
import {tetCorners} from './quality.js';

/** The corners (twelve numbers) of the cell whose centre is nearest to a place; steps. */
export function findCell(mesh: ColumnMesh, [x, y, z]: readonly number[]): number[] | null {
  const climb = new Climb(mesh), p = new Float64Array(12);
  let best: number[] | null = null, least = Infinity;
  const compare = (): void => {
    const distance = Math.hypot((p[0] + p[3] + p[6] + p[9]) / 4 - x, (p[1] + p[4] + p[7] + p[10]) / 4 - y,
                                (p[2] + p[5] + p[8] + p[11]) / 4 - z);
    if (distance < least) [best, least] = [[...p], distance];
  };
  for (let t = 0; t < triangleCount(mesh); ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => mesh.corners[3 * t + k]);
    const left = (v: number, w: number): boolean =>
        (mesh.x[w] - mesh.x[v]) * (y - mesh.y[v]) - (mesh.y[w] - mesh.y[v]) * (x - mesh.x[v]) >= 0;
    if (!left(a, b) || !left(b, c) || !left(c, a)) continue;
    climb.start(t);
    for (let i; (i = climb.next()) < 3; climb.advance(i)) {
      tetCorners(mesh, climb, i, p);
      compare();
    }
  }
  for (let c = 0; c < upperCount(mesh); ++c) {
    upperCorners(mesh, c, p);
    compare();
  }
  return best;
}
