// What colours mean.

import {fateColour, type MapView} from '../map/map_view.js';
import {kSurfaceKinds} from '../mesh/columns.js';
import {highest, type Model} from '../model.js';
import {
  css, flagStyle, kClassColours, kFlagStyles, kGroundColours, kHeightRamp, kNoFlag, kPrismColour, kQualityRamp, kSolidColours, type Rgb, type Theme,
} from '../view/colours.js';
import {el, fixed, whole} from './dom.js';

export type Colours = 'class' | 'height' | 'quality' | 'flags';

const key = (colour: Rgb | string, text: string, count?: number): HTMLElement => el('li', {},
    el('span', {class: 'swatch', style: `background:${typeof colour === 'string' ? colour : css(colour)}`}), text,
    count !== undefined && el('span', {class: 'count'}, whole(count)));

const ramp = (title: string, gradient: string, ticks: readonly string[]): HTMLElement => el('div', {},
    el('h3', {}, title), el('div', {class: 'ramp', style: `background:${gradient}`}),
    el('div', {class: 'ticks'}, ...ticks.map((t) => el('span', {}, t))));

const kAngles = ['0°', '20°', '40°', '60°'];

export function mapLegend(map: MapView, theme: Theme): HTMLElement[] {
  const fates = ([['kept', 'kept'], ['merged', 'merged with neighbours'], ['dropped', 'dropped']] as const).filter(([fate]) => map.count(fate) > 0);
  return fates.length === 0 ? [] : [el('ul', {class: 'keys column'}, ...fates.map(([fate, text]) => key(fateColour(fate, theme === 'dark'), text, map.count(fate))))];
}

/** `cuts`: whether a plane cuts the city. */
export function cityLegend({facts, mesh}: Model, colours: Colours, cuts: boolean): HTMLElement[] {
  const parts: HTMLElement[] = [];
  if (colours === 'class')
    parts.push(el('ul', {class: 'keys'}, key(kGroundColours[0], 'ground'), ...kSurfaceKinds.flatMap((kind, k) => mesh?.regionBuilding.includes(-2 - k) ? [key(kGroundColours[k + 1], kind)] : []), key(kClassColours.roof, 'roof'), key(kClassColours.wall, 'wall')));
  if (colours === 'height')
    parts.push(ramp('Height above the ground', kHeightRamp.gradient(), ['0', fixed(highest(facts) / 2, 0), `${fixed(highest(facts), 0)} m`]));
  if (colours === 'quality') {
    parts.push(ramp('Least dihedral angle', kQualityRamp.gradient(), kAngles));
    parts.push(el('p', {class: 'note'}, 'of the worst cell over each triangle'));
  }
  if (colours === 'flags' && facts.buildings.length > 0) {
    const counts = new Map<string, number>();
    for (const {flags} of facts.buildings) counts.set(flagStyle(flags).name, (counts.get(flagStyle(flags).name) ?? 0) + 1);
    parts.push(el('ul', {class: 'keys column'}, ...[...kFlagStyles, kNoFlag].filter((s) => counts.has(s.name))
        .map((s) => key(s.colour, s.label, counts.get(s.name)!))));
  }
  if (cuts) {
    if (facts.volume && !facts.whole && colours !== 'quality') parts.push(ramp('Cells at the plane: least dihedral angle', kQualityRamp.gradient(), kAngles));
    parts.push(el('ul', {class: 'keys'}, (facts.whole || facts.layers > 0) && key(kPrismColour, 'prism'), key(kSolidColours.building, 'building'), key(kSolidColours.soil, 'soil')));
  }
  if (facts.cells > 0 && !facts.volume)
    parts.push(el('p', {class: 'note'}, `${whole(facts.cells)} cells are too many for a page: this one shows ${facts.mesh ? 'the surface, and sections without cells' : 'the buildings as blocks'}.`));
  else if (mesh === null && facts.buildings.length > 0)
    parts.push(el('p', {class: 'note'}, 'Buildings as blocks on level ground.'));
  return parts;
}
