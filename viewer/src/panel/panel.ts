// What is beside the picture: numbers, histograms, warnings, times, the command.

import type {Building, CellScore, Facts, Report, WorstCell} from '../facts.js';
import {areaOf, type Outline} from '../map/polygons.js';
import {byId, el, fixed, megabytes, plural, seconds, whole} from '../ui/dom.js';
import {css, kBestAngle, kFlagStyles, kHeightRamp, kNoFlag, kQualityRamp} from '../view/colours.js';
import {heightOf, highest} from '../model.js';
import {type Bar, histogram, niceStep} from './charts.js';

export interface PanelActions {
  /** Shows a building, -1: none. */
  select: (building: number) => void;
  /** Shows a footprint that was dropped. */
  showFootprint: (footprint: number) => void;
  /** Flies to one of the report's worst cells; null: it cannot. */
  showCell: ((number: number) => void) | null;
}

const section = (id: string, title: string, ...children: (Node | string | null | false)[]): HTMLElement =>
    el('section', {id, 'aria-labelledby': `${id}-title`}, el('h2', {id: `${id}-title`}, title), ...children);

const fact = (name: string, value: string, small = ''): Node[] =>
    [el('div', {}, el('dt', {}, name), el('dd', {}, value, small !== '' && el('small', {}, small)))];

/** The last part of the folder that the results are in. */
export function runName(facts: Facts): string {
  const out = String(facts.report?.config['out'] ?? '').replace(/\/+$/, '');
  return out.slice(out.lastIndexOf('/') + 1) || 'City';
}

/** By the measures of wind engineering; nothing where there is nothing to count. */
const resolution = (name: string, score: CellScore | undefined): Node[] =>
    score === undefined || score.count === 0 ? [] :
    fact(name, fixed(score.median, 1), `median; ${fixed(100 * score.share_of_ten, 0)} % have ten`);

function overview(facts: Facts): HTMLElement[] {
  const {report} = facts;
  const [xmin, ymin, xmax, ymax] = facts.domain, fitted = report?.city?.domain;
  const [length, width] = fitted !== undefined && fitted.length > 0 ? [fitted.length, fitted.width] : [xmax - xmin, ymax - ymin];
  const mesh = report?.volume_mesh;
  const crs = facts.crs.length > 40 ? facts.crs.slice(0, 37) + '…' : facts.crs;
  const header = el('header', {},
      el('h1', {}, runName(facts)),
      el('p', {}, `${whole(length)} × ${whole(width)} m${crs === '' ? '' : ` · ${crs}`}`));
  const list = el('dl', {class: 'facts'},
      ...fact('Buildings', whole(facts.buildings.length),
              facts.footprints.length > 0 ? `of ${plural(facts.footprints.length, 'footprint')}` : ''),
      ...(facts.cells > 0 ? fact('Cells', whole(facts.cells), mesh ? plural(mesh.vertices, 'node') + ((mesh.prisms?.cells ?? 0) > 0 && !facts.whole ? `, ${plural(mesh.prisms!.cells, 'prism')}` : '') : '') : []),
      ...(mesh?.prisms && facts.whole ? fact('Non-orthogonality', `${fixed(mesh.prisms.non_orthogonality_deg.max, 1)}°`, `at most; mean ${fixed(mesh.prisms.non_orthogonality_deg.mean, 1)}°`) :
          mesh ? fact('Least dihedral angle', `${fixed(mesh.dihedral_deg.min, 1)}°`, `median ${fixed(mesh.dihedral_deg.median, 1)}°`) : []),
      ...resolution('Cells per building', report?.ground_mesh?.cells_per_building),
      ...resolution('Cells per street', report?.ground_mesh?.cells_per_gap),
      ...(report?.city?.domain?.building_height ?
          fact('Blockage', `${fixed(100 * report.city.domain.blockage, 1)} %`,
               `tallest: ${report.city.domain.tallest_building}, ${fixed(report.city.domain.building_height, 1)} m`) : []),
      ...(report ? fact('Time', seconds(totalSeconds(report)), `${plural(report.threads, 'thread')}, ${megabytes(report.peak_rss_bytes)}`) : []));
  const checks: [boolean, string, string][] = [];
  if (report?.surface_mesh) {
    checks.push([report.surface_mesh.closed && report.surface_mesh.manifold, 'Boundary closed and manifold', 'Boundary not closed or not manifold']);
    checks.push([(mesh?.inverted ?? 0) === 0, 'All cells positive', `${whole(mesh?.inverted ?? 0)} cells inverted`]);
    checks.push([report.warnings.length === 0, 'No warnings', plural(report.warnings.length, 'warning')]);
  }
  return [header, list, el('ul', {class: 'checks'}, ...checks.map(([good, yes, no]) => el('li', {class: good ? '' : 'bad'}, good ? yes : no)))];
}

const totalSeconds = (report: Report): number => report.steps.reduce((sum, step) => sum + step.seconds, 0);

/** The building that is selected, or a way to find one. */
class BuildingSection {
  readonly element = section('building', 'Building');
  private readonly body = el('div', {'aria-live': 'polite'});
  /** Of footprints by their ids. */
  private readonly numbers: ReadonlyMap<string, number>;

  constructor(private readonly facts: Facts, private readonly before: readonly Outline[],
              private readonly actions: PanelActions) {
    this.numbers = new Map(facts.footprints.map((f, i) => [f.source, i]));
    const input = el('input', {type: 'search', placeholder: 'Id of a building or a footprint', 'aria-label': 'Id of a building or a footprint'});
    const find = (event: Event): void => {
      event.preventDefault();
      this.find(input.value.trim());
    };
    this.element.append(el('form', {class: 'find', onsubmit: find}, input, el('button', {type: 'submit'}, 'Find')), this.body);
    this.show(-1);
  }

  private area(source: string): string {
    const i = this.numbers.get(source);
    return i === undefined ? '' : `${whole(areaOf(this.before[i]))} m²`;
  }

  /** Whole ids first, of whatever has them; then the first that begins with it or has it within. */
  private find(wanted: string): void {
    const {buildings, footprints} = this.facts;
    if (wanted === '') return this.actions.select(-1);
    const isDropped = (i: number): boolean => footprints[i].building < 0;
    const search = (fits: (id: string) => boolean): (() => void) | undefined => {
      const building = buildings.findIndex((b) => fits(b.id) || b.sources.some(fits));
      if (building >= 0) return () => this.actions.select(building);
      const dropped = footprints.findIndex((f, i) => isDropped(i) && fits(f.source));
      return dropped < 0 ? undefined : () => this.actions.showFootprint(dropped);
    };
    const low = wanted.toLowerCase();
    const whole = search((id) => id === wanted) ?? search((id) => id.toLowerCase() === low);
    const part = whole ?? search((id) => id.toLowerCase().startsWith(low)) ?? search((id) => id.toLowerCase().includes(low));
    if (part === undefined) return this.say(`Nothing has the id ${wanted}.`);
    part();
    if (whole === undefined) this.body.prepend(el('p', {class: 'soft'}, `No id is ${wanted}; the first with it in its name:`));
  }

  private say(text: string): void { this.body.replaceChildren(el('p', {class: 'soft'}, text)); }

  showFootprint(footprint: number): void {
    const {source, reason} = this.facts.footprints[footprint];
    this.say(`Footprint ${source} was dropped: ${reason ?? 'no reason given'}.`);
  }

  show(building: number): void {
    if (building < 0) return this.say('Click a building to see its heights, flags and footprints.');
    this.body.replaceChildren(...describeBuilding(this.facts.buildings[building], (source) => this.area(source)),
                              el('button', {class: 'copy', onclick: () => this.actions.select(-1)}, 'Let go'));
  }
}

/** "LoD 2.2, 5 parts, rmse 0.31 m" of a roof that is not one level block, else nothing. */
function describeRoof(b: Building): string {
  if (b.parts === undefined) return '';
  return [b.lod === 'block' ? 'block' : `LoD ${b.lod}`, plural(b.parts, 'part'),
          ...(b.rmse === undefined ? [] : [`rmse ${fixed(b.rmse, 2)} m`])].join(', ');
}

/** `area`: of a footprint as text, as far as it is known. */
function describeBuilding(b: Building, area: (source: string) => string): Node[] {
  const pair = (name: string, value: string): Node[] => [el('dt', {}, name), el('dd', {}, value)];
  const flags = b.flags.map((flag) => {
    const {colour, label} = kFlagStyles.find((s) => s.name === flag) ?? {...kNoFlag, label: flag};
    return el('span', {class: 'chip', title: flag}, el('i', {style: `background:${css(colour)}`}), label);
  });
  return [
    el('p', {}, el('b', {}, b.id), ' · ', `${fixed(heightOf(b), 1)} m high, ${whole(b.area)} m²`),
    el('div', {}, ...flags),
    el('dl', {class: 'pairs'},
       ...(b.parts === undefined ? [] : pair('Roof', describeRoof(b))),
       ...pair(b.parts === undefined ? 'Roof' : 'Block', `${fixed(b.roof, 2)} m, of ${plural(b.roofPoints, 'point')}`),
       ...pair('Ground', `${fixed(b.ground, 2)} m, of ${plural(b.groundPoints, 'point')}`)),
    el('p', {class: 'soft'}, b.sources.length > 1 ? `Merged from ${whole(b.sources.length)} footprints` : 'One footprint'),
    el('ul', {class: 'members'}, ...b.sources.slice(0, 500).map((source) =>
        el('li', {}, el('span', {}, source), el('span', {}, area(source))))),
    ...(b.sources.length > 500 ? [el('p', {class: 'soft'}, `and ${whole(b.sources.length - 500)} more`)] : []),
  ];
}

/** With the number of features, most first; those that differ in an area alone are one. */
function reasons(facts: Facts): [string, number][] {
  const counts = new Map<string, number>();
  for (const [reason, count] of Object.entries(facts.dropped)) {
    const kind = reason.replace(/^area [\d.]+ m2 /, 'area ').replace(/ m2\b/g, '\u00a0m²');
    counts.set(kind, (counts.get(kind) ?? 0) + count);
  }
  return [...counts].sort((a, b) => b[1] - a[1]);
}

function fates(facts: Facts): HTMLElement | null {
  const merged = facts.buildings.filter((b) => b.sources.length > 1);
  const dropped = reasons(facts);
  const sum = dropped.reduce((n, [, count]) => n + count, 0);
  const members = merged.reduce((n, b) => n + b.sources.length, 0);
  const kept = facts.buildings.length - merged.length;
  const total = kept + members + sum;
  if (total === 0) return null;
  const part = (name: string, n: number, colour: string, text: string): [HTMLElement, HTMLElement] => [
    el('div', {style: `flex:${n};background:${colour}`, title: `${whole(n)} ${name}`}),
    el('li', {}, el('span', {class: 'swatch', style: `background:${colour}`}), text, el('span', {class: 'count'}, whole(n))),
  ];
  const parts = [
    part('kept', kept, '#8d9db0', 'kept as they are'),
    part('merged', members, '#5fa39a', `merged into ${plural(merged.length, 'building')}`),
    ...dropped.map(([reason, n]) => part('dropped', n, '#d9705c', `dropped: ${reason}`)),
  ].filter((_, i) => [kept, members, ...dropped.map(([, n]) => n)][i] > 0);
  return section('fates', 'What became of the footprints',
      el('div', {class: 'stack'}, ...parts.map(([bar]) => bar)),
      el('ul', {class: 'keys column'}, ...parts.map(([, key]) => key)));
}

function heights(facts: Facts): HTMLElement | null {
  const values = facts.buildings.map(heightOf);
  if (values.length === 0) return null;
  const most = highest(facts), median = values.slice().sort((a, b) => a - b)[values.length >> 1];
  const step = niceStep(most, 22);
  const bars: Bar[] = [];
  for (let from = 0; from < most; from += step) {
    const count = values.filter((v) => v >= from && (v < from + step || (from + step >= most && v >= from))).length;
    bars.push({from, to: from + step, count, colour: css(kHeightRamp.at((from + step / 2) / most)),
               title: `${fixed(from, step < 1 ? 1 : 0)} to ${fixed(from + step, step < 1 ? 1 : 0)} m: ${plural(count, 'building')}`});
  }
  const end = bars[bars.length - 1].to, tick = niceStep(end, 5);
  const ticks = Array.from({length: Math.floor(end / tick) + 1}, (_, i) => +(i * tick).toFixed(6));
  const element = section('heights', 'Heights of buildings',
      histogram(bars, ticks, ' m', [{at: median, name: `median ${fixed(median, 1)} m`}], 'Histogram of the heights of buildings'));
  element.querySelector('h2')!.append(el('span', {class: 'aside'}, `highest ${fixed(most, 1)} m`));
  return element;
}

function quality(report: Report): HTMLElement | null {
  const mesh = report.volume_mesh;
  const counts = mesh?.dihedral_deg.counts;
  if (mesh === undefined || counts === undefined || !counts.some((count) => count > 0)) return null;
  const all = counts.reduce((sum, count) => sum + count, 0);
  const bars = counts.map((count, i): Bar => ({
    from: i, to: i + 1, count, colour: css(kQualityRamp.at((i + 0.5) / kBestAngle)),
    title: `${i} to ${i + 1}°: ${plural(count, 'cell')} (${(100 * count / all).toPrecision(2)} %)`,
  }));
  const d = mesh.dihedral_deg;
  const element = section('quality', 'Quality of cells',
      histogram(bars, [0, 10, 20, 30, 40, 50, 60, 70], '°',
                [{at: d.min, name: `least ${fixed(d.min, 1)}°`}, {at: d.p1, name: `1 % of cells below ${fixed(d.p1, 1)}°`}],
                'Histogram of the least dihedral angles of cells'),
      el('p', {class: 'soft'}, `Least dihedral angle of each cell; 70.5° is the regular tetrahedron. Greatest angle of all ${fixed(d.max, 1)}°, aspect ratio up to ${fixed(mesh.aspect_ratio.max, 1)}.`));
  element.querySelector('h2')!.append(el('span', {class: 'aside'}, `median ${fixed(d.median, 1)}°`));
  return element;
}

class WorstCells {
  readonly element: HTMLElement;
  private readonly buttons: HTMLButtonElement[];

  constructor(cells: readonly WorstCell[], {showCell}: PanelActions) {
    this.buttons = cells.map((cell, i) => el('button', {'aria-pressed': 'false', disabled: showCell === null, onclick: () => showCell?.(i)},
        el('span', {class: 'soft'}, i + 1), el('span', {}, `${fixed(cell.min_dihedral_deg, 1)}°`),
        el('span', {}, `${fixed(cell.max_dihedral_deg, 1)}°`), el('span', {}, cell.cause)));
    this.element = section('worst', 'Worst cells',
        el('div', {class: 'head'}, el('span', {}), el('span', {}, 'least'), el('span', {}, 'greatest'), el('span', {}, 'cause')),
        el('div', {class: 'cells'}, ...this.buttons.map((button) => el('div', {style: 'border-top:1px solid var(--line)'}, button))));
    if (showCell !== null) this.element.querySelector('h2')!.append(el('span', {class: 'aside'}, 'click to fly there'));
  }

  show(number: number): void {
    this.buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(i === number)));
  }
}

/** Settings become the options of the command line, as with_options of apps/tetropolis/options.h has them. */
function withOptions(message: string, config: Report['config']): (Node | string)[] {
  const option = (name: string): string | null => name in config ? `--${name.replaceAll('_', '-')}` : null;
  // What is quoted, or words with an underscore.
  return message.split(/(`[^`]*`(?: = )?|\b[a-z]+(?:_[a-z]+)+\b(?: = )?)/).map((part, i) => {
    if (i % 2 === 0) return part;
    const [, quoted, bare, equals] = /^(?:`([^`]*)`|(.*?))( = )?$/.exec(part)!;
    const known = option(quoted ?? bare);
    if (known !== null) return el('code', {}, equals === undefined ? known : `${known} `);
    return quoted === undefined ? part : el('code', {}, quoted, equals);
  });
}

function warnings(report: Report): HTMLElement {
  return section('warnings', 'Warnings', ...(report.warnings.length === 0 ? [el('p', {class: 'soft'}, 'None.')] :
      report.warnings.map((w) => el('div', {class: 'warning'}, ...withOptions(w.message, report.config), ' ', el('code', {}, w.count > 1 ? `${w.code} × ${whole(w.count)}` : w.code)))));
}

function times(report: Report): HTMLElement {
  const total = totalSeconds(report);
  const shown = report.steps.filter((s) => s.seconds >= 0.005 * total);
  const longest = Math.max(...shown.map((s) => s.seconds), 1e-9);
  const rest = report.steps.filter((s) => !shown.includes(s));
  const element = section('times', 'Time and memory',
      el('div', {class: 'steps'}, ...shown.flatMap((s) => [
        el('span', {class: 'id'}, s.id), el('span', {class: 'what', title: s.name}, s.name),
        el('div', {class: 'track', title: `CPU time of all threads ${seconds(s.cpu_seconds)}`},
           el('div', {style: `width:${(100 * s.seconds / longest).toFixed(1)}%`})),
        el('span', {class: 'time'}, seconds(s.seconds)),
        el('span', {class: 'time', title: 'Most memory until the end of the step'}, s.peak_rss_bytes ? megabytes(s.peak_rss_bytes) : ''),
      ])),
      rest.length > 0 && el('p', {class: 'soft'}, `${plural(rest.length, 'other step')}: ${seconds(rest.reduce((n, s) => n + s.seconds, 0))}`));
  element.querySelector('h2')!.append(el('span', {class: 'aside'}, `${seconds(total)}, at most ${megabytes(report.peak_rss_bytes)}`));
  return element;
}

function repeat(command: string): HTMLElement {
  const copy = el('button', {class: 'copy', onclick: async () => {
    await copyText(command);
    copy.textContent = 'Copied';
    setTimeout(() => { copy.textContent = 'Copy'; }, 1500);
  }}, 'Copy');
  const element = section('repeat', 'Run it again', el('pre', {}, command));
  element.querySelector('h2')!.append(copy);
  return element;
}

async function copyText(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages from file:// may have no clipboard of that kind.
    const area = el('textarea', {style: 'position:fixed;opacity:0'}, text);
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

export class Panel {
  private readonly building: BuildingSection;
  private readonly worst: WorstCells | null = null;

  constructor(facts: Facts, before: readonly Outline[], actions: PanelActions) {
    const {report} = facts;
    this.building = new BuildingSection(facts, before, actions);
    const cells = report?.volume_mesh?.worst_cells ?? [];
    if (cells.length > 0) this.worst = new WorstCells(cells, actions);
    const parts: (HTMLElement | null | undefined)[] = [
      ...overview(facts), this.building.element, fates(facts), heights(facts), report && quality(report),
      this.worst?.element, report && warnings(report), report && times(report),
      facts.repeat === '' ? null : repeat(facts.repeat),
      report?.files && section('files', 'Files', el('p', {class: 'soft'}, report.files.join(' · '))),
      el('footer', {}, `Tetropolis ${facts.version}. Drawn with three.js (MIT licence, in this page's source). Nothing is loaded from anywhere.`),
    ];
    byId('panel').append(...parts.filter((p): p is HTMLElement => p !== null && p !== undefined));
  }

  showBuilding(building: number): void { this.building.show(building); }
  showFootprint(footprint: number): void { this.building.showFootprint(footprint); }
  showCell(number: number): void { this.worst?.show(number); }
}
