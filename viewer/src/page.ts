// The controls, and what they do.

import {Vector3} from 'three';
import {buildingOf, MapView, type MapHit} from './map/map_view.js';
import {kSurfaceKinds} from './mesh/columns.js';
import {findCell} from './mesh/find_cell.js';
import {leastAnglesOver} from './mesh/quality.js';
import {type Axis, cutCells, cutSolids} from './mesh/section.js';
import {heightOf, highest, type Model, toScene} from './model.js';
import {Panel} from './panel/panel.js';
import {byId, choice, el, fixed, plural, whole} from './ui/dom.js';
import {currentTheme, onSystemTheme, storeTheme} from './ui/theme.js';
import {cityLegend, type Colours, mapLegend} from './ui/legend.js';
import type {CityView} from './view/city_view.js';
import {flagStyle, kBestAngle, type Theme} from './view/colours.js';
import {Colouring} from './view/surface_material.js';

type Cut = 'off' | Axis;
type Content = (Node | string)[];

/** A pause in which the page draws and listens. */
export const pause = (): Promise<void> => new Promise((done) => { setTimeout(done, 0); });

const press = (button: HTMLElement, on: boolean): void => button.setAttribute('aria-pressed', String(on));

/** 1, 2 or 5 times a power of ten, at most `metres`. */
const niceLength = (metres: number): number => {
  const power = 10 ** Math.floor(Math.log10(metres));
  return [5, 2, 1].map((m) => m * power).find((length) => length <= metres) ?? power;
};

export class Page {
  private colours: Colours = 'class';
  private cut: Cut = 'off';
  /** Of the cut planes, metres. */
  private readonly places: Record<Axis, number>;
  /** Which side goes: +1 what lies beyond the plane along its axis. */
  private readonly sides: Record<Axis, number> = {x: 1, y: -1, z: 1};
  /** Whether cells are drawn whole: easier to read where they stand upright. */
  private readonly whole: Record<Axis, boolean> = {x: true, y: true, z: false};
  private showsMap = false;
  private theme: Theme = 'light';
  private measuring: Promise<void> | null = null;
  private cutFrame = 0;
  private readonly panel: Panel;
  private readonly views: {set: (value: 'city' | 'map') => void};

  constructor(private readonly model: Model, readonly view: CityView, private readonly map: MapView) {
    const {range, facts} = model;
    // Through most buildings.
    const middles = facts.buildings.map((b) => (b.ground + b.roof) / 2).sort((a, b) => a - b);
    this.places = {x: (range.x[0] + range.x[1]) / 2, y: (range.y[0] + range.y[1]) / 2,
                   z: middles[middles.length >> 1] ?? range.z[0] + 5};
    this.panel = new Panel(facts, model.before, {
      select: (b) => this.select(b, true), showFootprint: (f) => this.showFootprint(f, true), showCell: (n) => this.showCell(n),
    });
    this.views = choice(byId('views'), '', [['city', 'City'], ['map', 'Map']], 'city', (v) => this.setView(v === 'map'));
    choice<Colours>(byId('colours'), 'Colour', [
      ['class', 'Class'], ['height', 'Height'], ...(facts.volume && !facts.whole ? [['quality', 'Quality'] as const] : []), ['flags', 'Flags'],
    ], 'class', (v) => { void this.setColours(v); });
    choice<Cut>(byId('cuts'), 'Cut', [['off', 'Off'], ['x', 'X'], ['y', 'Y'], ['z', 'Z']], 'off', (v) => this.setCut(v));
    byId('whole').hidden = !facts.volume;
    if (model.mesh === null) byId('cuts').hidden = byId('edges').parentElement!.hidden = true;
    this.listen();
    this.setTheme(currentTheme());
    this.showLegend();
  }

  private listen(): void {
    byId('edges').addEventListener('click', () => this.toggleEdges());
    byId('home').addEventListener('click', () => this.home());
    byId('north').addEventListener('click', () => this.view.lookNorth());
    byId('theme').addEventListener('click', () => {
      this.setTheme(this.theme === 'dark' ? 'light' : 'dark');
      storeTheme(this.theme);
    });
    onSystemTheme((theme) => this.setTheme(theme));
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
    this.listenToCity();
    this.map.onHover = (hit, x, y) => this.tip(hit === null ? null : this.tellMap(hit), x, y);
    this.map.onClick = (hit) => {
      if (hit !== null && buildingOf(this.model.facts, hit) < 0) this.showFootprint(hit.index, false);
      else this.select(hit === null ? -1 : buildingOf(this.model.facts, hit), false);
    };
  }

  private listenToCity(): void {
    const {view} = this;
    const canvas = byId<HTMLCanvasElement>('city');
    let down: PointerEvent | null = null, hover: PointerEvent | null = null;
    const stopHovering = (): void => {
      hover = null;
      view.setHovered(-1);
      this.tip(null, 0, 0);
    };
    view.onMove = stopHovering;
    canvas.addEventListener('pointerdown', (event) => { down = event; });
    canvas.addEventListener('pointerup', (event) => {
      if (down !== null && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 5) {
        const picked = view.pickRegion(event.clientX, event.clientY);
        this.select(Math.max(-1, picked), false);
        if (picked < -1 || event.pointerType === 'touch') this.hover(event);
      }
      down = null;
    });
    canvas.addEventListener('dblclick', (event) => {
      const place = view.pickPlace(event.clientX, event.clientY);
      if (place !== null) view.flyTo(place, view.distance() * 0.5, null, 40);
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
    canvas.addEventListener('pointerleave', stopHovering);
    document.addEventListener('keydown', (event) => this.key(event));
    view.onFrame = () => this.updateScale();
  }

  /** Arrows, plus and minus turn the city while it has the focus; letters work wherever nothing is typed. */
  private key(event: KeyboardEvent): void {
    const {target, key} = event;
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || target instanceof HTMLInputElement) return;
    const turn = {ArrowLeft: [-6, 0], ArrowRight: [6, 0], ArrowUp: [0, 4], ArrowDown: [0, -4]}[key];
    const isCity = target === byId('city');
    if (isCity && turn !== undefined) this.view.turn(turn[0], turn[1]);
    else if (isCity && (key === '+' || key === '=')) this.view.zoom(0.8);
    else if (isCity && key === '-') this.view.zoom(1.25);
    else if (key === 'Home' && byId('stage').contains(target as Node)) this.home();
    else if (key === 'Escape') this.select(-1, false);
    else if (key.toLowerCase() === 'e' && !this.showsMap) this.toggleEdges();
    else if (key.toLowerCase() === 'n' && !this.showsMap) this.view.lookNorth();
    else return;
    event.preventDefault();
  }

  toggleEdges(): void {
    const on = byId('edges').getAttribute('aria-pressed') !== 'true';
    press(byId('edges'), on);
    this.view.setEdges(on);
  }

  private home(): void {
    this.showCell(-1);
    if (this.showsMap) this.map.home();
    else this.view.home();
  }

  setView(map: boolean): void {
    this.showsMap = map;
    this.views.set(map ? 'map' : 'city');
    byId('stage').classList.toggle('show-map', map);
    byId('map').hidden = !map;
    this.tip(null, 0, 0);
    this.showLegend();
    this.map.invalidate();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    document.documentElement.dataset['theme'] = theme;
    this.view.setTheme(theme);
    this.map.setDark(theme === 'dark');
    this.showLegend();
  }

  async setColours(colours: Colours): Promise<void> {
    this.colours = colours;
    const {facts} = this.model;
    if (colours === 'class') this.view.setColouring(Colouring.byClass);
    if (colours === 'height') this.view.colourByHeight(facts.buildings.map((b) => toScene(this.model, 0, 0, b.ground).z), highest(facts));
    if (colours === 'flags') this.view.setColouring(Colouring.byBuilding, facts.buildings.map((b) => flagStyle(b.flags).colour));
    this.showLegend();
    if (colours !== 'quality') return;
    this.measuring ??= this.measure();
    await this.measuring;
    if (this.colours === 'quality') this.view.setColouring(Colouring.byAngle);
  }

  /** The least angle over each ground triangle, once, in slices. */
  private async measure(): Promise<void> {
    const {mesh, surface} = this.model;
    if (mesh === null) return;
    let slept = performance.now();
    const angles = await leastAnglesOver(mesh, async () => {
      if (performance.now() - slept < 30) return;
      await pause();
      slept = performance.now();
    });
    this.view.setAngles((f) => angles[surface.over[f]] / kBestAngle, surface.triangles);
  }

  setCut(cut: Cut): void {
    this.cut = cut;
    byId('cut').hidden = cut === 'off';
    if (cut !== 'off') {
      const [low, high] = this.model.range[cut];
      const input = byId<HTMLInputElement>('place');
      [input.min, input.max, input.step] = [String(low), String(high), cut === 'z' ? '0.1' : String(Math.max(0.5, (high - low) / 2000))];
      input.value = String(this.places[cut]);
      this.places[cut] = Number(input.value);  // of the slider's steps
      byId('place-name').textContent = cut;
      // What is between the plane and the camera goes.
      if (cut !== 'z') this.sides[cut] = this.view.offset()[cut] > 0 ? 1 : -1;
    }
    this.updateCut();
    this.showLegend();
  }

  private updateCut(): void {
    if (this.cutFrame !== 0) return;
    this.cutFrame = requestAnimationFrame(() => {
      this.cutFrame = 0;
      this.drawCut();
    });
  }

  private drawCut(): void {
    const {cut} = this, {mesh, facts, frame, base, foot} = this.model;
    if (cut === 'off' || mesh === null) {
      this.view.setClip(null, 0);
      this.view.setCut(null, null, false);
      return;
    }
    const plane = {axis: cut, at: this.places[cut]};
    const cells = facts.volume ? cutCells(mesh, frame, plane, this.whole[cut]) : null;
    this.view.setCut(cells, cutSolids(mesh, frame, plane, base, foot), this.whole[cut]);
    press(byId('whole'), this.whole[cut]);
    const axis = 'xyz'.indexOf(cut);
    this.view.setClip(new Vector3().setComponent(axis, this.sides[cut]), plane.at - frame.centre[axis] * frame.step);
    const origin = cut === 'z' ? 0 : facts.origin[axis];
    const told = `${cut === 'z' ? fixed(plane.at, 1) : whole(plane.at + origin)} m`;
    byId('place-value').textContent = told;
    byId('place').setAttribute('aria-valuetext', told);
    byId('cut-count').textContent = cells === null ? '' : plural(cells.cells, 'cell');
  }

  select(building: number, fly: boolean): void {
    this.view.setSelected(building);
    this.map.setSelected(building);
    this.panel.showBuilding(building);
    if (!fly || building < 0) return;
    const {box} = this.model.after[building], b = this.model.facts.buildings[building];
    byId('stage').scrollIntoView({block: 'nearest'});
    if (this.showsMap) return this.map.show(box);
    const size = Math.hypot(box[2] - box[0], box[3] - box[1], heightOf(b));
    this.view.flyTo(toScene(this.model, (box[0] + box[2]) / 2, (box[1] + box[3]) / 2, (b.ground + b.top) / 2), Math.max(60, 3.4 * size), null, 38);
  }

  /** Tells of a dropped footprint. */
  private showFootprint(footprint: number, show: boolean): void {
    this.select(-1, false);
    this.panel.showFootprint(footprint);
    if (!show) return;
    this.setView(true);
    this.map.show(this.model.before[footprint].box);
  }

  /** Flies to one of the worst cells and marks it; -1: none is marked. */
  showCell(number: number): void {
    this.panel.showCell(number);
    const {facts, mesh, frame: {centre, step}} = this.model;
    const cell = facts.report?.volume_mesh?.worst_cells[number];
    if (cell === undefined) return this.view.setMarker(null);
    const place = cell.position.map((v, k) => v - (facts.origin[k] ?? 0));
    const tet = facts.volume && mesh !== null ? findCell(mesh, place.map((v) => v / step)) : null;
    this.view.setMarker(tet === null ? null : tet.map((v, i) => (v - centre[i % 3]) * step));
    if (this.showsMap) this.setView(false);
    byId('stage').scrollIntoView({block: 'nearest'});
    this.view.flyTo(toScene(this.model, place[0], place[1], place[2]), 70, null, 35);
  }

  private hover(event: PointerEvent): void {
    if (this.showsMap) return;
    const building = this.view.pickRegion(event.clientX, event.clientY);
    this.view.setHovered(building);
    byId('city').classList.toggle('on-building', building >= 0);
    this.tip(building === -1 ? null : building < 0 ? [kSurfaceKinds[-2 - building]] : this.tellBuilding(building), event.clientX, event.clientY);
  }

  private tellBuilding(building: number): Content {
    const b = this.model.facts.buildings[building];
    return [el('b', {}, b.id), ` · ${fixed(heightOf(b), 1)} m`,
            el('div', {}, b.sources.length > 1 ? `merged from ${whole(b.sources.length)} footprints` : b.sources[0]),
            ...(b.flags.length > 0 ? [el('div', {}, b.flags.join(', '))] : [])];
  }

  private tellMap(hit: MapHit): Content {
    const {facts} = this.model;
    if (hit.side === 'after') return this.tellBuilding(hit.index);
    const f = facts.footprints[hit.index];
    if (f.building < 0) return [el('b', {}, f.source), el('div', {}, `dropped: ${f.reason ?? 'no reason given'}`)];
    const b = facts.buildings[f.building];
    return [el('b', {}, f.source),
            el('div', {}, b.sources.length > 1 ? `merged with ${plural(b.sources.length - 1, 'other')} into ${b.id}` : `kept as ${b.id}`)];
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
    const perPixel = view.metresPerPixel(), metres = niceLength(perPixel * 110);
    const scale = byId('scale');
    (scale.lastElementChild as HTMLElement).style.width = `${metres / perPixel}px`;
    scale.firstElementChild!.textContent = metres < 1000 ? `${metres} m` : `${metres / 1000} km`;
    byId('north').querySelector('svg')!.style.transform = `rotate(${-view.heading()}rad)`;
  }

  private showLegend(): void {
    const parts = this.showsMap ? mapLegend(this.map, this.theme) : cityLegend(this.model, this.colours, this.cut !== 'off');
    byId('legend').replaceChildren(...parts);
    byId('legend').hidden = parts.length === 0;
  }
}
