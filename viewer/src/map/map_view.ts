// The map: footprints as they were on the left of a line that moves, the buildings made of them on
// its right.

import type {Facts} from '../facts.js';
import {el} from '../ui/dom.js';
import {contains, type Outline} from './polygons.js';

export type Fate = 'kept' | 'merged' | 'dropped';

/** What the pointer is on. */
export interface MapHit {
  side: 'before' | 'after';
  /** Of the footprints, or of the buildings. */
  index: number;
}

/** -1 of a dropped footprint. */
export const buildingOf = ({footprints}: Facts, {side, index}: MapHit): number =>
    side === 'after' ? index : footprints[index].building;

const kColours = {
  light: {paper: '#f4f2ed', domain: '#ffffff', line: '#4b5563', edge: '#2b313a', kept: '#8d9db0', merged: '#5fa39a',
          dropped: '#d9705c', faint: '#b9b4ab', accent: '#ffb224'},
  dark: {paper: '#14171c', domain: '#1b1f26', line: '#8791a0', edge: '#aeb5c0', kept: '#5c6b7e', merged: '#3f837b',
         dropped: '#b9523f', faint: '#4a505b', accent: '#ffb224'},
};

export const fateColour = (fate: Fate, dark: boolean): string => kColours[dark ? 'dark' : 'light'][fate];

/** Its width in style.css. */
const kThumb = 34;

export class MapView {
  onHover: (hit: MapHit | null, x: number, y: number) => void = () => {};
  onClick: (hit: MapHit | null) => void = () => {};
  selected = -1;

  private readonly canvas = el('canvas', {'aria-label': 'Map of the footprints before and after merging', role: 'img', tabindex: 0});
  private readonly line = el('div', {class: 'line'});
  private readonly slider = el('input', {type: 'range', min: 0, max: 1000, value: 500, 'aria-label': 'Border between before and after'});
  private readonly fates: Fate[];
  /** What the legend counts. */
  private readonly told: Fate[];
  private dark = false;
  private frame = 0;
  // CSS pixels = (metres - centre) * scale, y upwards.
  private centre: [number, number] = [0, 0];
  private scale = 1;
  private fitted = false;
  private readonly pointers = new Map<number, PointerEvent>();
  private moved = false;

  constructor(private readonly host: HTMLElement, private readonly facts: Facts,
              private readonly before: readonly Outline[], private readonly after: readonly Outline[]) {
    const fateOf = (building: number): Fate =>
        building < 0 ? 'dropped' : facts.buildings[building].sources.length > 1 ? 'merged' : 'kept';
    this.fates = facts.footprints.map((f) => fateOf(f.building));
    // Pages of meshes alone have no footprints.
    this.told = this.fates.length > 0 ? this.fates : facts.buildings.map((_, b) => fateOf(b));
    const swipe = el('div', {id: 'swipe'}, this.line,
                     el('span', {class: 'word', style: 'right:calc(100% - var(--at) + 10px)'}, 'Before'),
                     el('span', {class: 'word', style: 'left:calc(var(--at) + 10px)'}, 'After'), this.slider);
    if (before.length === 0) swipe.hidden = true;
    host.append(this.canvas, swipe);
    this.slider.addEventListener('input', () => this.invalidate());
    new ResizeObserver(() => this.invalidate()).observe(host);
    this.listen();
  }

  count(fate: Fate): number { return this.told.filter((f) => f === fate).length; }

  setDark(dark: boolean): void {
    this.dark = dark;
    this.invalidate();
  }

  setSelected(building: number): void {
    this.selected = building;
    this.invalidate();
  }

  home(): void {
    this.fitted = false;
    this.invalidate();
  }

  /** Moves to a box (xmin, ymin, xmax, ymax; metres), and nearer if it would be small. */
  show([xmin, ymin, xmax, ymax]: Outline['box']): void {
    this.centre = [(xmin + xmax) / 2, (ymin + ymax) / 2];
    this.scale = Math.max(this.scale, Math.min(this.host.clientWidth, this.host.clientHeight) / 8 / Math.max(1, xmax - xmin, ymax - ymin));
    this.fitted = true;
    this.invalidate();
  }

  /** Where the line between before and after is, CSS pixels. */
  private border(): number {
    if (this.before.length === 0) return 0;
    // Under the middle of the slider's thumb, which stays within.
    return kThumb / 2 + Number(this.slider.value) / 1000 * (this.host.clientWidth - kThumb);
  }

  invalidate(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.draw());
  }

  private listen(): void {
    const {canvas} = this;
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, event);
      this.moved = false;
    });
    canvas.addEventListener('pointermove', (event) => {
      const last = this.pointers.get(event.pointerId);
      if (last === undefined) return this.onHover(this.hit(event), event.clientX, event.clientY);
      const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY;
      if (Math.hypot(dx, dy) > 2) this.moved = true;
      if (!this.moved) return;
      if (this.pointers.size === 2) {
        const other = [...this.pointers.values()].find((p) => p.pointerId !== event.pointerId)!;
        const distance = (p: PointerEvent): number => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY);
        this.zoom(distance(event) / Math.max(1, distance(last)), (event.clientX + other.clientX) / 2, (event.clientY + other.clientY) / 2);
      }
      this.centre[0] -= dx / this.scale / this.pointers.size;
      this.centre[1] += dy / this.scale / this.pointers.size;
      this.pointers.set(event.pointerId, event);
      this.invalidate();
    });
    const end = (event: PointerEvent): void => {
      if (this.pointers.delete(event.pointerId) && !this.moved && event.type === 'pointerup') this.onClick(this.hit(event));
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
    canvas.addEventListener('pointerleave', () => this.onHover(null, 0, 0));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.clientX, event.clientY);
    }, {passive: false});
    canvas.addEventListener('keydown', (event) => {
      const move = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
      if (move !== undefined) {
        this.centre[0] += (60 * move[0]) / this.scale;
        this.centre[1] += (60 * move[1]) / this.scale;
      } else if (event.key === '+' || event.key === '=') this.scale *= 1.25;
      else if (event.key === '-') this.scale /= 1.25;
      else if (event.key === 'Home') this.fitted = false;
      else return;
      event.preventDefault();
      this.invalidate();
    });
  }

  private zoom(factor: number, clientX: number, clientY: number): void {
    const [x, y] = this.toMetres(clientX, clientY);
    this.scale = Math.min(200, Math.max(0.005, this.scale * factor));
    const [x2, y2] = this.toMetres(clientX, clientY);
    this.centre[0] += x - x2;
    this.centre[1] += y - y2;
    this.invalidate();
  }

  private toMetres(clientX: number, clientY: number): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [this.centre[0] + (clientX - box.left - box.width / 2) / this.scale,
            this.centre[1] - (clientY - box.top - box.height / 2) / this.scale];
  }

  private hit(event: PointerEvent): MapHit | null {
    const side = event.clientX - this.canvas.getBoundingClientRect().left < this.border() ? 'before' : 'after';
    const [x, y] = this.toMetres(event.clientX, event.clientY);
    const outlines = side === 'before' ? this.before : this.after;
    const index = outlines.findIndex((outline) => contains(outline, x, y));
    if (index >= 0) return {side, index};
    // What was dropped is told on both sides.
    if (side === 'after') {
      const dropped = this.before.findIndex((outline, i) => this.fates[i] === 'dropped' && contains(outline, x, y));
      if (dropped >= 0) return {side: 'before', index: dropped};
    }
    return null;
  }

  private fit(width: number, height: number): void {
    const [xmin, ymin, xmax, ymax] = this.facts.domain;
    this.centre = [(xmin + xmax) / 2, (ymin + ymax) / 2];
    this.scale = Math.min((width - 60) / (xmax - xmin), (height - 200) / (ymax - ymin));
    this.fitted = true;
  }

  private draw(): void {
    this.frame = 0;
    const width = this.host.clientWidth, height = this.host.clientHeight, ratio = window.devicePixelRatio;
    if (width === 0) return;
    if (!this.fitted) this.fit(width, height);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const context = this.canvas.getContext('2d')!;
    const colours = kColours[this.dark ? 'dark' : 'light'];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colours.paper;
    context.fillRect(0, 0, width, height);
    const x = (metres: number): number => width / 2 + (metres - this.centre[0]) * this.scale;
    const y = (metres: number): number => height / 2 - (metres - this.centre[1]) * this.scale;
    const {outline} = this.facts;
    context.beginPath();
    for (let i = 0; i < outline.length; i += 2) context.lineTo(x(outline[i]), y(outline[i + 1]));
    context.closePath();
    context.fillStyle = colours.domain;
    context.fill();
    context.strokeStyle = colours.line;
    context.setLineDash([6, 4]);
    context.stroke();
    context.setLineDash([]);

    const isSeen = ({box}: Outline): boolean => x(box[2]) > 0 && x(box[0]) < width && y(box[1]) > 0 && y(box[3]) < height;
    const trace = (outline: Outline): void => {
      for (const ring of outline.rings) {
        context.moveTo(x(ring[0]), y(ring[1]));
        for (let i = 2; i < ring.length; i += 2) context.lineTo(x(ring[i]), y(ring[i + 1]));
        context.closePath();
      }
    };
    // Lines would hide what is small.
    const hasLines = this.scale > 0.3;
    /** All of them in one path, which is much faster than one each; overlaps are filled, holes run the other way. */
    const paint = (outlines: readonly Outline[], fillStyle: string | null, strokeStyle: string): void => {
      context.beginPath();
      for (const outline of outlines) if (isSeen(outline)) trace(outline);
      if (fillStyle !== null) {
        context.fillStyle = fillStyle;
        context.fill();
      }
      context.strokeStyle = strokeStyle;
      if (hasLines || fillStyle === null) context.stroke();
    };
    const within = (from: number, to: number, body: () => void): void => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, height);
      context.clip();
      body();
      context.restore();
    };
    const border = this.border();
    context.lineWidth = Math.min(1.2, Math.max(0.35, this.scale / 2));
    within(0, border, () => {
      for (const fate of ['dropped', 'kept', 'merged'] as const)
        paint(this.before.filter((_, i) => this.fates[i] === fate), colours[fate], colours.edge);
    });
    within(border, width, () => {
      paint(this.before.filter((_, i) => this.fates[i] === 'dropped'), null, colours.dropped);
      const merged = (b: number): boolean => this.facts.buildings[b].sources.length > 1;
      paint(this.after.filter((_, b) => !merged(b)), colours.kept, colours.edge);
      paint(this.after.filter((_, b) => merged(b)), colours.merged, colours.edge);
    });
    if (this.selected >= 0) {
      context.lineWidth = 3;
      paint([this.after[this.selected]], null, colours.accent);
    }
    this.host.style.setProperty('--at', `${border}px`);
    this.line.style.left = `${border}px`;
  }
}
