// The run as the page has it: what was stored, and what is made of it.

import {Vector3} from 'three';
import type {Building, Facts} from './facts.js';
import {type Outline, readOutlines} from './map/polygons.js';
import {type ColumnMesh, readColumns} from './mesh/columns.js';
import {makePrisms} from './mesh/prisms.js';
import type {Axis} from './mesh/section.js';
import {type Frame, makeSurface, type Surface} from './mesh/surface.js';
import {type Blocks, readText} from './payload.js';

export interface Model {
  facts: Facts;
  mesh: ColumnMesh | null;
  surface: Surface;
  frame: Frame;
  /** Elevation of the bottom of the soil, steps. */
  base: number;
  /** Elevation of the ground below each building, steps. */
  foot: Int32Array;
  /** Of the domain, and of what stands on it; metres. */
  size: Vector3;
  /** Where there is something along each axis, metres. */
  range: Record<Axis, [number, number]>;
  /** Footprints, in the order of the facts; buildings. */
  before: Outline[];
  after: Outline[];
}

/** The least and the greatest of them. */
function extremes(values: Iterable<number>): [number, number] {
  let low = Infinity, high = -Infinity;
  for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
  return [low, high];
}

function* floorsOf(mesh: ColumnMesh): Generator<number> {
  for (const node of mesh.floor) yield mesh.z[node];
}

export async function readModel(blocks: Blocks): Promise<Model> {
  const facts = JSON.parse(await readText(blocks, 'facts')) as Facts;
  const {step} = facts;
  const [mesh, before, after] = await Promise.all([
    facts.mesh ? readColumns(blocks, facts) : null, readOutlines(blocks, 'before', step), readOutlines(blocks, 'after', step)]);
  const [xmin, ymin, xmax, ymax] = facts.domain;
  const foot = Int32Array.from(facts.buildings, (b) => Math.round(b.ground / step));
  const [low, high] = mesh !== null ? extremes(floorsOf(mesh)) :
      facts.buildings.length > 0 ? [extremes(foot)[0], extremes(facts.buildings.map((b) => Math.round(b.top / step)))[1]] : [0, 0];
  const top = mesh === null ? high : extremes(mesh.z)[1];
  const frame: Frame = {step, centre: [Math.round((xmin + xmax) / 2 / step), Math.round((ymin + ymax) / 2 / step), low]};
  const size = new Vector3(xmax - xmin, ymax - ymin, (high - low) * step);
  const base = low - Math.round(Math.min(60, Math.max(3, 0.014 * Math.hypot(size.x, size.y))) / step);
  const surface = mesh !== null ? makeSurface(mesh, frame, base, foot) : makePrisms(after, facts.buildings, facts.outline, frame, base);
  return {facts, mesh, surface, frame, base, foot, size, before, after,
          range: {x: [xmin, xmax], y: [ymin, ymax], z: [low * step, top * step]}};
}

/** A place of the local frame (metres) in the scene. */
export const toScene = ({frame: {centre, step}}: Model, x: number, y: number, z: number): Vector3 =>
    new Vector3(x - centre[0] * step, y - centre[1] * step, z - centre[2] * step);

/** Of its highest roof, metres. */
export const heightOf = (building: Building): number => building.top - building.ground;

/** Of the highest building, metres. */
export const highest = (facts: Facts): number => facts.buildings.reduce((most, b) => Math.max(most, heightOf(b)), 1);
