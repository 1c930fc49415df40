// Colours of the city, in both themes, and the scales that numbers are shown by.

export type Rgb = readonly [number, number, number];
export type Theme = 'light' | 'dark';

export const rgb = (hex: string): Rgb =>
    [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)) as unknown as Rgb;
export const css = (c: Rgb): string => `rgb(${c.map((v) => Math.round(v)).join(' ')})`;

/** Of the ground, and of surface layers by their kind. */
export const kGroundColours = ['#b9bfa9', '#7fa3bf', '#a3a09b', '#93ac7c'].map(rgb);
export const kClassColours = {roof: rgb('#c17b63'), wall: rgb('#efe6d6'), soil: rgb('#9a8a78')};
/** Of the ground, where buildings have the colours. */
export const kQuietGround = rgb('#c3c6c4');
export const kAccent = rgb('#ffb224');
/** Their dihedral angles say nothing about them. */
export const kPrismColour = rgb('#b9d3d8');
export const kSolidColours = {soil: rgb('#8d7d6c'), building: rgb('#4a4e57')};

/** Colours at even distances. */
export class Ramp {
  constructor(private readonly stops: readonly Rgb[]) {}
  /** `t` in [0, 1]. */
  at(t: number): Rgb {
    const place = Math.min(1, Math.max(0, t)) * (this.stops.length - 1);
    const i = Math.min(Math.floor(place), this.stops.length - 2), s = place - i;
    return [0, 1, 2].map((k) => this.stops[i][k] * (1 - s) + this.stops[i + 1][k] * s) as unknown as Rgb;
  }
  gradient(): string {
    return `linear-gradient(to right, ${this.stops.map(css).join(', ')})`;
  }
  /** As a row of 256 texels. */
  texels(): Uint8Array<ArrayBuffer> {
    const bytes = new Uint8Array(1024);
    for (let i = 0; i < 256; ++i) bytes.set([...this.at(i / 255).map(Math.round), 255], 4 * i);
    return bytes;
  }
}

/** Heights of buildings. */
export const kHeightRamp = new Ramp(['#f4e3b5', '#e3b778', '#d0825f', '#ab5462', '#733a6b', '#45327a'].map(rgb));

/** Least dihedral angles, 0 to kBestAngle degrees: what is poor stands out, what is good is calm. */
export const kBestAngle = 60;
export const kQualityRamp = new Ramp(
    ['#8e0f2b', '#d1452f', '#f0a24f', '#f3dd9b', '#c3dcc0', '#86bcb4', '#5598ab', '#3f7aa0', '#365f92'].map(rgb));

export interface FlagStyle {
  name: string;
  colour: Rgb;
  label: string;
}

/** Most serious first: a building has the colour of the first one that it has. */
export const kFlagStyles: readonly FlagStyle[] = [
  {name: 'planned', colour: rgb('#2f6f9f'), label: 'planned'},
  {name: 'no_roof_points', colour: rgb('#c0392f'), label: 'no roof points'},
  {name: 'default_height', colour: rgb('#d4568b'), label: 'default height'},
  {name: 'roof_from_floors', colour: rgb('#c98a5e'), label: 'roof from floors'},
  {name: 'roof_from_attribute', colour: rgb('#e07b39'), label: 'roof from attribute'},
  {name: 'minimum_height', colour: rgb('#e5b83b'), label: 'minimum height'},
  {name: 'ground_from_dtm', colour: rgb('#8f9c3a'), label: 'ground from terrain'},
  {name: 'roof_from_unclassified', colour: rgb('#3f9c78'), label: 'roof by exclusion'},
  {name: 'convex_hull', colour: rgb('#a0559b'), label: 'convex hull'},
  {name: 'clipped', colour: rgb('#6a5fc1'), label: 'clipped'},
  {name: 'repaired', colour: rgb('#4a86c5'), label: 'repaired'},
  {name: 'merged', colour: rgb('#86a9c9'), label: 'merged'},
];
export const kNoFlag: FlagStyle = {name: '', colour: rgb('#dcdad4'), label: 'no flag'};

export const flagStyle = (flags: readonly string[]): FlagStyle =>
    kFlagStyles.find((style) => flags.includes(style.name)) ?? kNoFlag;
