// The front that climbs over a triangle, from its prisms upwards, and leaves tets behind: class Climb of column_mesh.h.

import {type ColumnMesh, prismCount} from './columns.js';

/**
 * climb.start(t); for (let i; (i = climb.next()) < 3; climb.advance(i)) ...: one tet each, of the
 * nodes at[0], at[1], at[2] over the triangle's corners and at[i] + 1.
 */
export class Climb {
  readonly at = new Int32Array(3);
  readonly vertex = new Int32Array(3);
  private readonly end = new Int32Array(3);
  private readonly key = new Float64Array(3);
  private step = -1;

  constructor(private readonly mesh: ColumnMesh) {}

  start(t: number): void {
    const {mesh} = this, prisms = prismCount(mesh, t);
    for (let i = 0; i < 3; ++i) {
      this.vertex[i] = mesh.corners[3 * t + i];
      this.end[i] = mesh.first[this.vertex[i] + 1] - 1;
      this.at[i] = mesh.floor[3 * t + i] + prisms;
      this.setKey(i);
    }
    this.step = mesh.oddStart === null ? -1 : mesh.oddStart[t];
  }

  /**
   * From the front just below the first tet over triangle t that reaches above elevation z. All
   * segments that go before the first one that does are passed; their order does not matter.
   */
  startBelow(t: number, z: number): void {
    this.start(t);
    if (this.step >= 0) return;
    let first = -1, firstKey = Infinity;
    for (let i = 0; i < 3; ++i) {
      // The last node that is not above z, or the floor.
      let low = this.at[i], high = this.end[i];
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (this.mesh.z[middle] <= z) low = middle;
        else high = middle - 1;
      }
      const key = low < this.end[i] ? this.keyAt(low) : Infinity;
      if (first < 0 || this.before(key, i, firstKey, first)) [first, firstKey] = [i, key];
      this.reached[i] = low;
    }
    for (let i = 0; i < 3; ++i) {
      let node = this.reached[i];
      if (i !== first)
        while (node > this.at[i] && !this.before(this.keyAt(node - 1), i, firstKey, first)) --node;
      this.at[i] = node;
      this.setKey(i);
    }
  }

  /** The corner that goes next; 3 at the top. */
  next(): number {
    if (this.step >= 0) return this.isDone() ? 3 : this.mesh.steps[this.step];
    let best = 0;
    for (let i = 1; i < 3; ++i) if (this.before(this.key[i], i, this.key[best], best)) best = i;
    return this.key[best] < Infinity ? best : 3;
  }

  advance(i: number): void {
    ++this.at[i];
    this.setKey(i);
    if (this.step >= 0) ++this.step;
  }

  private readonly reached = new Int32Array(3);

  private isDone(): boolean {
    return this.at[0] === this.end[0] && this.at[1] === this.end[1] && this.at[2] === this.end[2];
  }

  private before(key: number, i: number, other: number, j: number): boolean {
    return key < other || (key === other && this.vertex[i] > this.vertex[j]);
  }

  private keyAt(node: number): number { return this.mesh.z[node] + this.mesh.z[node + 1]; }

  private setKey(i: number): void {
    this.key[i] = this.at[i] < this.end[i] ? this.keyAt(this.at[i]) : Infinity;
  }
}
