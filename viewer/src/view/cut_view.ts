// What a plane cuts, as objects of the scene.

import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, SRGBColorSpace,
} from 'three';
import {kBuildingBit} from '../mesh/surface.js';
import {type CutCells, type CutSolids, kPrism} from '../mesh/section.js';
import {kBestAngle, kPrismColour, kQualityRamp, kSolidColours, type Rgb} from './colours.js';
import {featureAttribute, pickMaterial} from './surface_material.js';

function coloured(position: Float32Array, colourOf: (vertex: number) => Rgb): BufferGeometry {
  const geometry = new BufferGeometry();
  const colours = new Uint8Array(position.length);
  for (let v = 0; v < position.length / 3; ++v) colours.set(colourOf(v), 3 * v);
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  geometry.setAttribute('color', new BufferAttribute(srgbToLinear(colours), 3, true));
  return geometry;
}

/** Colours of vertices are linear. */
function srgbToLinear(bytes: Uint8Array): Uint16Array {
  const table = Uint16Array.from({length: 256}, (_, i) =>
      Math.round(65535 * new Color().setRGB(i / 255, 0, 0, SRGBColorSpace).r));
  return Uint16Array.from(bytes, (b) => table[b]);
}

/** Of pairs of points; of some of many. */
function meanLength(lines: Float32Array): number {
  const count = lines.length / 6, step = Math.max(1, Math.floor(count / 2000));
  let sum = 0, n = 0;
  for (let i = 0; i < count; i += step, ++n)
    sum += Math.hypot(...[0, 1, 2].map((k) => lines[6 * i + k] - lines[6 * i + 3 + k]));
  return sum / Math.max(1, n);
}

/** Holds one cut at a time. */
export class CutView {
  readonly group = new Group();
  /** The same for picks. */
  readonly picked = new Group();
  readonly picker = pickMaterial(DoubleSide);
  private readonly lineMaterial = new LineBasicMaterial({transparent: true, opacity: 0.45});
  private readonly flat = new MeshBasicMaterial({vertexColors: true, side: DoubleSide, polygonOffset: true,
                                                 polygonOffsetFactor: 1, polygonOffsetUnits: 1});
  private readonly lit = new MeshLambertMaterial({vertexColors: true, flatShading: true, side: DoubleSide,
                                                  polygonOffset: true, polygonOffsetFactor: 1,
                                                  polygonOffsetUnits: 1});

  /** Of the lines, metres. */
  private edge = 0;

  /** Lines fade where cells are a few pixels wide. */
  setDetail(metresPerPixel: number): void {
    const pixels = this.edge / metresPerPixel;
    this.lineMaterial.opacity = 0.5 * Math.min(1, Math.max(0.1, (pixels - 2) / 12));
  }

  set(cells: CutCells | null, solids: CutSolids | null, whole: boolean): void {
    this.clear();
    if (cells !== null) {
      const geometry = coloured(cells.position, (v) => cells.angle[v] === kPrism ? kPrismColour : [...kQualityRamp.at(cells.angle[v] / kBestAngle)].map(Math.round) as unknown as Rgb);
      if (whole) geometry.computeVertexNormals();
      const mesh = new Mesh(geometry, whole ? this.lit : this.flat);
      mesh.receiveShadow = whole;
      this.edge = meanLength(cells.lines);
      const lines = new BufferGeometry();
      lines.setAttribute('position', new BufferAttribute(cells.lines, 3));
      this.group.add(mesh, new LineSegments(lines, this.lineMaterial));
      this.pick(geometry, new Int32Array(cells.angle.length).fill(-1));
    }
    if (solids !== null) {
      const geometry = coloured(solids.position, (v) => solids.building[v] < 0 ? kSolidColours.soil : kSolidColours.building);
      this.group.add(new Mesh(geometry, this.flat));
      this.pick(geometry, solids.building);
    }
    for (const object of [...this.group.children, ...this.picked.children]) object.frustumCulled = false;
  }

  /** `building`: per vertex; -1: none. */
  private pick(geometry: BufferGeometry, building: Int32Array): void {
    geometry.setAttribute('feature', featureAttribute(building.map((b) => (b + 1) << kBuildingBit)));
    this.picked.add(new Mesh(geometry, this.picker));
  }

  setLineColour(colour: Color): void { this.lineMaterial.color.copy(colour); }

  private clear(): void {
    for (const object of [...this.group.children]) {
      (object as Mesh).geometry.dispose();
      this.group.remove(object);
    }
    this.picked.clear();
  }
}
