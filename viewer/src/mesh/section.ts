// What a plane cuts: the cells of the air, and the soil and the buildings below it.

import {Climb} from './climb.js';
import {type ColumnMesh, isUpperCrossed, prismCount, triangleCount, upperCorners, upperCount} from './columns.js';
import {leastDihedral, tetCorners} from './quality.js';
import type {Frame} from './surface.js';

export type Axis = 'x' | 'y' | 'z';

/** Perpendicular to an axis, at a place in metres, local frame. */
export interface Plane {
  axis: Axis;
  at: number;
}

/** Triangles (nine numbers each, metres about the frame's centre). */
export interface CutCells {
  position: Float32Array;
  /** Per vertex: the least dihedral angle of its cell, degrees; kPrism in prisms. */
  angle: Float32Array;
  /** Edges of cells in the plane, or of whole cells: six numbers each. */
  lines: Float32Array;
  cells: number;
}

export const kPrism = -1;

export interface CutSolids {
  position: Float32Array;
  /** Per vertex: the building, -1 of soil. */
  building: Int32Array;
}

const kSoil = -1;

/** Grows by doubling. */
class Floats {
  private values = new Float32Array(3072);
  length = 0;
  push(a: number, b: number, c: number): void {
    if (this.length + 3 > this.values.length) this.values = this.grown();
    this.values[this.length++] = a;
    this.values[this.length++] = b;
    this.values[this.length++] = c;
  }
  private grown(): Float32Array<ArrayBuffer> {
    const larger = new Float32Array(2 * this.values.length);
    larger.set(this.values);
    return larger;
  }
  get(): Float32Array { return this.values.subarray(0, this.length); }
}

/** Elevation or coordinate in steps that no node has exactly, so that all lie on one side. */
const inSteps = (frame: Frame, metres: number): number => Math.floor(metres / frame.step) + 0.5;

const kTetFaces = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]] as const;
const kTetEdges = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]] as const;
const kPrismFaces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]] as const;
const kPrismEdges = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]] as const;
const kPrismSides: readonly (readonly number[])[] = [[0, 1, 2], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]];
const kTetsOfPrism = [[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]] as const;

class CellCutter {
  readonly position = new Floats();
  readonly lines = new Floats();
  readonly angle = new Floats();
  cells = 0;
  /** Of the tet at hand, in steps. */
  readonly p = new Float64Array(12);
  /** Of the prism: the three corners below, then those above. */
  readonly prism = new Float64Array(18);
  private readonly d = new Float64Array(6);
  private readonly cut = new Float64Array(12);

  constructor(private readonly frame: Frame, private readonly axis: number,
              private readonly place: number, private readonly whole: boolean) {}

  /** Adds what the plane cuts of the tet, or all of it. */
  add(): void {
    const {p, d} = this;
    let below = 0;
    for (let k = 0; k < 4; ++k) {
      d[k] = p[3 * k + this.axis] - this.place;
      if (d[k] < 0) below |= 1 << k;
    }
    if (below === 0 || below === 15) return;
    ++this.cells;
    const angle = leastDihedral(p);
    if (this.whole) this.addWhole(p, kTetFaces, kTetEdges, angle);
    else this.addCut(below, angle, true);
  }

  /** The same with the prism. */
  addPrism(): void {
    const {p, prism, d} = this;
    let below = 0;
    for (let k = 0; k < 6; ++k) if (prism[3 * k + this.axis] < this.place) below |= 1 << k;
    if (below === 0 || below === 63) return;
    ++this.cells;
    if (this.whole) return this.addWhole(prism, kPrismFaces, kPrismEdges, kPrism);
    for (const tet of kTetsOfPrism) {
      let tetBelow = 0;
      tet.forEach((corner, k) => {
        for (let i = 0; i < 3; ++i) p[3 * k + i] = prism[3 * corner + i];
        d[k] = p[3 * k + this.axis] - this.place;
        if (d[k] < 0) tetBelow |= 1 << k;
      });
      if (tetBelow !== 0 && tetBelow !== 15) this.addCut(tetBelow, kPrism, false);
    }
    // A side has two corners on either side of the plane or none.
    for (let k = 0; k < 6; ++k) d[k] = prism[3 * k + this.axis] - this.place;
    for (const side of kPrismSides) {
      let n = 0;
      side.forEach((a, i) => {
        const b = side[(i + 1) % side.length];
        if (d[a] < 0 !== d[b] < 0) this.cross(prism, n++, a, b);
      });
      if (n === 2) this.line(this.cut, 0, 1);
    }
  }

  private addWhole(p: Float64Array, faces: readonly (readonly [number, number, number])[],
                   edges: readonly (readonly [number, number])[], angle: number): void {
    for (const face of faces) {
      for (const corner of face) this.vertex(p, corner);
      this.angle.push(angle, angle, angle);
    }
    for (const [a, b] of edges) this.line(p, a, b);
  }

  private addCut(below: number, angle: number, outlined: boolean): void {
    // The corners below, then those above; neighbours in the polygon share one of the ends.
    const low: number[] = [], high: number[] = [];
    for (let k = 0; k < 4; ++k) (below & (1 << k) ? low : high).push(k);
    let n = 0;
    if (low.length === 2) {
      this.cross(this.p, n++, low[0], high[0]);
      this.cross(this.p, n++, low[0], high[1]);
      this.cross(this.p, n++, low[1], high[1]);
      this.cross(this.p, n++, low[1], high[0]);
    } else {
      for (const a of low) for (const b of high) this.cross(this.p, n++, a, b);
    }
    for (let k = 1; k + 1 < n; ++k) {
      this.vertex(this.cut, 0);
      this.vertex(this.cut, k);
      this.vertex(this.cut, k + 1);
      this.angle.push(angle, angle, angle);
    }
    for (let k = 0; outlined && k < n; ++k) this.line(this.cut, k, (k + 1) % n);
  }

  /** Where the plane crosses the edge from a to b. */
  private cross(p: Float64Array, n: number, a: number, b: number): void {
    const {d, cut} = this;
    const s = d[a] / (d[a] - d[b]);
    for (let k = 0; k < 3; ++k) cut[3 * n + k] = p[3 * a + k] + s * (p[3 * b + k] - p[3 * a + k]);
  }

  private vertex(p: Float64Array, k: number, into = this.position): void {
    const {step, centre} = this.frame;
    into.push((p[3 * k] - centre[0]) * step, (p[3 * k + 1] - centre[1]) * step,
              (p[3 * k + 2] - centre[2]) * step);
  }

  private line(p: Float64Array, a: number, b: number): void {
    this.vertex(p, a, this.lines);
    this.vertex(p, b, this.lines);
  }

  get(): CutCells {
    return {position: this.position.get(), angle: this.angle.get(), lines: this.lines.get(), cells: this.cells};
  }
}

/** Whether corners of triangle t lie on both sides of a vertical plane. */
function isCrossed(mesh: ColumnMesh, along: Int32Array, t: number, place: number): boolean {
  const a = along[mesh.corners[3 * t]] < place;
  return a !== along[mesh.corners[3 * t + 1]] < place || a !== along[mesh.corners[3 * t + 2]] < place;
}

/** The cells that the plane cuts: polygons in the plane, or the cells `whole`. */
export function cutCells(mesh: ColumnMesh, frame: Frame, plane: Plane, whole: boolean): CutCells {
  const place = inSteps(frame, plane.at);
  const axis = 'xyz'.indexOf(plane.axis);
  const cutter = new CellCutter(frame, axis, place, whole);
  const climb = new Climb(mesh);
  const along = plane.axis === 'x' ? mesh.x : mesh.y;
  for (let t = 0; t < triangleCount(mesh); ++t) {
    if (plane.axis !== 'z' && !isCrossed(mesh, along, t, place)) continue;
    for (let n = 0; n < prismCount(mesh, t); ++n) {
      for (let k = 0; k < 3; ++k) {
        const v = mesh.corners[3 * t + k], node = mesh.floor[3 * t + k] + n;
        for (const [corner, z] of [[k, mesh.z[node]], [k + 3, mesh.z[node + 1]]]) {
          cutter.prism[3 * corner] = mesh.x[v];
          cutter.prism[3 * corner + 1] = mesh.y[v];
          cutter.prism[3 * corner + 2] = z;
        }
      }
      cutter.addPrism();
    }
    if (plane.axis === 'z') climb.startBelow(t, place);
    else climb.start(t);
    for (let i; (i = climb.next()) < 3; climb.advance(i)) {
      if (plane.axis === 'z' && Math.min(mesh.z[climb.at[0]], mesh.z[climb.at[1]], mesh.z[climb.at[2]]) > place)
        break;
      tetCorners(mesh, climb, i, cutter.p);
      cutter.add();
    }
  }
  for (let c = 0; c < upperCount(mesh); ++c) {
    if (!isUpperCrossed(mesh, c, axis, place)) continue;
    upperCorners(mesh, c, cutter.p);
    cutter.add();
  }
  return cutter.get();
}

/** What the plane cuts of soil and buildings: down to `base` (steps). `ground`: per building, steps. */
export function cutSolids(mesh: ColumnMesh, frame: Frame, plane: Plane, base: number,
                          ground: Int32Array): CutSolids {
  const position = new Floats();
  const buildings: number[] = [];
  const {step, centre} = frame;
  const place = inSteps(frame, plane.at);
  const vertex = (x: number, y: number, z: number): void =>
      position.push((x - centre[0]) * step, (y - centre[1]) * step, (z - centre[2]) * step);
  type Point = readonly [number, number, number];
  const polygon = (points: readonly Point[], what: number): void => {
    for (let k = 1; k + 1 < points.length; ++k)
      for (const p of [points[0], points[k], points[k + 1]]) {
        vertex(...p);
        buildings.push(what);
      }
  };
  const {x, y, z, corners, floor} = mesh;
  const along = plane.axis === 'x' ? x : y;
  for (let t = 0; t < triangleCount(mesh); ++t) {
    const building = mesh.regionBuilding[mesh.region[t]];
    const corner = (k: number): Point =>
        [x[corners[3 * t + k]], y[corners[3 * t + k]], z[floor[3 * t + k]]];
    if (plane.axis === 'z') {
      // The part of the floor above the plane, seen from above: what is cut of it is solid.
      const points: Point[] = [];
      for (let k = 0; k < 3; ++k) {
        const a = corner(k), b = corner((k + 1) % 3);
        if (a[2] > place) points.push([a[0], a[1], place]);
        if (a[2] > place !== b[2] > place) {
          const s = (place - a[2]) / (b[2] - a[2]);
          points.push([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), place]);
        }
      }
      if (points.length > 2)
        polygon(points, building >= 0 && ground[building] < place ? building : kSoil);
    } else if (isCrossed(mesh, along, t, place)) {
      const ends: Point[] = [];
      for (let k = 0; k < 3; ++k) {
        let a = corner(k), b = corner((k + 1) % 3);
        let da = (plane.axis === 'x' ? a[0] : a[1]) - place, db = (plane.axis === 'x' ? b[0] : b[1]) - place;
        if (da < 0 === db < 0) continue;
        // From below, so that the triangle beside comes to the same number.
        if (da > 0) [a, b, da, db] = [b, a, db, da];
        const s = da / (da - db);
        ends.push([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])]);
      }
      const [p, q] = ends;
      const upright = (lowP: number, lowQ: number, highP: number, highQ: number, what: number): void =>
          polygon([[p[0], p[1], lowP], [q[0], q[1], lowQ], [q[0], q[1], highQ], [p[0], p[1], highP]], what);
      if (building < 0) {
        upright(base, base, p[2], q[2], kSoil);
      } else {
        const foot = Math.max(base, Math.min(ground[building], p[2], q[2]));
        upright(base, base, foot, foot, kSoil);
        upright(foot, foot, p[2], q[2], building);
      }
    }
  }
  return {position: position.get(), building: Int32Array.from(buildings)};
}
