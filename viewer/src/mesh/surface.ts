// The surface that is looked at: ground, roofs and walls, faces of cells, as extract_boundary of
// src/volume/column/boundary.cpp makes them, but turned to the air; and the sides of the block of
// soil that the ground is the top of.

import {Climb} from './climb.js';
import {type ColumnMesh, prismCount, triangleCount} from './columns.js';
import {type BorderEdges, borderEdges, nextCorner} from './edges.js';

export const enum Kind { ground, roof, wall, soil }

/** Where parts of a feature begin. Of an outline the bit is that of the corner opposite to it. */
export const kOutlineBit = 2, kBuildingBit = 5;

/** Triangles without shared vertices: three entries of all arrays each. */
export interface Surface {
  /** x, y, z in metres, from `centre`. */
  position: Float32Array;
  /** Unit vectors times 127, and the height above the foot of the building in half metres, to 127. */
  normal: Int8Array;
  /** Kind, from kOutlineBit on which of the triangle's edges are outlines, from kBuildingBit on ColumnMesh's regionBuilding plus one. */
  feature: Int32Array;
  /** Per triangle: the ground triangle that its cell stands over. */
  over: Int32Array;
  triangles: number;
}

/** From whole numbers of steps to metres about the middle of the domain. */
export interface Frame {
  step: number;
  /** Steps. */
  centre: [number, number, number];
}

const kNoBuilding = -1;

export class SurfaceBuilder {
  private triangles = 0;
  private readonly surface: Surface;

  /** `foot`: per building, steps. */
  constructor(private readonly mesh: Pick<ColumnMesh, 'x' | 'y'>, private readonly frame: Frame,
              private readonly foot: Int32Array, capacity: number) {
    this.surface = {
      position: new Float32Array(9 * capacity), normal: new Int8Array(12 * capacity),
      feature: new Int32Array(3 * capacity), over: new Int32Array(capacity), triangles: 0,
    };
  }

  /** Vertices va, vb, vc with elevations in steps. */
  add(va: number, za: number, vb: number, zb: number, vc: number, zc: number, kind: Kind,
      building: number, over: number): void {
    const {position, normal, feature} = this.surface;
    const {x, y} = this.mesh, {step, centre} = this.frame;
    const p = 9 * this.triangles;
    position[p] = (x[va] - centre[0]) * step;
    position[p + 1] = (y[va] - centre[1]) * step;
    position[p + 2] = (za - centre[2]) * step;
    position[p + 3] = (x[vb] - centre[0]) * step;
    position[p + 4] = (y[vb] - centre[1]) * step;
    position[p + 5] = (zb - centre[2]) * step;
    position[p + 6] = (x[vc] - centre[0]) * step;
    position[p + 7] = (y[vc] - centre[1]) * step;
    position[p + 8] = (zc - centre[2]) * step;
    const ux = x[vb] - x[va], uy = y[vb] - y[va], uz = zb - za;
    const wx = x[vc] - x[va], wy = y[vc] - y[va], wz = zc - za;
    const nx = uy * wz - uz * wy, ny = uz * wx - ux * wz, nz = ux * wy - uy * wx;
    const scale = 127 / Math.max(Math.hypot(nx, ny, nz), 1e-9);
    const foot = building < 0 ? za : this.foot[building];
    for (let i = 0; i < 3; ++i) {
      const n = 4 * (3 * this.triangles + i);
      normal[n] = Math.round(nx * scale);
      normal[n + 1] = Math.round(ny * scale);
      normal[n + 2] = Math.round(nz * scale);
      normal[n + 3] = Math.min(127, Math.max(0, Math.round(((i === 0 ? za : i === 1 ? zb : zc) - foot) * step * 2)));
      feature[3 * this.triangles + i] = ((building + 1) << kBuildingBit) | kind;
    }
    this.surface.over[this.triangles++] = over;
  }

  /** Draws the edge from corner k of triangle f to the next as an outline. */
  outline(f: number, k: number): void {
    for (let i = 0; i < 3; ++i) this.surface.feature[3 * f + i] |= 1 << (kOutlineBit + (k + 2) % 3);
  }

  /** Makes the ground round: the first triangles have these corners. */
  smoothGround(corners: Int32Array): void {
    const {normal, feature} = this.surface;
    const floors = corners.length / 3;
    const sum = new Float32Array(3 * this.mesh.x.length);
    const isGround = (c: number): boolean => (feature[c] & 3) === Kind.ground;
    for (let c = 0; c < 3 * floors; ++c)
      if (isGround(c)) for (let k = 0; k < 3; ++k) sum[3 * corners[c] + k] += normal[4 * c + k];
    for (let c = 0; c < 3 * floors; ++c) {
      if (!isGround(c)) continue;
      const v = 3 * corners[c], scale = 127 / Math.hypot(sum[v], sum[v + 1], sum[v + 2]);
      for (let k = 0; k < 3; ++k) normal[4 * c + k] = Math.round(sum[v + k] * scale);
    }
  }

  /** Views of what was added. */
  finish(): Surface {
    const n = this.triangles, s = this.surface;
    return {
      position: s.position.subarray(0, 9 * n), normal: s.normal.subarray(0, 12 * n),
      feature: s.feature.subarray(0, 3 * n), over: s.over.subarray(0, n), triangles: n,
    };
  }
}

function addFloors(mesh: ColumnMesh, builder: SurfaceBuilder): void {
  const {corners, floor, z} = mesh;
  for (let t = 0, c = 0; t < triangleCount(mesh); ++t, c += 3) {
    const building = mesh.regionBuilding[mesh.region[t]];
    builder.add(corners[c], z[floor[c]], corners[c + 1], z[floor[c + 1]], corners[c + 2], z[floor[c + 2]],
                building < 0 ? Kind.ground : Kind.roof, building, t);
  }
}

/**
 * Calls visit(lower i, lower j, upper, whether the upper node is over i) for the faces over
 * half-edge c of the cells of its triangle, up to the floor of half-edge `behind`; two for each of a prism.
 * Without cells the lower of the two next nodes goes first.
 */
function forEachWallFace(mesh: ColumnMesh, climb: Climb, c: number, behind: number,
                         visit: (lowI: number, lowJ: number, high: number, overI: boolean) => void): void {
  const t = (c / 3) | 0;
  const i = c % 3, j = (i + 1) % 3;
  const endI = mesh.floor[nextCorner(behind)], endJ = mesh.floor[behind];
  if (mesh.floor[c] >= endI && mesh.floor[nextCorner(c)] >= endJ) return;
  for (let k = 0; k < prismCount(mesh, t); ++k) {
    const lowI = mesh.floor[c] + k, lowJ = mesh.floor[nextCorner(c)] + k;
    if (lowI >= endI && lowJ >= endJ) return;
    visit(lowI, lowJ, lowI + 1, true);
    visit(lowI + 1, lowJ, lowJ + 1, false);
  }
  if (!mesh.hasCells) {
    const {z} = mesh;
    for (let a = mesh.floor[c], b = mesh.floor[nextCorner(c)]; a < endI || b < endJ;) {
      const overI = b >= endJ || (a < endI && z[a + 1] <= z[b + 1]);
      visit(a, b, (overI ? a : b) + 1, overI);
      if (overI) ++a;
      else ++b;
    }
    return;
  }
  climb.start(t);
  while (climb.at[i] < endI || climb.at[j] < endJ) {
    const k = climb.next();
    if (k === i || k === j) visit(climb.at[i], climb.at[j], climb.at[k] + 1, k === i);
    climb.advance(k);
  }
}

function addWalls(mesh: ColumnMesh, edges: BorderEdges, builder: SurfaceBuilder): void {
  const climb = new Climb(mesh);
  const {corners, z, regionBuilding, region} = mesh;
  for (let e = 0; e < edges.between.length; ++e) {
    const c = edges.between[e], behind = edges.between[e ^ 1];
    const vi = corners[c], vj = corners[nextCorner(c)], t = (c / 3) | 0;
    const building = regionBuilding[region[(behind / 3) | 0]];
    forEachWallFace(mesh, climb, c, behind, (lowI, lowJ, high, overI) => {
      builder.add(vj, z[lowJ], vi, z[lowI], overI ? vi : vj, z[high], Kind.wall, building, t);
    });
  }
}

/** Sides of the soil, from the rim of the ground down to `base` (steps). */
function addSoil(mesh: ColumnMesh, edges: BorderEdges, base: number, builder: SurfaceBuilder): void {
  const {corners, floor, z} = mesh;
  for (const c of edges.rim) {
    const d = nextCorner(c), t = (c / 3) | 0;
    const va = corners[c], vb = corners[d], za = z[floor[c]], zb = z[floor[d]];
    builder.add(va, base, vb, base, vb, zb, Kind.soil, kNoBuilding, t);
    builder.add(va, base, vb, zb, va, za, Kind.soil, kNoBuilding, t);
  }
}

/** `base`: elevation of the bottom of the soil, `foot`: of each building's ground; steps. */
export function makeSurface(mesh: ColumnMesh, frame: Frame, base: number, foot: Int32Array): Surface {
  const edges = borderEdges(mesh);
  let capacity = triangleCount(mesh) + 2 * edges.rim.length;
  for (let e = 0; e < edges.between.length; ++e) {
    const c = edges.between[e], behind = edges.between[e ^ 1];
    capacity += Math.max(0, mesh.floor[nextCorner(behind)] - mesh.floor[c]) +
        Math.max(0, mesh.floor[behind] - mesh.floor[nextCorner(c)]);
  }
  const builder = new SurfaceBuilder(mesh, frame, foot, capacity);
  addFloors(mesh, builder);
  builder.smoothGround(mesh.corners);
  for (const c of edges.between) builder.outline((c / 3) | 0, c % 3);
  addWalls(mesh, edges, builder);
  addSoil(mesh, edges, base, builder);
  return builder.finish();
}
