// The least dihedral angle of tets: src/volume/quality/tet_cosines.h.

import {Climb} from './climb.js';
import {type ColumnMesh, triangleCount, upperCorners, upperCount} from './columns.js';

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

/** Per ground triangle from `begin` to `end` - 1: the least angle of any tet of its stack, degrees. */
function leastAngles(mesh: ColumnMesh, begin: number, end: number, angles: Float32Array): void {
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

/** Whether a place lies in what corners i, j and k of the tet span in plan; never if that is nothing. */
function spans(p: ArrayLike<number>, i: number, j: number, k: number, x: number, y: number): boolean {
  const ax = p[i] - x, ay = p[i + 1] - y, bx = p[j] - x, by = p[j + 1] - y, cx = p[k] - x, cy = p[k + 1] - y;
  // Twice the areas of triangles of two corners and the place.
  const ab = ax * by - ay * bx, bc = bx * cy - by * cx, ca = cx * ay - cy * ax;
  return Math.abs(ab + bc + ca) >= 1 && ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0));
}

/** Whether a place lies in what the tet covers in plan. */
const covers = (p: ArrayLike<number>, x: number, y: number): boolean =>
    spans(p, 0, 3, 6, x, y) || spans(p, 0, 3, 9, x, y) || spans(p, 3, 6, 9, x, y) || spans(p, 6, 0, 9, x, y);

/** Ground triangles by their centres, in squares of a grid. */
class Centres {
  private readonly x: Float64Array;
  private readonly y: Float64Array;
  private readonly low: [number, number] = [Infinity, Infinity];
  private readonly size: number;
  private readonly columns: number;
  private readonly rows: number;
  /** Per square, and one more: it has the triangles first[s] to first[s + 1] - 1 of `sorted`. */
  private readonly first: Int32Array;
  private readonly sorted: Int32Array;

  constructor({x, y, corners}: ColumnMesh) {
    const count = corners.length / 3;
    const centre = (along: Int32Array): Float64Array => Float64Array.from(
        {length: count}, (_, t) => (along[corners[3 * t]] + along[corners[3 * t + 1]] + along[corners[3 * t + 2]]) / 3);
    this.x = centre(x);
    this.y = centre(y);
    const high = [-Infinity, -Infinity];
    for (let t = 0; t < count; ++t)
      [this.x[t], this.y[t]].forEach((value, k) => {
        this.low[k] = Math.min(this.low[k], value);
        high[k] = Math.max(high[k], value);
      });
    const [width, height] = [high[0] - this.low[0], high[1] - this.low[1]];
    this.size = Math.max(1, Math.sqrt(width * height / Math.max(1, count)));
    this.columns = Math.floor(width / this.size) + 1;
    this.rows = Math.floor(height / this.size) + 1;
    const square = (t: number): number => this.row(this.y[t]) * this.columns + this.column(this.x[t]);
    this.first = new Int32Array(this.columns * this.rows + 1);
    for (let t = 0; t < count; ++t) ++this.first[square(t) + 1];
    for (let s = 0; s + 1 < this.first.length; ++s) this.first[s + 1] += this.first[s];
    this.sorted = new Int32Array(count);
    const next = this.first.slice();
    for (let t = 0; t < count; ++t) this.sorted[next[square(t)]++] = t;
  }

  private column(x: number): number { return Math.min(this.columns - 1, Math.max(0, Math.floor((x - this.low[0]) / this.size))); }
  private row(y: number): number { return Math.min(this.rows - 1, Math.max(0, Math.floor((y - this.low[1]) / this.size))); }

  /** Calls `visit` for each triangle whose centre the tet covers. */
  visit(p: ArrayLike<number>, visit: (triangle: number) => void): void {
    const from = this.column(Math.min(p[0], p[3], p[6], p[9])), to = this.column(Math.max(p[0], p[3], p[6], p[9]));
    const last = this.row(Math.max(p[1], p[4], p[7], p[10]));
    for (let row = this.row(Math.min(p[1], p[4], p[7], p[10])); row <= last; ++row)
      for (let i = this.first[row * this.columns + from]; i < this.first[row * this.columns + to + 1]; ++i) {
        const t = this.sorted[i];
        if (covers(p, this.x[t], this.y[t])) visit(t);
      }
  }
}

/** Per ground triangle: the least angle of any cell over its centre, degrees; pauses now and then. */
export async function leastAnglesOver(mesh: ColumnMesh, pause: () => Promise<void>): Promise<Float32Array> {
  const triangles = triangleCount(mesh), angles = new Float32Array(triangles);
  for (let t = 0; t < triangles; t += 256) {
    leastAngles(mesh, t, t + 256, angles);
    await pause();
  }
  const centres = new Centres(mesh), p = new Float64Array(12);
  for (let c = 0; c < upperCount(mesh); ++c) {
    upperCorners(mesh, c, p);
    const angle = leastDihedral(p);
    centres.visit(p, (t) => { angles[t] = Math.min(angles[t], angle); });
    if (c % 256 === 0) await pause();
  }
  return angles;
}
