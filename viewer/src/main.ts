// Reads the run, builds the mesh, and connects the controls with the views.

import {Vector3} from 'three';
import type {Facts} from './facts.js';
import {MapView, type MapHit, fateColour} from './map/map_view.js';
import {readOutlines} from './map/polygons.js';
import {Climb} from './mesh/climb.js';
import {cellCount, type ColumnMesh, readColumns, triangleCount} from './mesh/columns.js';
import {leastAngles, tetCorners} from './mesh/quality.js';
import {type Axis, cutCells, cutSolids} from './mesh/section.js';
import {lookAtSky, makeHeightGrid} from './mesh/sky.js';
import {type Frame, makeSurface, type Surface} from './mesh/surface.js';
import {Panel, runName} from './panel/panel.js';
import {type Blocks, readText} from './payload.js';
import {byId, choice, el, fixed, plural, whole} from './ui/dom.js';
import {CityView} from './view/city_view.js';
import {
  css, flagStyle, kBestAngle, kClassColours, kFlagStyles, kHeightRamp, kNoFlag, kQualityRamp, kSolidColours, type Rgb,
  type Theme,
} from './view/colours.js';
import {Colouring} from './view/surface_material.js';

type Colours = 'class' | 'height' | 'quality' | 'flags';
type Cut = 'off' | Axis;
type Content = (Node | string)[];

/** A pause in which the page draws and listens. */
const pause = (): Promise<void> => new Promise((done) => { setTimeout(done, 0); });

class Page {
  private colours: Colours = 'class';
  private cut: Cut = 'off';
  /** Of the cut planes, metres in the local frame. */
  private readonly places: Record<Axis, number>;
  /** Which side goes: +1 what lies beyond the plane along its axis. */
  private readonly sides: Record<Axis, number> = {x: 1, y: -1, z: 1};
  /** Whether cells are drawn whole: easier to read where they stand upright. */
  private readonly whole: Record<Axis, boolean> = {x: true, y: true, z: false};
  private showsMap = false;
  private theme: Theme = 'light';
  private angles: Float32Array | null = null;
  private cutFrame = 0;
  private readonly foot: Int32Array;
  private readonly range: Record<Axis, [number, number]>;
  private readonly panel: Panel;
  private readonly setColourChoice: (value: Colours) => void;

  constructor(private readonly facts: Facts, private readonly mesh: ColumnMesh, private readonly surface: Surface,
              private readonly frame: Frame, private readonly base: number, readonly view: CityView,
              private readonly map: MapView) {
    const [xmin, ymin, xmax, ymax] = facts.domain;
    let low = Infinity, high = -Infinity;
    for (const z of mesh.z) [low, high] = [Math.min(low, z), Math.max(high, z)];
    this.range = {x: [xmin, xmax], y: [ymin, ymax], z: [low * facts.step, high * facts.step]};
    this.places = {x: (xmin + xmax) / 2, y: (ymin + ymax) / 2, z: this.usualHeight(low * facts.step)};
    this.foot = feet(facts);
    this.panel = new Panel(facts, {select: (b) => this.select(b, true), showCell: (n) => this.showCell(n)});
    this.setColourChoice = this.addControls();
    this.listen();
    this.setTheme(this.storedTheme());
    this.showLegend();
  }

  /** Through most buildings. */
  private usualHeight(low: number): number {
    const middles = this.facts.buildings.map((b) => (b.ground + b.roof) / 2).sort((a, b) => a - b);
    return middles.length > 0 ? middles[middles.length >> 1] : low + 5;
  }

  private addControls(): (value: Colours) => void {
    choice(byId('views'), '', [['city', 'City'], ['map', 'Map']], 'city', (v) => this.setView(v === 'map'));
    const colours = choice<Colours>(byId('colours'), 'Colour', [['class', 'Class'], ['height', 'Height'], ['quality', 'Quality'], ['flags', 'Flags']],
                                    'class', (v) => { void this.setColours(v); });
    choice<Cut>(byId('cuts'), 'Cut', [['off', 'Off'], ['x', 'X'], ['y', 'Y'], ['z', 'Z']], 'off', (v) => this.setCut(v));
    if (!this.facts.volume) {
      const quality = byId('colours').querySelector<HTMLButtonElement>('[data-value="quality"]')!;
      quality.disabled = true;
      quality.hidden = true;
      byId('whole').hidden = true;
    }
    return colours.set;
  }

  private listen(): void {
    const {view} = this;
    const canvas = byId<HTMLCanvasElement>('city');
    byId('edges').addEventListener('click', () => this.toggleEdges());
    byId('home').addEventListener('click', () => this.home());
    byId('north').addEventListener('click', () => this.lookNorth());
    byId('theme').addEventListener('click', () => this.setTheme(this.theme === 'dark' ? 'light' : 'dark'));
    byId<HTMLInputElement>('place').addEventListener('input', (event) => {
      if (this.cut !== 'off') this.places[this.cut] = Number((event.target as HTMLInputElement).value);
      this.updateCut();
    });
    byId('flip').addEventListener('click', () => {
      if (this.cut !== 'off') this.sides[this.cut] *= -1;
      this.updateCut();
    });
    byId('whole').addEventListener('click', () => {
      if (this.cut !== 'off') this.whole[this.cut] = !this.whole[this.cut];
      this.updateCut();
    });

    let down: {x: number; y: number} | null = null, hover: PointerEvent | null = null;
    canvas.addEventListener('pointerdown', (event) => { down = {x: event.clientX, y: event.clientY}; });
    canvas.addEventListener('pointerup', (event) => {
      if (down !== null && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 5)
        this.select(view.pick(event.clientX, event.clientY)?.building ?? -1, false);
      down = null;
    });
    canvas.addEventListener('dblclick', (event) => {
      const picked = view.pick(event.clientX, event.clientY);
      if (picked !== null) view.flyTo(picked.place, view.camera.position.distanceTo(view.controls.target) * 0.5, null, 40);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (event.pointerType === 'touch' || event.buttons !== 0) return;
      if (hover === null)
        setTimeout(() => {
          if (hover !== null) this.hover(hover);
          hover = null;
        }, 50);
      hover = event;
    });
    canvas.addEventListener('pointerleave', () => {
      hover = null;
      view.setHovered(-1);
      this.tip(null, 0, 0);
    });
    canvas.addEventListener('keydown', (event) => this.key(event));
    view.onFrame = () => this.updateScale();

    this.map.onHover = (hit, x, y) => this.tip(hit === null ? null : this.tellMap(hit), x, y);
    this.map.onClick = (hit) => this.select(hit === null ? -1 : hit.side === 'after' ? hit.index : this.facts.footprints[hit.index].building, false);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turn = {ArrowLeft: [-6, 0], ArrowRight: [6, 0], ArrowUp: [0, 4], ArrowDown: [0, -4]}[event.key];
    if (turn !== undefined) this.view.turn(turn[0], turn[1]);
    else if (event.key === '+' || event.key === '=') this.view.zoom(0.8);
    else if (event.key === '-') this.view.zoom(1.25);
    else if (event.key === 'Home') this.home();
    else if (event.key === 'Escape') this.select(-1, false);
    else if (event.key === 'e' || event.key === 'E') this.toggleEdges();
    else if (event.key === 'n' || event.key === 'N') this.lookNorth();
    else return;
    event.preventDefault();
  }

  private toggleEdges(): void {
    const on = byId('edges').getAttribute('aria-pressed') !== 'true';
    byId('edges').setAttribute('aria-pressed', String(on));
    this.view.setEdges(on);
  }

  private lookNorth(): void {
    const {view} = this;
    const offset = view.camera.position.clone().sub(view.controls.target);
    view.flyTo(view.controls.target.clone(), offset.length(), 180, Math.asin(offset.z / offset.length()) * 180 / Math.PI);
  }

  private home(): void {
    this.showCell(-1);
    if (this.showsMap) this.map.home();
    else this.view.home();
  }

  setView(map: boolean): void {
    this.showsMap = map;
    byId('stage').classList.toggle('show-map', map);
    byId('map').hidden = !map;
    byId('cut').hidden = map || this.cut === 'off';
    this.tip(null, 0, 0);
    this.showLegend();
    this.map.invalidate();
  }

  private storedTheme(): Theme {
    try {
      const stored = localStorage.getItem('tetropolis-theme');
      if (stored === 'light' || stored === 'dark') return stored;
    } catch { /* not to be had everywhere */ }
    return window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    document.documentElement.dataset['theme'] = theme;
    try {
      localStorage.setItem('tetropolis-theme', theme);
    } catch { /* likewise */ }
    this.view.setTheme(theme);
    this.map.setDark(theme === 'dark');
    this.showLegend();
  }

  async setColours(colours: Colours): Promise<void> {
    this.colours = colours;
    this.setColourChoice(colours);
    const {buildings} = this.facts;
    const highest = this.highest();
    if (colours === 'class') this.view.setColouring(Colouring.byClass);
    if (colours === 'height') this.view.setColouring(Colouring.byBuilding, buildings.map((b) => kHeightRamp.at((b.roof - b.ground) / highest)));
    if (colours === 'flags') this.view.setColouring(Colouring.byBuilding, buildings.map((b) => flagStyle(b.flags).colour));
    this.showLegend();
    if (colours !== 'quality') return;
    await this.measure();
    if (this.colours === 'quality') this.view.setColouring(Colouring.byAngle);
  }

  private highest(): number {
    return this.facts.buildings.reduce((most, b) => Math.max(most, b.roof - b.ground), 1);
  }

  /** The least angle over each ground triangle, once, in slices. */
  private async measure(): Promise<void> {
    if (this.angles !== null) return;
    const triangles = triangleCount(this.mesh);
    const angles = new Float32Array(triangles);
    let slept = performance.now();
    for (let t = 0; t < triangles; t += 256) {
      leastAngles(this.mesh, t, t + 256, angles);
      if (performance.now() - slept < 30) continue;
      await pause();
      slept = performance.now();
    }
    this.angles = angles;
    this.view.setAngles((f) => angles[this.surface.over[f]] / kBestAngle, this.surface.triangles);
  }

  setCut(cut: Cut): void {
    this.cut = cut;
    byId('cut').hidden = cut === 'off' || this.showsMap;
    if (cut !== 'off') {
      const [low, high] = this.range[cut];
      const input = byId<HTMLInputElement>('place');
      [input.min, input.max, input.step] = [String(low), String(high), cut === 'z' ? '0.1' : String(Math.max(0.5, (high - low) / 2000))];
      input.value = String(this.places[cut]);
      byId('place-name').textContent = cut;
      // What is between the plane and the camera goes.
      const away = this.view.camera.position.clone().sub(this.view.controls.target);
      if (cut !== 'z') this.sides[cut] = away[cut] > 0 ? 1 : -1;
    }
    this.updateCut();
    this.showLegend();
  }

  private updateCut(): void {
    if (this.cutFrame === 0) this.cutFrame = requestAnimationFrame(() => {
      this.cutFrame = 0;
      this.drawCut();
    });
  }

  private drawCut(): void {
    if (this.cut === 'off') {
      this.view.setClip(null, 0);
      this.view.setCut(null, null, false);
      return;
    }
    const plane = {axis: this.cut, at: this.places[this.cut]};
    const cells = this.facts.volume ? cutCells(this.mesh, this.frame, plane, this.whole[this.cut]) : null;
    this.view.setCut(cells, cutSolids(this.mesh, this.frame, plane, this.base, this.foot), this.whole[this.cut]);
    byId('whole').setAttribute('aria-pressed', String(this.whole[this.cut]));
    const axis = 'xyz'.indexOf(plane.axis);
    const normal = new Vector3().setComponent(axis, this.sides[this.cut]);
    this.view.setClip(normal, plane.at - this.frame.centre[axis] * this.frame.step);
    const origin = this.cut === 'x' ? this.facts.origin[0] : this.cut === 'y' ? this.facts.origin[1] : 0;
    byId('place-value').textContent = `${this.cut === 'z' ? fixed(plane.at, 1) : whole(plane.at + origin)} m`;
    byId('cut-count').textContent = cells === null ? '' : plural(cells.cells, 'cell');
  }

  select(building: number, fly: boolean): void {
    this.view.setSelected(building);
    this.map.setSelected(building);
    this.panel.showBuilding(building);
    if (!fly || building < 0 || this.showsMap) return;
    const box = this.map.boxOf(building), b = this.facts.buildings[building];
    const size = Math.hypot(box[2] - box[0], box[3] - box[1], b.roof - b.ground);
    this.view.flyTo(this.toScene((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, (b.ground + b.roof) / 2), Math.max(40, 2.6 * size), null, 38);
  }

  private toScene(x: number, y: number, z: number): Vector3 {
    const {centre, step} = this.frame;
    return new Vector3(x - centre[0] * step, y - centre[1] * step, z - centre[2] * step);
  }

  /** Flies to one of the worst cells and marks it; -1: none is marked. */
  showCell(number: number): void {
    this.panel.showCell(number);
    const cell = this.facts.report?.volume_mesh?.worst_cells[number];
    if (cell === undefined) return this.view.setMarker(null);
    const [x, y, z] = cell.position;
    const place: [number, number, number] = [x - this.facts.origin[0], y - this.facts.origin[1], z];
    const tet = this.facts.volume ? findCell(this.mesh, this.facts.step, place) : null;
    this.view.setMarker(tet === null ? null : tet.map((v, i) => (v - this.frame.centre[i % 3]) * this.frame.step));
    if (this.showsMap) byId('views').querySelector<HTMLButtonElement>('[data-value="city"]')!.click();
    this.view.flyTo(this.toScene(...place), 55, null, 35);
  }

  private hover(event: PointerEvent): void {
    if (this.showsMap) return;
    const building = this.view.pick(event.clientX, event.clientY)?.building ?? -1;
    this.view.setHovered(building);
    byId('city').classList.toggle('on-building', building >= 0);
    this.tip(building < 0 ? null : this.tellBuilding(building), event.clientX, event.clientY);
  }

  private tellBuilding(building: number): Content {
    const b = this.facts.buildings[building];
    return [el('b', {}, b.id), ` · ${fixed(b.roof - b.ground, 1)} m`,
            el('div', {}, b.sources.length > 1 ? `merged from ${whole(b.sources.length)} footprints` : b.sources[0]!),
            ...(b.flags.length > 0 ? [el('div', {}, b.flags.join(', '))] : [])];
  }

  private tellMap(hit: MapHit): Content {
    if (hit.side === 'after') return this.tellBuilding(hit.index);
    const f = this.facts.footprints[hit.index];
    if (f.building < 0) return [el('b', {}, f.source), el('div', {}, `dropped: ${f.reason ?? 'no reason given'}`)];
    const b = this.facts.buildings[f.building];
    return [el('b', {}, f.source), el('div', {}, b.sources.length > 1 ? `merged with ${whole(b.sources.length - 1)} others into ${b.id}` : `kept as ${b.id}`)];
  }

  private tip(content: Content | null, clientX: number, clientY: number): void {
    const tip = byId('tip');
    tip.hidden = content === null;
    if (content === null) return;
    tip.replaceChildren(...content);
    const box = byId('stage').getBoundingClientRect();
    const x = clientX - box.left, y = clientY - box.top;
    tip.style.left = `${Math.min(x + 14, box.width - tip.offsetWidth - 8)}px`;
    tip.style.top = `${y + 18 + tip.offsetHeight > box.height ? y - tip.offsetHeight - 12 : y + 18}px`;
  }

  private updateScale(): void {
    const {view} = this;
    const metres = niceLength(view.metresPerPixel() * 110);
    const scale = byId('scale');
    (scale.lastElementChild as HTMLElement).style.width = `${metres / view.metresPerPixel()}px`;
    scale.firstElementChild!.textContent = metres < 1000 ? `${metres} m` : `${metres / 1000} km`;
    byId('north').querySelector('svg')!.style.transform = `rotate(${-view.heading()}rad)`;
  }

  private showLegend(): void {
    const key = (colour: Rgb | string, text: string, count = ''): HTMLElement => el('li', {},
        el('span', {class: 'swatch', style: `background:${typeof colour === 'string' ? colour : css(colour)}`}), text,
        count !== '' && el('span', {class: 'count'}, count));
    const legend = byId('legend');
    const {facts} = this;
    const dark = this.theme === 'dark';
    if (this.showsMap) {
      const keys = ([['kept', 'kept'], ['merged', 'merged with neighbours'], ['dropped', 'dropped']] as const)
          .map(([fate, text]) => key(fateColour(fate, dark), text, whole(this.map.count(fate))));
      return legend.replaceChildren(el('ul', {class: 'keys column'}, ...keys));
    }
    const ramp = (title: string, gradient: string, ticks: string[], note = ''): Node[] => [
      el('h3', {}, title), el('div', {class: 'ramp', style: `background:${gradient}`}),
      el('div', {class: 'ticks'}, ...ticks.map((t) => el('span', {}, t))), ...(note === '' ? [] : [el('p', {class: 'note'}, note)])];
    const parts: Node[] = [];
    if (this.colours === 'class')
      parts.push(el('ul', {class: 'keys'}, key(kClassColours.ground, 'ground'), key(kClassColours.roof, 'roof'), key(kClassColours.wall, 'wall')));
    if (this.colours === 'height')
      parts.push(...ramp('Height of buildings', kHeightRamp.gradient(), ['0', `${fixed(this.highest() / 2, 0)}`, `${fixed(this.highest(), 0)} m`]));
    if (this.colours === 'quality')
      parts.push(...ramp('Least dihedral angle', kQualityRamp.gradient(), ['0°', '20°', '40°', '60°'], 'of the worst cell over each triangle'));
    if (this.colours === 'flags') {
      const counts = new Map<string, number>();
      for (const b of facts.buildings) counts.set(flagStyle(b.flags).name, (counts.get(flagStyle(b.flags).name) ?? 0) + 1);
      parts.push(el('ul', {class: 'keys column'}, ...[...kFlagStyles, kNoFlag].filter((s) => counts.has(s.name))
          .map((s) => key(s.colour, s.label, whole(counts.get(s.name)!)))));
    }
    if (this.cut !== 'off') {
      if (parts.length > 0) parts.push(el('div', {style: 'height:9px'}));
      if (facts.volume && this.colours !== 'quality')
        parts.push(...ramp('Cells that the plane cuts: least dihedral angle', kQualityRamp.gradient(), ['0°', '20°', '40°', '60°']));
      parts.push(el('ul', {class: 'keys', style: 'margin-top:6px'}, key(kSolidColours.building, 'building'), key(kSolidColours.soil, 'soil')));
    }
    if (facts.mesh && !facts.volume)
      parts.push(el('p', {class: 'note'}, `${whole(facts.cells)} cells are too many for this page: it shows the surface, and sections without cells.`));
    legend.replaceChildren(...parts);
  }
}

const niceLength = (metres: number): number => {
  const power = 10 ** Math.floor(Math.log10(metres));
  return [5, 2, 1].map((m) => m * power).find((length) => length <= metres) ?? power;
};

/** Elevation of the ground below each building, steps. */
const feet = (facts: Facts): Int32Array => Int32Array.from(facts.buildings, (b) => Math.round(b.ground / facts.step));

/** The corners of the cell whose centre is nearest to a place (metres, local frame), in steps. */
function findCell(mesh: ColumnMesh, step: number, place: readonly [number, number, number]): number[] | null {
  const [x, y, z] = place.map((v) => v / step);
  const climb = new Climb(mesh), p = new Float64Array(12);
  let best: number[] | null = null, least = Infinity;
  for (let t = 0; t < triangleCount(mesh); ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => mesh.corners[3 * t + k]);
    const left = (v: number, w: number): boolean =>
        (mesh.x[w] - mesh.x[v]) * (y - mesh.y[v]) - (mesh.y[w] - mesh.y[v]) * (x - mesh.x[v]) >= 0;
    if (!left(a, b) || !left(b, c) || !left(c, a)) continue;
    climb.start(t);
    for (let i; (i = climb.next()) < 3; climb.advance(i)) {
      tetCorners(mesh, climb, i, p);
      const distance = Math.hypot((p[0] + p[3] + p[6] + p[9]) / 4 - x, (p[1] + p[4] + p[7] + p[10]) / 4 - y,
                                  (p[2] + p[5] + p[8] + p[11]) / 4 - z);
      if (distance < least) [best, least] = [[...p], distance];
    }
  }
  return best;
}

async function start(): Promise<void> {
  const blocks = JSON.parse(byId('run').textContent!) as Blocks;
  const facts = JSON.parse(await readText(blocks, 'facts')) as Facts;
  document.title = `${runName(facts)} · Tetropolis`;
  const [mesh, before, after] = await Promise.all([
    readColumns(blocks, facts.volume), readOutlines(blocks, 'before', facts.step), readOutlines(blocks, 'after', facts.step)]);
  const began = performance.now();
  const {step} = facts;
  const [xmin, ymin, xmax, ymax] = facts.domain;
  let lowest = Infinity, highest = -Infinity;
  for (const node of mesh.floor) [lowest, highest] = [Math.min(lowest, mesh.z[node]), Math.max(highest, mesh.z[node])];
  const frame: Frame = {step, centre: [Math.round((xmin + xmax) / 2 / step), Math.round((ymin + ymax) / 2 / step), lowest]};
  const size = new Vector3(xmax - xmin, ymax - ymin, (highest - lowest) * step);
  const depth = Math.max(3, 0.014 * Math.hypot(size.x, size.y));
  const base = lowest - Math.round(depth / step);
  const surface = makeSurface(mesh, frame, base, feet(facts));
  const view = new CityView(byId<HTMLCanvasElement>('city'), surface, facts.buildings.length, size, -depth);
  const map = new MapView(byId('map'), facts, before, after);
  const page = new Page(facts, mesh, surface, frame, base, view, map);
  byId('wait').classList.add('done');
  // For tests, and for those who want to know.
  Object.assign(window, {tetropolis: {
    page, view, cells: facts.volume ? cellCount(mesh) : 0, triangles: surface.triangles, milliseconds: performance.now() - began}});

  await pause();
  const half = [size.x / 2, size.y / 2];
  const grid = makeHeightGrid(mesh, frame, [-half[0], -half[1], half[0], half[1]], 1024);
  const sweeps = lookAtSky(grid, 24);
  for (;;) {
    const {done, value} = sweeps.next();
    if (done === true) {
      view.setSky(value);
      break;
    }
    await pause();
  }
  Object.assign((window as unknown as {tetropolis: object}).tetropolis, {ready: true});
}

start().catch((error: unknown) => {
  console.error(error);
  byId('wait').classList.remove('done');
  byId('wait').replaceChildren(el('p', {}, `This page cannot be shown: ${error instanceof Error ? error.message : String(error)}. It needs a browser with WebGL 2 and DecompressionStream (Chrome 80, Firefox 113, Safari 16.4 or later).`));
});
