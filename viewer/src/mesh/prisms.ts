// What is drawn where there is no mesh: buildings as prisms on flat ground.

import {ShapeUtils, Vector2} from 'three';
import type {Building} from '../facts.js';
import type {Outline} from '../map/polygons.js';
import {type Frame, Kind, SurfaceBuilder, type Surface} from './surface.js';

/**
 * Prisms stand on the lowest of their grounds, at the frame's centre. `domain`: x and y of its corners
 * in turn, metres; `base` in steps.
 */
export function makePrisms(outlines: readonly Outline[], buildings: readonly Building[], domain: readonly number[],
                           frame: Frame, base: number): Surface {
  const x: number[] = [], y: number[] = [];
  const vertex = (px: number, py: number): number => {
    x.push(px / frame.step);
    return y.push(py / frame.step) - 1;
  };
  type Triangle = [number, number, number, number, number, number, Kind, number];
  const triangles: Triangle[] = [];
  const ground = frame.centre[2];
  outlines.forEach((outline, b) => {
    const roof = buildings[b].roof / frame.step;
    const rings = outline.rings.map((ring) => Array.from({length: ring.length / 2}, (_, i) => new Vector2(ring[2 * i], ring[2 * i + 1])));
    const first = x.length;
    for (const p of rings.flat()) vertex(p.x, p.y);
    for (const [i, j, k] of ShapeUtils.triangulateShape(rings[0], rings.slice(1)) as [number, number, number][])
      triangles.push([first + i, roof, first + j, roof, first + k, roof, Kind.roof, b]);
    let at = first;
    for (const ring of rings) {
      for (let i = 0; i < ring.length; ++i) {
        const v = at + i, w = at + (i + 1) % ring.length;
        triangles.push([v, ground, w, ground, w, roof, Kind.wall, b], [v, ground, w, roof, v, roof, Kind.wall, b]);
      }
      at += ring.length;
    }
  });
  const rim = Array.from({length: domain.length / 2}, (_, i) => new Vector2(domain[2 * i], domain[2 * i + 1]));
  const corner = rim.map((p) => vertex(p.x, p.y));
  for (const [i, j, k] of ShapeUtils.triangulateShape(rim, []) as [number, number, number][])
    triangles.push([corner[i], ground, corner[j], ground, corner[k], ground, Kind.ground, -1]);
  corner.forEach((v, i) => {
    const w = corner[(i + 1) % corner.length];
    triangles.push([v, base, w, base, w, ground, Kind.soil, -1], [v, base, w, ground, v, ground, Kind.soil, -1]);
  });
  const foot = new Int32Array(buildings.length).fill(ground);
  const builder = new SurfaceBuilder({x: Int32Array.from(x), y: Int32Array.from(y)}, frame, foot, triangles.length);
  for (const t of triangles) builder.add(...t, 0);
  return builder.finish();
}
