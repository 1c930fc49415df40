// Reads the run and shows it.

import {buildingOf, MapView} from './map/map_view.js';
import {cellCount} from './mesh/columns.js';
import {lookAtSky, makeHeightGrid} from './mesh/sky.js';
import {type Model, readModel} from './model.js';
import {Page, pause} from './page.js';
import {Panel, runName} from './panel/panel.js';
import type {Blocks} from './payload.js';
import {byId, el} from './ui/dom.js';
import {mapLegend} from './ui/legend.js';
import {currentTheme} from './ui/theme.js';
import {CityView} from './view/city_view.js';

/** The light of the sky takes a while to find: the city is there before. */
async function lightSky({mesh, frame, size}: Model, view: CityView): Promise<void> {
  if (mesh === null) return;
  const grid = makeHeightGrid(mesh, frame, [-size.x / 2, -size.y / 2, size.x / 2, size.y / 2], size.x * size.y > 4e6 ? 2048 : 1024);
  const sweeps = lookAtSky(grid, 16);
  for (let next = sweeps.next();; next = sweeps.next()) {
    if (next.done === true) return view.setSky(next.value);
    await pause();
  }
}

/** What is left where there is no WebGL: the map and the numbers. */
function showWithoutCity(model: Model, map: MapView, why: unknown): void {
  const page = byId('stage');
  page.classList.add('show-map', 'no-city');
  byId('map').hidden = false;
  const {facts, before, after} = model;
  const select = (building: number): void => {
    map.setSelected(building);
    panel.showBuilding(building);
  };
  const panel = new Panel(facts, before, {
    select: (building) => {
      select(building);
      if (building >= 0) map.show(after[building].box);
    },
    showFootprint: (footprint) => {
      panel.showFootprint(footprint);
      map.show(before[footprint].box);
    },
    showCell: null,
  });
  map.onClick = (hit) => {
    if (hit !== null && buildingOf(facts, hit) < 0) panel.showFootprint(hit.index);
    else select(hit === null ? -1 : buildingOf(facts, hit));
  };
  const theme = currentTheme();
  document.documentElement.dataset['theme'] = theme;
  map.setDark(theme === 'dark');
  byId('legend').replaceChildren(
      ...mapLegend(map, theme),
      el('p', {class: 'note'}, `The city in 3D needs WebGL 2, which this browser does not offer (${why instanceof Error ? why.message : String(why)}).`));
}

async function start(): Promise<void> {
  const began = performance.now();
  const model = await readModel(JSON.parse(byId('run').textContent!) as Blocks);
  document.title = `${runName(model.facts)} · Tetropolis`;
  const milliseconds = performance.now() - began;
  const map = new MapView(byId('map'), model.facts, model.before, model.after);
  byId('wait').hidden = true;
  let view: CityView;
  try {
    view = new CityView(byId<HTMLCanvasElement>('city'), model.surface, model.facts.buildings.length, model.size,
                        (model.base - model.frame.centre[2]) * model.frame.step);
  } catch (error) {
    return showWithoutCity(model, map, error);
  }
  const page = new Page(model, view, map);
  await pause();
  await lightSky(model, view);
  // What tests look at.
  Object.assign(window, {tetropolis: {
    model, view, page, milliseconds, cells: model.facts.volume && model.mesh !== null ? cellCount(model.mesh) : 0}});
}

start().catch((error: unknown) => {
  console.error(error);
  byId('wait').hidden = false;
  byId('wait').replaceChildren(el('p', {}, `This page cannot be shown: ${error instanceof Error ? error.message : String(error)}. It needs a browser with WebGL 2 and DecompressionStream (Chrome 94, Firefox 113, Safari 16.4 or later).`));
});
