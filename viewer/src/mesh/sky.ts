// How much of the sky a place sees: light that comes from everywhere but where buildings stand.

import type {ColumnMesh} from './columns.js';
import {triangleCount} from './columns.js';
import type {Frame} from './surface.js';

/** Elevations seen from above, in metres about the frame's centre; row by row from the south-west. */
export interface HeightGrid {
  width: number;
  height: number;
  /** Metres between nodes. */
  cell: number;
  /** Of the first node. */
  x: number;
  y: number;
  z: Float32Array;
  /** Per node: its building plus one, 0 for the ground. */
  building: Int32Array;
}

/** `box`: xmin, ymin, xmax, ymax about the frame's centre. At most `most` nodes along either side. */
export function makeHeightGrid(mesh: ColumnMesh, frame: Frame, box: readonly number[], most: number): HeightGrid {
  const cell = Math.max((box[2] - box[0]) / most, (box[3] - box[1]) / most, 0.25);
  const width = Math.max(2, Math.ceil((box[2] - box[0]) / cell));
  const height = Math.max(2, Math.ceil((box[3] - box[1]) / cell));
  const grid: HeightGrid = {
    width, height, cell, x: box[0] + cell / 2, y: box[1] + cell / 2,
    z: new Float32Array(width * height).fill(-Infinity), building: new Int32Array(width * height),
  };
  const {step, centre} = frame;
  const p = new Float64Array(9);
  for (let t = 0; t < triangleCount(mesh); ++t) {
    for (let k = 0; k < 3; ++k) {
      const v = mesh.corners[3 * t + k];
      p[3 * k] = ((mesh.x[v] - centre[0]) * step - grid.x) / cell;
      p[3 * k + 1] = ((mesh.y[v] - centre[1]) * step - grid.y) / cell;
      p[3 * k + 2] = (mesh.z[mesh.floor[3 * t + k]] - centre[2]) * step;
    }
    fillTriangle(grid, p, Math.max(0, mesh.regionBuilding[mesh.region[t]] + 1));
  }
  fillGaps(grid);
  return grid;
}

function fillTriangle(grid: HeightGrid, p: Float64Array, building: number): void {
  const [ax, ay, az, bx, by, bz, cx, cy, cz] = p;
  const twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
  if (!(twice > 0)) return;
  const y0 = Math.max(0, Math.ceil(Math.min(ay, by, cy))), y1 = Math.min(grid.height - 1, Math.floor(Math.max(ay, by, cy)));
  const x0 = Math.max(0, Math.ceil(Math.min(ax, bx, cx))), x1 = Math.min(grid.width - 1, Math.floor(Math.max(ax, bx, cx)));
  for (let y = y0; y <= y1; ++y)
    for (let x = x0; x <= x1; ++x) {
      const wa = (bx - x) * (cy - y) - (cx - x) * (by - y);
      const wb = (cx - x) * (ay - y) - (ax - x) * (cy - y);
      const wc = twice - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const i = y * grid.width + x;
      grid.z[i] = (wa * az + wb * bz + wc * cz) / twice;
      grid.building[i] = building;
    }
}

/** Nodes in no triangle (along the rim) take the elevation beside them. */
function fillGaps(grid: HeightGrid): void {
  const {z, width, height} = grid;
  for (let i = 1; i < z.length; ++i) if (z[i] === -Infinity) z[i] = z[i - 1];
  for (let i = z.length - 2; i >= 0; --i) if (z[i] === -Infinity) z[i] = z[i + 1];
  if (z[0] === -Infinity) z.fill(0, 0, width * height);
}

/** Shares of the sky seen from the ground and from the roofs, two bytes per node, as it grows better. */
export interface SkyMap {
  grid: HeightGrid;
  share: Uint8Array;
}

/**
 * Goes through the directions, a few per step, so that the page stays alive; each is a sweep along
 * parallel lines in which a stack holds the horizon (Dozier, Bruno and Downey, "A faster solution to
 * the horizon problem", 1981). Yields when a direction is done.
 */
export function* lookAtSky(grid: HeightGrid, directions: number): Generator<void, SkyMap> {
  const {width, height} = grid;
  const open = new Float32Array(width * height);
  for (let d = 0; d < directions; ++d) {
    sweep(grid, (2 * Math.PI * (d + 0.5)) / directions, open);
    yield;
  }
  return {grid, share: separate(grid, open, directions)};
}

/** Adds cos² of the horizon's elevation in one direction: the share of its slice of a flat place's light. */
function sweep(grid: HeightGrid, angle: number, open: Float32Array): void {
  const {width, height, z, cell} = grid;
  const cos = Math.cos(angle), sin = Math.sin(angle);
  const alongX = Math.abs(cos) >= Math.abs(sin);
  const length = alongX ? width : height, across = alongX ? height : width;
  const slope = alongX ? sin / cos : cos / sin;
  const forward = (alongX ? cos : sin) > 0;
  const stride = cell * Math.hypot(1, slope);
  const stackZ = new Float32Array(length), stackAt = new Int32Array(length);
  // Lines are numbered by where they cross the first column (row): every node is on one of them.
  const reach = Math.round(slope * (length - 1));
  for (let line = -Math.max(0, reach); line < across - Math.min(0, reach); ++line) {
    let size = 0;
    for (let n = 0; n < length; ++n) {
      const along = forward ? length - 1 - n : n;
      const side = line + Math.round(slope * along);
      if (side < 0 || side >= across) continue;
      const i = alongX ? side * width + along : along * width + side;
      const here = z[i];
      let rise = 0;
      while (size > 0) {
        rise = (stackZ[size - 1] - here) / (n - stackAt[size - 1]);
        if (size < 2 || (stackZ[size - 2] - here) / (n - stackAt[size - 2]) < rise) break;
        --size;
      }
      const tangent = size > 0 ? Math.max(0, rise) / stride : 0;
      open[i] += 1 / (1 + tangent * tangent);
      stackZ[size] = here;
      stackAt[size++] = n;
    }
  }
}

/** Ground and roofs apart, each spread under and around the other so that they do not mix at walls. */
function separate(grid: HeightGrid, open: Float32Array, directions: number): Uint8Array {
  const {width, height, building} = grid;
  const share = new Uint8Array(2 * width * height);
  for (let layer = 0; layer < 2; ++layer) {
    let known = Uint8Array.from(building, (b) => ((b > 0) === (layer === 1) ? 1 : 0));
    let value = Float32Array.from(open, (o) => o / directions);
    for (let pass = 0; pass < 3; ++pass) {
      const nextKnown = known.slice(), nextValue = value.slice();
      for (let y = 0, i = 0; y < height; ++y)
        for (let x = 0; x < width; ++x, ++i) {
          if (known[i] === 1) continue;
          let sum = 0, count = 0;
          for (let dy = -1; dy <= 1; ++dy)
            for (let dx = -1; dx <= 1; ++dx) {
              const u = x + dx, v = y + dy;
              if (u < 0 || v < 0 || u >= width || v >= height || known[v * width + u] === 0) continue;
              sum += value[v * width + u];
              ++count;
            }
          if (count === 0) continue;
          nextKnown[i] = 1;
          nextValue[i] = sum / count;
        }
      known = nextKnown;
      value = nextValue;
    }
    for (let i = 0; i < value.length; ++i) share[2 * i + layer] = Math.round(255 * Math.min(1, value[i]));
  }
  return share;
}
