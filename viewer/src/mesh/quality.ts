// The least dihedral angle of tets: src/volume/quality/tet_cosines.h.

import {Climb} from './climb.js';
import {type ColumnMesh, triangleCount} from './columns.js';

const kDegrees = 180 / Math.PI;

/** Of the tet with corners at p[0..2], p[3..5], p[6..8], p[9..11]; degrees. */
export function leastDihedral(p: ArrayLike<number>): number {
  const ax = p[3] - p[0], ay = p[4] - p[1], az = p[5] - p[2];
  const bx = p[6] - p[0], by = p[7] - p[1], bz = p[8] - p[2];
  const cx = p[9] - p[0], cy = p[10] - p[1], cz = p[11] - p[2];
  const dx = bx - ax, dy = by - ay, dz = bz - az;
  const ex = cx - ax, ey = cy - ay, ez = cz - az;
  // Normals of the faces opposite to corners 0 to 3, outwards.
  const n0x = dy * ez - dz * ey, n0y = dz * ex - dx * ez, n0z = dx * ey - dy * ex;
  const n1x = cy * bz - cz * by, n1y = cz * bx - cx * bz, n1z = cx * by - cy * bx;
  const n2x = ay * cz - az * cy, n2y = az * cx - ax * cz, n2z = ax * cy - ay * cx;
  const n3x = by * az - bz * ay, n3y = bz * ax - bx * az, n3z = bx * ay - by * ax;
  const l0 = 1 / Math.sqrt(n0x * n0x + n0y * n0y + n0z * n0z);
  const l1 = 1 / Math.sqrt(n1x * n1x + n1y * n1y + n1z * n1z);
  const l2 = 1 / Math.sqrt(n2x * n2x + n2y * n2y + n2z * n2z);
  const l3 = 1 / Math.sqrt(n3x * n3x + n3y * n3y + n3z * n3z);
  const greatest = Math.max(
      -(n0x * n1x + n0y * n1y + n0z * n1z) * l0 * l1, -(n0x * n2x + n0y * n2y + n0z * n2z) * l0 * l2,
      -(n0x * n3x + n0y * n3y + n0z * n3z) * l0 * l3, -(n1x * n2x + n1y * n2y + n1z * n2z) * l1 * l2,
      -(n1x * n3x + n1y * n3y + n1z * n3z) * l1 * l3, -(n2x * n3x + n2y * n3y + n2z * n3z) * l2 * l3);
  return Math.acos(Math.min(1, Math.max(-1, greatest))) * kDegrees;
}

/** The tet that a climb makes next, by corner i: positions in steps. */
export function tetCorners(mesh: ColumnMesh, climb: Climb, i: number, p: Float64Array): void {
  for (let k = 0; k < 3; ++k) {
    p[3 * k] = mesh.x[climb.vertex[k]];
    p[3 * k + 1] = mesh.y[climb.vertex[k]];
    p[3 * k + 2] = mesh.z[climb.at[k]];
  }
  p[9] = p[3 * i];
  p[10] = p[3 * i + 1];
  p[11] = mesh.z[climb.at[i] + 1];
}

/** Per ground triangle from `begin` to `end` - 1: the least angle of any cell of its columns, degrees. */
export function leastAngles(mesh: ColumnMesh, begin: number, end: number, angles: Float32Array): void {
  const climb = new Climb(mesh);
  const p = new Float64Array(12);
  for (let t = begin; t < Math.min(end, triangleCount(mesh)); ++t) {
    let least = 180;
    climb.start(t);
    for (let i; (i = climb.next()) < 3; climb.advance(i)) {
      tetCorners(mesh, climb, i, p);
      least = Math.min(least, leastDihedral(p));
    }
    angles[t] = least;
  }
}
