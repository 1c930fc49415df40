// The mesh as columns over ground triangles: include/tetropolis/volume/column/column_mesh.h,
// rebuilt from the blocks that src/io/page/page_columns.h describes.

import type {Facts} from '../facts.js';
import {addUp, type Blocks, inflate, readIntegers} from '../payload.js';
import {climbUpper, noUpper, type UpperMesh} from './upper.js';

/** Lengths are whole numbers of steps (millimetres), local frame. */
export interface ColumnMesh {
  x: Int32Array;
  y: Int32Array;
  /** Three per triangle, counter-clockwise. */
  corners: Int32Array;
  /** Per triangle. */
  region: Int32Array;
  /** Per region: its building, -1 for open ground, -2 - k for surface layers of kind k (kSurfaceKinds). */
  regionBuilding: Int32Array;
  /** Per vertex, and one more: its column has the nodes first[v] to first[v + 1] - 1. */
  first: Int32Array;
  /** Per node, upwards in each column. */
  z: Int32Array;
  /** Per corner of each triangle: the node that the triangle's stack starts at. */
  floor: Int32Array;
  /** Per triangle: where its steps are, -1 where elevations tell them. */
  oddStart: Int32Array | null;
  steps: Uint8Array;
  /** Stacks over open ground begin with so many prisms, or (`whole`) all consist of prisms. */
  layers: number;
  whole: boolean;
  upper: UpperMesh;
  /** Or columns have the floors of their regions alone. */
  hasCells: boolean;
}

/** include/tetropolis/ground/surfaces.h */
export const kSurfaceKinds = ['water', 'road', 'vegetation'] as const;

export const triangleCount = (mesh: ColumnMesh): number => mesh.region.length;

/** The regions around each vertex: those of its triangles, ascending. */
interface VertexRegions {
  first: Int32Array;
  regions: Int32Array;
}

function regionsAtVertices(vertices: number, corners: Int32Array, region: Int32Array): VertexRegions {
  const one = new Int32Array(vertices).fill(-1);
  const several = new Map<number, number[]>();
  for (let c = 0; c < corners.length; ++c) {
    const v = corners[c], r = region[(c / 3) | 0];
    if (one[v] === -1) {
      one[v] = r;
    } else if (one[v] !== r) {
      const list = several.get(v);
      if (list === undefined) several.set(v, [one[v], r]);
      else if (!list.includes(r)) list.push(r);
    }
  }
  const first = new Int32Array(vertices + 1);
  for (let v = 0; v < vertices; ++v) first[v + 1] = first[v] + (several.get(v)?.length ?? 1);
  const regions = new Int32Array(first[vertices]);
  for (let v = 0; v < vertices; ++v) regions[first[v]] = one[v];
  for (const [v, list] of several) regions.set(list.sort((a, b) => a - b), first[v]);
  return {first, regions};
}

/** Position of each region's floor in the column, in the order of `around`. */
function floorPositions(around: VertexRegions, told: Int32Array): Int32Array {
  const floors = new Int32Array(around.regions.length);
  for (let v = 0, next = 0; v + 1 < around.first.length; ++v)
    if (around.first[v + 1] - around.first[v] > 1)
      for (let i = around.first[v]; i < around.first[v + 1]; ++i) floors[i] = told[next++];
  return floors;
}

/** Elevations from what is left of them, in place. `withTop`: columns end at a top. */
function addElevations(mesh: ColumnMesh, around: VertexRegions, floors: Int32Array, roof: Int32Array,
                       withTop: boolean): void {
  const {first, z, regionBuilding, whole} = mesh;
  let ground = 0, top = 0, thickness = 0;
  // By number of prisms between two anchors: heights above the lower one, those met last.
  const shapes = new Map<number, Int32Array>();
  const anchors: number[] = [];
  for (let v = 0; v + 1 < first.length; ++v) {
    const begin = first[v], last = first[v + 1] - 1 - begin;
    const low = around.first[v], high = around.first[v + 1];
    anchors.length = 0;
    for (let i = low; i < high; ++i) if (!anchors.includes(floors[i])) anchors.push(floors[i]);
    if (withTop && !anchors.includes(last)) anchors.push(last);
    let layers = 0;
    for (let i = low; i < high; ++i) if (regionBuilding[around.regions[i]] < 0) layers = mesh.layers;
    if (withTop && !whole && !anchors.includes(layers)) anchors.push(layers);
    anchors.sort((a, b) => a - b);
    for (const anchor of anchors) {
      let roofRegion = -1, isFloor = false;
      for (let i = low; i < high && roofRegion < 0; ++i) {
        if (floors[i] !== anchor) continue;
        isFloor = true;
        if (regionBuilding[around.regions[i]] >= 0) roofRegion = around.regions[i];
      }
      const node = begin + anchor;
      if (roofRegion >= 0) z[node] += roof[roofRegion];
      else if (isFloor) ground = z[node] += ground;
      else if (anchor === layers && !whole) z[node] = z[begin] + (thickness += z[node]);
      else top = z[node] += top;
    }
    for (let a = 0; a + 1 < anchors.length; ++a) {
      const n = anchors[a + 1] - anchors[a];
      const from = z[begin + anchors[a]], rise = z[begin + anchors[a + 1]] - from;
      if (!whole && anchors[a] >= layers) {
        for (let k = 1; k < n; ++k)
          z[begin + anchors[a] + k] += from + Math.floor((2 * rise * k + n) / (2 * n));
        continue;
      }
      let shape = shapes.get(n);
      if (shape === undefined) shapes.set(n, shape = Int32Array.from({length: n + 1}, (_, k) => k));
      const all = Math.max(1, shape[n]);
      for (let k = 1; k < n; ++k)
        shape[k] = (z[begin + anchors[a] + k] += from + Math.floor((2 * rise * shape[k] + all) / (2 * all))) - from;
      shape[n] = rise;
    }
  }
}

function floorNodes(mesh: ColumnMesh, around: VertexRegions, floors: Int32Array): Int32Array {
  const {corners, region, first} = mesh;
  const nodes = new Int32Array(corners.length);
  for (let c = 0; c < corners.length; ++c) {
    const v = corners[c];
    let i = around.first[v];
    if (around.first[v + 1] - i > 1)
      while (around.regions[i] !== region[(c / 3) | 0]) ++i;
    nodes[c] = first[v] + floors[i];
  }
  return nodes;
}

/** Elevations of roofs, of which those of buildings were told one less the other. */
function addRoofs(roof: Int32Array, regionBuilding: Int32Array): Int32Array {
  let last = 0;
  for (let r = 0; r < roof.length; ++r) if (regionBuilding[r] >= 0) last = roof[r] += last;
  return roof;
}

const kArrays = ['x', 'y', 'corners', 'region', 'regionBuilding', 'roof', 'count', 'floor', 'z',
                 'odd', 'upperCount', 'upperRise', 'upperWait'] as const;

/** Corners of cell number c above columns: positions in steps. */
export function upperCorners({x, y, z, upper}: ColumnMesh, c: number, p: Float64Array): void {
  for (let k = 0; k < 4; ++k) {
    const n = upper.cells[4 * c + k], v = upper.vertex[n];
    p[3 * k] = x[v];
    p[3 * k + 1] = y[v];
    p[3 * k + 2] = n < z.length ? z[n] : upper.z[n - z.length];
  }
}

/** Whether corners of that cell lie on both sides of a plane across axis 0, 1 or 2. */
export function isUpperCrossed({x, y, z, upper}: ColumnMesh, c: number, axis: number, place: number): boolean {
  const along = axis === 0 ? x : y;
  let below = 0;
  for (let k = 4 * c; k < 4 * c + 4; ++k) {
    const n = upper.cells[k];
    if ((axis < 2 ? along[upper.vertex[n]] : n < z.length ? z[n] : upper.z[n - z.length]) < place) ++below;
  }
  return below !== 0 && below !== 4;
}

export const upperCount = (mesh: ColumnMesh): number => mesh.upper.cells.length / 4;

/** `volume`: whether the page has whole columns, or their floors alone. */
export async function readColumns(blocks: Blocks, {volume, layers, whole, cells}: Pick<Facts, 'volume' | 'layers' | 'whole' | 'cells'>): Promise<ColumnMesh> {
  const [a, steps, splits] =
      await Promise.all([readIntegers(blocks, kArrays), inflate(blocks['steps']), inflate(blocks['upperSplits'])]);
  const {corners} = a;
  for (let c = 0, before = 0; c < corners.length; c += 3) {
    before = corners[c] += before;
    corners[c + 1] += before;
    corners[c + 2] += before;
  }
  const vertices = a.x.length;
  const first = new Int32Array(vertices + 1);
  first.set(addUp(a.count), 1);
  addUp(first);
  const mesh: ColumnMesh = {
    x: addUp(a.x), y: addUp(a.y), corners, region: addUp(a.region), regionBuilding: a.regionBuilding,
    first, z: a.z, floor: new Int32Array(0), oddStart: null, steps, layers, whole,
    upper: noUpper(), hasCells: volume,
  };
  const around = regionsAtVertices(vertices, corners, mesh.region);
  const floors = floorPositions(around, a.floor);
  addElevations(mesh, around, floors, addRoofs(a.roof, mesh.regionBuilding), volume);
  mesh.floor = floorNodes(mesh, around, floors);
  if (a.upperCount.length > 0)
    mesh.upper = climbUpper(mesh, {count: addUp(a.upperCount), rise: a.upperRise, wait: a.upperWait, splits}, cells - cellCount(mesh));
  if (a.odd.length > 0) {
    mesh.oddStart = new Int32Array(triangleCount(mesh)).fill(-1);
    let start = 0;
    for (const t of addUp(a.odd)) {
      mesh.oddStart[t] = start;
      start += stackSize(mesh, t);
    }
  }
  return mesh;
}

/** Prisms over triangle t: the lowest cells of its stack. */
export function prismCount(mesh: ColumnMesh, t: number): number {
  if (mesh.whole) return mesh.first[mesh.corners[3 * t] + 1] - 1 - mesh.floor[3 * t];
  return mesh.regionBuilding[mesh.region[t]] < 0 ? mesh.layers : 0;
}

/** Tets over triangle t. */
export function stackSize(mesh: ColumnMesh, t: number): number {
  let size = -3 * prismCount(mesh, t);
  for (let c = 3 * t; c < 3 * t + 3; ++c) size += mesh.first[mesh.corners[c] + 1] - 1 - mesh.floor[c];
  return size;
}

export function cellCount(mesh: ColumnMesh): number {
  let cells = upperCount(mesh);
  for (let t = 0; t < triangleCount(mesh); ++t) cells += stackSize(mesh, t) + prismCount(mesh, t);
  return cells;
}
