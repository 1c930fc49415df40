// The city in 3D: camera, light, and what is drawn. Frames are drawn when something has changed.

import {
  AmbientLight, Box2, BufferAttribute, BufferGeometry, CircleGeometry, Color, DataTexture, DirectionalLight,
  HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, PCFShadowMap,
  PerspectiveCamera, Plane, Scene, ShadowMaterial, Vector2, Vector3, WebGLRenderer,
  WebGLRenderTarget, DoubleSide, FrontSide,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import type {SkyMap} from '../mesh/sky.js';
import type {CutCells, CutSolids} from '../mesh/section.js';
import type {Surface} from '../mesh/surface.js';
import {kAccent, kClassColours, kGroundColours, kHeightRamp, kQualityRamp, kQuietGround, type Rgb, type Theme} from './colours.js';
import {CutView} from './cut_view.js';
import {
  buildingTexture, Colouring, kPickOffset, linear, pickMaterial, PickMode, rampTexture, skyTexture, surfaceGeometry, surfaceMaterial,
  type SurfaceUniforms,
} from './surface_material.js';

const kFieldOfView = 32;
/** Of the sun: azimuth clockwise from north, elevation. */
const kSun = {azimuth: 222, elevation: 42};

/** Where the camera is, seen from what is looked at: metres; degrees clockwise from north, and up. */
interface Place {
  distance: number;
  azimuth: number;
  elevation: number;
}

/** `azimuth`, or as many full turns from it as bring it nearest to `from`. */
const nearestTurn = (from: number, azimuth: number): number => azimuth + 360 * Math.round((from - azimuth) / 360);

/** From a place to one that is seen from there at an azimuth and elevation, degrees. */
function away(distance: number, azimuth: number, elevation: number): Vector3 {
  const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
  return new Vector3(Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e)).multiplyScalar(distance);
}

export class CityView {
  /** Called after each frame. */
  onFrame: () => void = () => {};
  /** Called when the city begins to move. */
  onMove: () => void = () => {};
  readonly camera = new PerspectiveCamera(kFieldOfView, 1, 1, 10000);
  readonly controls: OrbitControls;

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly pickScene = new Scene();
  private readonly pickTarget = new WebGLRenderTarget(1, 1);
  private readonly picker = pickMaterial(FrontSide);
  /** Browsers that resist fingerprinting read noise: nothing can be picked there. */
  private readsPixels: boolean | null = null;
  private readonly sun = new DirectionalLight('#fff0d9', 2.6);
  private readonly skyLight = new HemisphereLight('#dbe8ff', '#b3a48f', 1.7);
  private readonly uniforms: SurfaceUniforms;
  private readonly surface: Mesh;
  private readonly table: Mesh;
  private readonly cutView = new CutView();
  private readonly ramps = {quality: rampTexture(kQualityRamp.texels()), height: rampTexture(kHeightRamp.texels())};
  private readonly clip = new Plane(new Vector3(1, 0, 0), 0);
  private readonly marker: LineSegments;
  private readonly markerFill: Mesh;
  private frame = 0;
  private flight: {target: [Vector3, Vector3]; place: [Place, Place]; start: number; time: number} | null = null;
  private readonly sunDirection = away(1, kSun.azimuth, kSun.elevation);
  private shadowAt = {centre: new Vector3(Infinity, 0, 0), radius: 0};

  /**
   * `size`: of the domain in x, y and of what stands on it in z, metres; the scene's origin is in the
   * middle of its floor. `base`: elevation of the bottom of the soil.
   */
  constructor(private readonly canvas: HTMLCanvasElement, surface: Surface, buildings: number,
              private readonly size: Vector3, base: number) {
    this.renderer = new WebGLRenderer({canvas, antialias: true, alpha: true, powerPreference: 'high-performance'});
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;

    this.uniforms = {
      colouring: {value: Colouring.byClass},
      groundColours: {value: kGroundColours.map(linear)}, roofColour: {value: linear(kClassColours.roof)},
      wallColour: {value: linear(kClassColours.wall)}, soilColour: {value: linear(kClassColours.soil)},
      accent: {value: linear(kAccent)}, buildings: {value: buildingTexture(buildings)},
      heights: {value: new Vector3(0, 0, 1)}, ramp: {value: this.ramps.quality}, selected: {value: -1}, hovered: {value: -1},
      edges: {value: 0}, edgeColour: {value: new Color(0.02, 0.025, 0.035)}, sky: {value: null},
      skyShare: {value: 0}, skyOrigin: {value: new Vector2()}, skySize: {value: new Vector2(1, 1)},
      skyCell: {value: 1},
    };
    const radius = size.length();
    const geometry = surfaceGeometry(surface, radius);
    this.surface = new Mesh(geometry, surfaceMaterial(this.uniforms));
    this.surface.castShadow = this.surface.receiveShadow = true;
    this.surface.frustumCulled = false;
    const picked = new Mesh(geometry, this.picker);
    picked.frustumCulled = false;
    this.pickScene.add(picked, this.cutView.picked);

    // What the block of soil stands on: nothing but its shadow is seen.
    this.table = new Mesh(new CircleGeometry(6 * radius, 64), new ShadowMaterial({opacity: 0.16}));
    this.table.position.z = base;
    this.table.receiveShadow = true;

    const markerColour = linear(kAccent);
    const corners = new BufferAttribute(new Float32Array(12), 3);
    const ofCorners = (index: number[]): BufferGeometry => new BufferGeometry().setAttribute('position', corners).setIndex(index);
    this.marker = new LineSegments(ofCorners([0, 1, 1, 2, 2, 0, 0, 3, 1, 3, 2, 3]), new LineBasicMaterial({color: markerColour, depthTest: false}));
    this.markerFill = new Mesh(ofCorners([0, 1, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3]), new MeshBasicMaterial(
        {color: markerColour, depthTest: false, transparent: true, opacity: 0.45, side: DoubleSide}));
    for (const object of [this.marker, this.markerFill]) {
      object.visible = object.frustumCulled = false;
      object.renderOrder = 10;
    }
    this.scene.add(this.surface, this.table, this.cutView.group, this.sun, this.sun.target, this.skyLight,
                   new AmbientLight('#ffffff', 0.12), this.marker, this.markerFill);
    this.skyLight.position.set(0, 0, 1);
    this.sun.castShadow = true;
    const most = Math.min(4096, this.renderer.capabilities.maxTextureSize);
    this.sun.shadow.mapSize.set(most, most);
    this.sun.shadow.radius = 2.5;

    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    canvas.style.cursor = '';  // which the controls have set: the style sheet has better ones
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.screenSpacePanning = false;
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.controls.minDistance = 2;
    this.controls.maxDistance = 8 * radius;
    this.controls.addEventListener('change', () => this.invalidate());
    this.controls.addEventListener('start', () => {
      this.flight = null;
      this.onMove();
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.updateShadow(true);
      this.invalidate();
    });
    // Drawn at once: a new size clears the canvas. Windows tell of another pixel ratio.
    const redraw = (): void => {
      if (this.resize()) this.draw(performance.now());
    };
    new ResizeObserver(redraw).observe(canvas.parentElement!);
    window.addEventListener('resize', redraw);
    this.resize();
    this.home(false);
  }

  /** The whole city from the south-south-west, as large as it fits between the controls. */
  home(animated = true): void {
    const azimuth = 205, elevation = 36;
    const probe = this.camera.clone();
    const target = new Vector3(0, 0, this.size.z / 3);
    let distance = this.size.length() * 2;
    for (let i = 0; i < 12; ++i) {
      probe.position.copy(target).add(away(distance, azimuth, elevation));
      probe.lookAt(target);
      probe.updateMatrixWorld();
      const box = new Box2();
      for (let corner = 0; corner < 8; ++corner) {
        const p = new Vector3((corner & 1 ? 0.5 : -0.5) * this.size.x, (corner & 2 ? 0.5 : -0.5) * this.size.y,
                              corner & 4 ? this.size.z : 0).project(probe);
        box.expandByPoint(new Vector2(p.x, p.y));
      }
      const centre = box.getCenter(new Vector2()), extent = box.getSize(new Vector2());
      // Half of what is seen at the target, in metres.
      const half = distance * Math.tan(kFieldOfView * Math.PI / 360);
      target.addScaledVector(new Vector3().setFromMatrixColumn(probe.matrixWorld, 0), centre.x * half * probe.aspect);
      const forward = new Vector3(-probe.position.x + target.x, -probe.position.y + target.y, 0).normalize();
      target.addScaledVector(forward, (centre.y + 0.02) * half / Math.sin(elevation * Math.PI / 180));
      distance *= Math.max(extent.x / 1.86, extent.y / 1.62);
    }
    this.flyTo(target, distance, azimuth, elevation, animated);
  }

  /** Looks at a place from a distance: from an azimuth (degrees clockwise from north) and elevation. */
  flyTo(target: Vector3, distance: number, azimuth: number | null, elevation: number, animated = true): void {
    const from = azimuth ?? this.place().azimuth;
    if (!animated || window.matchMedia('(prefers-reduced-motion: reduce)').matches) {
      this.controls.target.copy(target);
      this.camera.position.copy(target).add(away(distance, from, elevation));
      this.controls.update();
    } else {
      this.flight = {target: [this.controls.target.clone(), target], place: [this.place(), {distance, azimuth: nearestTurn(this.place().azimuth, from), elevation}],
                     start: performance.now(), time: 900};
    }
    this.onMove();
    this.invalidate();
  }

  lookNorth(): void {
    const {distance, elevation} = this.place();
    this.flyTo(this.controls.target.clone(), distance, 180, elevation);
  }

  /** From what is looked at to the camera. */
  offset(): Vector3 { return this.camera.position.clone().sub(this.controls.target); }
  distance(): number { return this.offset().length(); }

  /** Of the camera, seen from what is looked at. */
  private place(): Place {
    const {x, y, z} = this.offset(), distance = this.distance();
    return {distance, azimuth: Math.atan2(x, y) * 180 / Math.PI, elevation: Math.asin(z / distance) * 180 / Math.PI};
  }

  setTheme(theme: Theme): void {
    const dark = theme === 'dark';
    this.sun.intensity = dark ? 2.0 : 2.6;
    this.skyLight.intensity = dark ? 1.15 : 1.7;
    this.skyLight.color.set(dark ? '#b9ccf2' : '#dbe8ff');
    (this.table.material as ShadowMaterial).opacity = dark ? 0.45 : 0.16;
    this.cutView.setLineColour(new Color(dark ? '#0b1020' : '#1a2233'));
    this.invalidate();
  }

  /** By the height of each place above its building's ground; `grounds` in the scene. */
  colourByHeight(grounds: readonly number[], highest: number): void {
    const low = grounds.reduce((a, b) => Math.min(a, b), Infinity), range = grounds.reduce((a, b) => Math.max(a, b - low), 1e-6);
    this.uniforms.heights.value.set(low, range, highest);
    const texture = this.uniforms.buildings.value as DataTexture;
    const texels = texture.image.data as Uint8Array;
    grounds.forEach((ground, b) => texels[4 * b + 3] = Math.round(255 * (ground - low) / range));
    texture.needsUpdate = true;
    this.setColouring(Colouring.byHeight);
  }

  /** `colours`: per building, where they are shown. */
  setColouring(colouring: Colouring, colours?: readonly Rgb[]): void {
    this.uniforms.colouring.value = colouring;
    this.uniforms.ramp.value = colouring === Colouring.byHeight ? this.ramps.height : this.ramps.quality;
    this.uniforms.groundColours.value = kGroundColours.map((c) => linear(colouring === Colouring.byClass ? c : kQuietGround));
    if (colours !== undefined) {
      const texture = this.uniforms.buildings.value as DataTexture;
      const texels = texture.image.data as Uint8Array;
      colours.forEach((c, b) => texels.set([...c.map(Math.round), 255], 4 * b));
      texture.needsUpdate = true;
    }
    this.invalidate();
  }

  /** Per triangle of the surface, in [0, 1] of the ramp. */
  setAngles(shares: (triangle: number) => number, triangles: number): void {
    const attribute = this.surface.geometry.getAttribute('angle') as BufferAttribute;
    for (let f = 0; f < triangles; ++f)
      (attribute.array as Uint8Array).fill(Math.round(255 * Math.min(1, Math.max(0, shares(f)))), 3 * f, 3 * f + 3);
    attribute.needsUpdate = true;
    this.invalidate();
  }

  setEdges(on: boolean): void {
    this.uniforms.edges.value = on ? 0.55 : 0;
    this.invalidate();
  }

  setSky(sky: SkyMap): void {
    const {grid} = sky;
    this.uniforms.sky.value = skyTexture(sky);
    this.uniforms.skyOrigin.value.set(grid.x - grid.cell / 2, grid.y - grid.cell / 2);
    this.uniforms.skySize.value.set(grid.width * grid.cell, grid.height * grid.cell);
    this.uniforms.skyCell.value = grid.cell;
    this.uniforms.skyShare.value = 1;
    this.invalidate();
  }

  setSelected(building: number): void {
    this.uniforms.selected.value = building;
    this.invalidate();
  }

  setHovered(building: number): void {
    if (this.uniforms.hovered.value === building) return;
    this.uniforms.hovered.value = building;
    this.invalidate();
  }

  /** What lies on the side that `normal` points away from stays; null: all stays. */
  setClip(normal: Vector3 | null, at: number): void {
    const planes = normal === null ? null : [this.clip];
    if (normal !== null) this.clip.set(normal.clone().negate(), at * (normal.x + normal.y + normal.z));
    this.renderer.localClippingEnabled = normal !== null;
    const materials = [this.surface.material, this.picker];
    for (const material of materials as {clippingPlanes: Plane[] | null; needsUpdate: boolean}[]) {
      if ((material.clippingPlanes === null) !== (planes === null)) material.needsUpdate = true;
      material.clippingPlanes = planes;
    }
    this.updateShadow(true);
    this.invalidate();
  }

  setCut(cells: CutCells | null, solids: CutSolids | null, whole: boolean): void {
    this.cutView.set(cells, solids, whole);
    this.invalidate();
  }

  /** A tet, twelve numbers; null: none. */
  setMarker(corners: readonly number[] | null): void {
    this.marker.visible = this.markerFill.visible = corners !== null;
    if (corners !== null) {
      const points = this.marker.geometry.getAttribute('position') as BufferAttribute;
      points.copyArray(corners);
      points.needsUpdate = true;
    }
    this.invalidate();
  }

  /** What setMarker has been given. */
  marked(): number[] {
    return this.marker.visible ? [...this.marker.geometry.getAttribute('position').array] : [];
  }

  /** What is at a place of the window, as ColumnMesh's regionBuilding tells it; -1: nothing. */
  pickRegion(clientX: number, clientY: number): number {
    const value = this.pick(clientX, clientY, PickMode.building);
    return value < 0 ? -1 : value - kPickOffset;
  }

  /** What is at a place of the window; null: nothing. */
  pickPlace(clientX: number, clientY: number): Vector3 | null {
    const depth = this.pick(clientX, clientY, PickMode.depth);
    if (depth < 0) return null;
    const box = this.canvas.getBoundingClientRect();
    return new Vector3(2 * (clientX - box.left) / box.width - 1, 1 - 2 * (clientY - box.top) / box.height,
                       2 * depth / 16777215 - 1).unproject(this.camera);
  }

  /** Whether a colour that is drawn is the one that is read. */
  private testPixels(): boolean {
    const {renderer} = this, bytes = new Uint8Array(4);
    renderer.setRenderTarget(this.pickTarget);
    renderer.setClearColor(new Color(18 / 255, 52 / 255, 86 / 255), 1);
    renderer.clear();
    renderer.readRenderTargetPixels(this.pickTarget, 0, 0, 1, 1, bytes);
    renderer.setRenderTarget(null);
    renderer.setClearColor(0, 0);
    return bytes.join() === '18,52,86,255';
  }

  /** -1: nothing is there, or nobody can tell. */
  private pick(clientX: number, clientY: number, mode: PickMode): number {
    this.readsPixels ??= this.testPixels();
    if (!this.readsPixels) return -1;
    const box = this.canvas.getBoundingClientRect();
    for (const material of [this.picker, this.cutView.picker]) material.uniforms['mode']!.value = mode;
    this.camera.setViewOffset(box.width, box.height, Math.floor(clientX - box.left), Math.floor(clientY - box.top), 1, 1);
    this.renderer.setRenderTarget(this.pickTarget);
    this.renderer.render(this.pickScene, this.camera);
    const bytes = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.pickTarget, 0, 0, 1, 1, bytes);
    this.renderer.setRenderTarget(null);
    this.camera.clearViewOffset();
    return bytes[3] === 0 ? -1 : bytes[0] | bytes[1] << 8 | bytes[2] << 16;
  }

  /** Metres that a CSS pixel spans at the target. */
  metresPerPixel(): number {
    return 2 * this.distance() * Math.tan(kFieldOfView * Math.PI / 360) / Math.max(1, this.canvas.clientHeight);
  }

  /** Clockwise from north, radians: where the camera looks. */
  heading(): number {
    const offset = this.offset();
    return Math.atan2(-offset.x, -offset.y);
  }

  zoom(factor: number): void {
    const offset = this.offset();
    this.camera.position.copy(this.controls.target).addScaledVector(offset, factor);
    this.controls.update();
    this.onMove();
    this.invalidate();
  }

  /** Degrees. */
  turn(azimuth: number, elevation: number): void {
    const from = this.place();
    this.camera.position.copy(this.controls.target)
        .add(away(from.distance, from.azimuth + azimuth, Math.min(88, Math.max(2, from.elevation + elevation))));
    this.controls.update();
    this.onMove();
    this.invalidate();
  }

  invalidate(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame((now) => this.draw(now));
  }

  /** Returns whether there is anything to draw on. */
  private resize(): boolean {
    const box = this.canvas.parentElement!.getBoundingClientRect();
    if (box.width === 0 || box.height === 0) return false;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(box.width, box.height, false);
    this.camera.aspect = box.width / box.height;
    this.camera.updateProjectionMatrix();
    return true;
  }

  private draw(now: number): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    if (this.flight !== null) {
      const {target, place: [from, to], start, time} = this.flight;
      const t = Math.min(1, Math.max(0, now - start) / time), s = t * t * (3 - 2 * t);
      const between = (a: number, b: number): number => a + s * (b - a);
      this.controls.target.lerpVectors(...target, s);
      this.camera.position.copy(this.controls.target)
          .add(away(between(from.distance, to.distance), between(from.azimuth, to.azimuth), between(from.elevation, to.elevation)));
      if (t === 1) this.flight = null;
      this.invalidate();
    }
    this.controls.update();
    const distance = this.camera.position.length();
    this.camera.near = Math.max(0.2, this.distance() / 200);
    this.camera.far = distance + 7 * this.size.length();
    this.camera.updateProjectionMatrix();
    this.updateShadow(false);
    this.cutView.setDetail(this.metresPerPixel());
    this.renderer.render(this.scene, this.camera);
    this.onFrame();
  }

  /** The shadow map covers what is looked at: near places have finer shadows. */
  private updateShadow(force: boolean): void {
    const whole = this.size.length() / 2 * 1.02;
    const seen = this.distance() * 1.1;
    // Rounded, so that small movements leave it as it is.
    const radius = Math.min(whole, 2 ** Math.ceil(Math.log2(seen)));
    const centre = radius >= whole * 0.99 ? new Vector3() : this.controls.target.clone();
    if (radius < whole * 0.99) centre.set(Math.round(centre.x / radius * 4) * radius / 4,
                                          Math.round(centre.y / radius * 4) * radius / 4, 0);
    if (!force && this.shadowAt.radius === radius && this.shadowAt.centre.equals(centre)) return;
    this.shadowAt = {centre, radius};
    const {shadow} = this.sun;
    const away = this.size.length() + radius;
    this.sun.target.position.copy(centre);
    this.sun.position.copy(centre).addScaledVector(this.sunDirection, away);
    const box = shadow.camera;
    box.left = box.bottom = -radius;
    box.right = box.top = radius;
    box.near = 1;
    box.far = 2 * away;
    box.updateProjectionMatrix();
    const texel = 2 * radius / shadow.mapSize.x;
    shadow.normalBias = texel * 1.2;
    shadow.bias = -texel / box.far;
    this.renderer.shadowMap.needsUpdate = true;
  }
}
