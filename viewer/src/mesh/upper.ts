// The cells above the columns: the front that src/io/page/page_upper.h tells the steps of climbs again.

import type {ColumnMesh} from './columns.js';
import {nextCorner} from './edges.js';

/** Explicit cells. Their nodes are numbered after those of the columns. */
export interface UpperMesh {
  /** Per node, of columns, too: the vertex below it. */
  vertex: Int32Array;
  /** Per node above: its elevation. */
  z: Int32Array;
  /** Four nodes per cell, in the order in which the front makes them. */
  cells: Int32Array;
}

export const noUpper = (): UpperMesh => ({vertex: new Int32Array(0), z: new Int32Array(0), cells: new Int32Array(0)});

/** What is told. */
export interface UpperSteps {
  /** Per vertex: twice its nodes, and one more if its column ends. */
  count: Int32Array;
  /** Per node. */
  rise: Int32Array;
  /** Per step. */
  wait: Int32Array;
  splits: Uint8Array;
}

const previousCorner = (c: number): number => (c % 3 === 0 ? c + 2 : c - 1);

/** Per half-edge: the one that goes back, or -1 at the rim. */
function twinsOf(corners: Int32Array, vertices: number): Int32Array {
  const first = new Int32Array(vertices + 1);
  for (const v of corners) ++first[v + 1];
  for (let v = 0; v < vertices; ++v) first[v + 1] += first[v];
  const leaving = new Int32Array(corners.length), fill = first.slice();
  for (let c = 0; c < corners.length; ++c) leaving[fill[corners[c]]++] = c;
  const twins = new Int32Array(corners.length).fill(-1);
  for (let c = 0; c < corners.length; ++c) {
    const to = corners[nextCorner(c)];
    for (let i = first[to]; i < first[to + 1]; ++i)
      if (corners[nextCorner(leaving[i])] === corners[c]) twins[c] = leaving[i];
  }
  return twins;
}

/** Numbers of the values, which are whole and less than 2^32 above the lowest, in their order. */
function ascending(values: Float64Array, lowest: number): Uint32Array {
  const n = values.length, keys = new Uint32Array(n);
  let order = new Uint32Array(n), other = new Uint32Array(n);
  for (let i = 0; i < n; ++i) {
    keys[i] = values[i] - lowest;
    order[i] = i;
  }
  for (const shift of [0, 16]) {
    const place = new Uint32Array(65537);
    for (let i = 0; i < n; ++i) ++place[((keys[i] >>> shift) & 65535) + 1];
    for (let d = 0; d < 65536; ++d) place[d + 1] += place[d];
    for (let k = 0; k < n; ++k) other[place[(keys[order[k]] >>> shift) & 65535]++] = order[k];
    [order, other] = [other, order];
  }
  return order;
}

/** The front: triangles between columns, and the node at which each column is. */
class Front {
  private readonly corners: Int32Array;
  private readonly twin: Int32Array;
  /** Per vertex: a half-edge that leaves it; at the rim the one that no triangle lies to the right of. */
  private readonly leaving: Int32Array;
  private readonly isRim: Uint8Array;
  private readonly at: Int32Array;
  readonly cells: Int32Array;
  private length = 0;
  private nextSplit = 0;
  // Of a hole: the vertices around it, the half-edges beyond, and triangles that are free.
  private ring: number[] = [];
  private beyond: number[] = [];
  private free: number[] = [];

  constructor(mesh: ColumnMesh, private readonly splits: Uint8Array, cells: number) {
    this.cells = new Int32Array(4 * cells);
    const vertices = mesh.x.length;
    this.corners = mesh.corners.slice();
    this.twin = twinsOf(this.corners, vertices);
    this.leaving = new Int32Array(vertices);
    for (let c = 0; c < this.corners.length; ++c) this.leaving[this.corners[c]] = c;
    this.isRim = new Uint8Array(vertices);
    for (let c = 0; c < this.corners.length; ++c) {
      if (this.twin[c] >= 0) continue;
      this.leaving[this.corners[c]] = c;
      this.isRim[this.corners[c]] = 1;
    }
    this.at = new Int32Array(vertices);
    for (let v = 0; v < vertices; ++v) this.at[v] = mesh.first[v + 1] - 1;
  }

  rise(v: number, to: number): void {
    const {corners, twin, at} = this, begin = this.leaving[v];
    for (let c = begin;;) {
      const across = nextCorner(c), back = nextCorner(across);
      this.add(at[v], at[corners[across]], at[corners[back]], to);
      c = twin[back];
      if (c === begin || c < 0) break;
    }
    at[v] = to;
  }

  end(v: number): void {
    const {corners, twin, leaving, ring, beyond, free} = this;
    ring.length = beyond.length = free.length = 0;
    for (let c = leaving[v];;) {
      ring.push(corners[nextCorner(c)]);
      beyond.push(twin[nextCorner(c)]);
      free.push(c - c % 3);
      c = twin[previousCorner(c)];
      if (c === leaving[v]) break;
    }
    const lowest = ring.indexOf(Math.min(...ring));
    ring.push(...ring.splice(0, lowest));
    beyond.push(...beyond.splice(0, lowest));
    const last = ring.length - 1;
    this.link(this.cover(this.at[v], 0, last), last);
  }

  /** Covers what is left of the hole beside the chord from corner j to corner i of the ring; returns the chord. */
  private cover(below: number, i: number, j: number): number {
    const {corners, ring, at} = this;
    const k = i + 1 + (j - i > 2 ? this.splits[this.nextSplit++] : 0);
    const t = this.free.pop()!;
    corners[t] = ring[i];
    corners[t + 1] = ring[k];
    corners[t + 2] = ring[j];
    this.add(below, at[ring[i]], at[ring[k]], at[ring[j]]);
    this.join(t, below, i, k);
    this.join(t + 1, below, k, j);
    return t + 2;
  }

  /** Half-edge c goes from corner i of the ring to corner j. */
  private join(c: number, below: number, i: number, j: number): void {
    if (j === i + 1) return this.link(c, i);
    const chord = this.cover(below, i, j);
    this.twin[c] = chord;
    this.twin[chord] = c;
  }

  /** The same where j is the next one. */
  private link(c: number, i: number): void {
    const {twin, ring, beyond} = this;
    const v = ring[i], other = beyond[i];
    if (other < 0 || this.isRim[v] === 0) this.leaving[v] = c;
    twin[c] = other;
    if (other >= 0) twin[other] = c;
  }

  private add(a: number, b: number, c: number, d: number): void {
    this.cells[this.length++] = a;
    this.cells[this.length++] = b;
    this.cells[this.length++] = c;
    this.cells[this.length++] = d;
  }
}

/** `told.rise` becomes elevations. `mesh` has its columns, `cells` are to be made. */
export function climbUpper(mesh: ColumnMesh, {count, rise: z, wait, splits}: UpperSteps, cells: number): UpperMesh {
  const {first} = mesh, nodes = first[first.length - 1];
  const vertex = new Int32Array(nodes + z.length);
  // Per step.
  const due = new Float64Array(wait.length), stepVertex = new Int32Array(wait.length), stepNode = new Int32Array(wait.length);
  let s = 0, n = 0, top = 0, lowest = Infinity;
  for (let v = 0; v < count.length; ++v) {
    const end = n + (count[v] >> 1), ends = count[v] & 1;
    vertex.fill(v, first[v], first[v + 1]);
    let below = mesh.z[first[v + 1] - 2], at = mesh.z[first[v + 1] - 1];
    for (let k = n; k < end + ends; ++k, ++s) {
      let up = at, ahead = Math.floor((at - below) * 9 / 5), node = -1;
      if (k < end) {
        const isLast = k + 1 === end && ends === 0;
        up = z[k] += isLast ? top : 2 * at - below;
        if (isLast) top = up;
        ahead = up - at;
        node = nodes + k;
        vertex[node] = v;
      }
      due[s] = 2 * at + ahead + wait[s] * Math.max(1, Math.floor(ahead / 8));
      lowest = Math.min(lowest, due[s]);
      stepVertex[s] = v;
      stepNode[s] = node;
      below = at;
      at = up;
    }
    n = end;
  }
  return {vertex, z, cells: replay(new Front(mesh, splits, cells), ascending(due, lowest), stepVertex, stepNode)};
}

/** Takes the steps in this order; returns their cells. */
function replay(front: Front, order: Uint32Array, vertex: Int32Array, node: Int32Array): Int32Array {
  for (let k = 0; k < order.length; ++k) {
    const s = order[k];
    if (node[s] < 0) front.end(vertex[s]);
    else front.rise(vertex[s], node[s]);
  }
  return front.cells;
}
