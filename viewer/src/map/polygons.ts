// Outlines of footprints and buildings.

import {addUp, type Blocks, readIntegers} from '../payload.js';

/** Rings one after the other: x, y, x, y, ... in metres, local frame. */
export interface Outline {
  rings: Float64Array[];
  /** xmin, ymin, xmax, ymax. */
  box: readonly [number, number, number, number];
}

export async function readOutlines(blocks: Blocks, prefix: 'before' | 'after', step: number): Promise<Outline[]> {
  const names = [`${prefix}Rings`, `${prefix}Points`, `${prefix}X`, `${prefix}Y`] as const;
  const arrays = await readIntegers(blocks, names);
  const rings = arrays[names[0]], points = arrays[names[1]], xs = addUp(arrays[names[2]]), ys = addUp(arrays[names[3]]);
  const outlines: Outline[] = [];
  let ring = 0, point = 0;
  for (const count of rings) {
    const outline: Float64Array[] = [];
    let [xmin, ymin, xmax, ymax] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let r = 0; r < count; ++r) {
      const coordinates = new Float64Array(2 * points[ring++]);
      for (let i = 0; i < coordinates.length; i += 2, ++point) {
        const x = coordinates[i] = xs[point] * step, y = coordinates[i + 1] = ys[point] * step;
        [xmin, ymin, xmax, ymax] = [Math.min(xmin, x), Math.min(ymin, y), Math.max(xmax, x), Math.max(ymax, y)];
      }
      outline.push(coordinates);
    }
    outlines.push({rings: outline, box: [xmin, ymin, xmax, ymax]});
  }
  return outlines;
}

/** Square metres; holes run the other way. */
export function areaOf({rings}: Outline): number {
  let twice = 0;
  for (const ring of rings)
    for (let i = 0, j = ring.length - 2; i < ring.length; j = i, i += 2) twice += ring[j] * ring[i + 1] - ring[i] * ring[j + 1];
  return Math.abs(twice) / 2;
}

/** Even-odd over all rings. */
export function contains(outline: Outline, x: number, y: number): boolean {
  const {rings, box} = outline;
  if (x < box[0] || y < box[1] || x > box[2] || y > box[3]) return false;
  let inside = false;
  for (const ring of rings)
    for (let i = 0, j = ring.length - 2; i < ring.length; j = i, i += 2) {
      const ay = ring[i + 1], by = ring[j + 1];
      if (ay > y !== by > y && x < ring[i] + ((y - ay) / (by - ay)) * (ring[j] - ring[i])) inside = !inside;
    }
  return inside;
}
