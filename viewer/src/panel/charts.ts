// Histograms.

import {svg} from '../ui/dom.js';

export interface Bar {
  from: number;
  to: number;
  count: number;
  colour: string;
  /** What is told on hover. */
  title: string;
}

export interface Mark {
  at: number;
  name: string;
}

/** Bars from the lowest `from` to the highest `to`; `ticks` below, marks as dashed lines with names. */
export function histogram(bars: readonly Bar[], ticks: readonly number[], unit: string, marks: readonly Mark[],
                          label: string): SVGSVGElement {
  const width = 340, height = 128, top = 14 + 13 * marks.length, bottom = 20;
  const low = bars[0].from, high = bars[bars.length - 1].to;
  const most = Math.max(...bars.map((bar) => bar.count), 1);
  const x = (value: number): number => ((value - low) / (high - low)) * width;
  const y = (count: number): number => height - bottom - (count / most) * (height - bottom - top);
  const chart = svg('svg', {class: 'chart', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': label});
  for (const bar of bars) {
    const left = x(bar.from), right = x(bar.to);
    // A few in many are seen, too.
    const high = bar.count > 0 ? Math.max(1.5, height - bottom - y(bar.count)) : 0;
    chart.append(
        svg('rect', {x: left + 0.5, width: Math.max(0.8, right - left - 1), y: height - bottom - high, height: high, fill: bar.colour}),
        svg('rect', {class: 'hit', x: left, width: right - left, y: top, height: height - bottom - top},
            svg('title', {}, bar.title)));
  }
  chart.append(svg('line', {class: 'axis', x1: 0, x2: width, y1: height - bottom + 0.5, y2: height - bottom + 0.5}));
  for (const tick of ticks) {
    const anchor = x(tick) < 12 ? 'start' : x(tick) > width - 8 ? 'end' : 'middle';
    chart.append(svg('text', {x: x(tick), y: height - 5, 'text-anchor': anchor}, `${tick}${unit}`));
  }
  marks.forEach((mark, i) => {
    const right = x(mark.at) > 0.6 * width;
    chart.append(
        svg('line', {class: 'mark', x1: x(mark.at), x2: x(mark.at), y1: 13 * i + 4, y2: height - bottom}),
        svg('text', {class: 'mark-name', x: x(mark.at) + (right ? -4 : 4), y: 13 * i + 11,
                     'text-anchor': right ? 'end' : 'start'}, mark.name));
  });
  return chart;
}

/** A step of 1, 2 or 5 times a power of ten that divides `range` into about `parts`. */
export function niceStep(range: number, parts: number): number {
  const raw = Math.max(range / parts, 1e-9), power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= raw) ?? 10 * power;
}
