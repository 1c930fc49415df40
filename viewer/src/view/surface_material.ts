// How the surface is drawn: colours by what is asked, light of sun and sky, edges of triangles.

import {
  DataTexture, IntType, Int32BufferAttribute, InterleavedBuffer, InterleavedBufferAttribute, BufferAttribute,
  BufferGeometry, LinearFilter, MeshLambertMaterial, NearestFilter, RGFormat, Sphere, SRGBColorSpace,
  UnsignedByteType, Vector2, Vector3, Color, ShaderMaterial, type Side, type Texture,
} from 'three';
import {kBuildingBit, kOutlineBit, type Surface} from '../mesh/surface.js';
import type {SkyMap} from '../mesh/sky.js';
import type {Rgb} from './colours.js';

/** What colours show. */
export const enum Colouring { byClass, byBuilding, byAngle, byHeight }

const kRowTexels = 1024;

/** Per vertex: as Surface has it. */
export function featureAttribute(feature: Int32Array): BufferAttribute {
  const attribute = new Int32BufferAttribute(feature, 1);
  attribute.gpuType = IntType;
  return attribute;
}

export function surfaceGeometry(surface: Surface, radius: number): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(surface.position, 3));
  const bytes = new InterleavedBuffer(surface.normal, 4);
  geometry.setAttribute('normal', new InterleavedBufferAttribute(bytes, 3, 0, true));
  geometry.setAttribute('lift', new InterleavedBufferAttribute(bytes, 1, 3, true));
  geometry.setAttribute('feature', featureAttribute(surface.feature));
  geometry.setAttribute('angle', new BufferAttribute(new Uint8Array(surface.feature.length).fill(255), 1, true));
  geometry.boundingSphere = new Sphere(new Vector3(), radius);
  return geometry;
}

/** A texel per building. */
export function buildingTexture(buildings: number): DataTexture {
  const rows = Math.max(1, Math.ceil(buildings / kRowTexels));
  const texture = new DataTexture(new Uint8Array(4 * kRowTexels * rows).fill(255), kRowTexels, rows);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

export function rampTexture(texels: Uint8Array<ArrayBuffer>): DataTexture {
  const texture = new DataTexture(texels, texels.length / 4, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export function skyTexture(sky: SkyMap): DataTexture {
  const texture = new DataTexture(sky.share as Uint8Array<ArrayBuffer>, sky.grid.width, sky.grid.height, RGFormat, UnsignedByteType);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

export const linear = (c: Rgb): Color => new Color().setRGB(c[0] / 255, c[1] / 255, c[2] / 255, SRGBColorSpace);

/** Shared by everything that draws the surface; change `value`s. */
export interface SurfaceUniforms {
  colouring: {value: number};
  /** As kGroundColours. */
  groundColours: {value: Color[]};
  roofColour: {value: Color};
  wallColour: {value: Color};
  soilColour: {value: Color};
  accent: {value: Color};
  /** A texel per building: its colour, or in alpha its ground between the lowest and the highest one. */
  buildings: {value: Texture};
  /** The lowest ground, how far they differ, and the highest building, metres. */
  heights: {value: Vector3};
  ramp: {value: Texture};
  selected: {value: number};
  hovered: {value: number};
  edges: {value: number};
  edgeColour: {value: Color};
  sky: {value: Texture | null};
  /** 0 until the sky is known, then 1. */
  skyShare: {value: number};
  skyOrigin: {value: Vector2};
  skySize: {value: Vector2};
  skyCell: {value: number};
}

const kVertexDeclarations = /* glsl */ `
in int feature;
in float lift;
in float angle;
flat out int vFeature;
out vec3 vPlace, vUpright, vCorner;
out float vLift, vAngle;
`;

const kVertexCode = /* glsl */ `
vFeature = feature;
vPlace = position;
vUpright = normal;
vLift = lift;
vAngle = angle;
int corner = gl_VertexID % 3;
vCorner = vec3(corner == 0, corner == 1, corner == 2);
`;

const kFragmentDeclarations = /* glsl */ `
flat in int vFeature;
in vec3 vPlace, vUpright, vCorner;
in float vLift, vAngle;
uniform int colouring, selected, hovered;
uniform vec3 groundColours[4], roofColour, wallColour, soilColour, accent, edgeColour;
uniform vec3 heights;
uniform sampler2D buildings, ramp, sky;
uniform float edges, skyShare, skyCell;
uniform vec2 skyOrigin, skySize;

vec3 surfaceColour() {
  int kind = vFeature & 3, building = (vFeature >> ${kBuildingBit}) - 1;
  vec3 colour = kind == 0 ? groundColours[clamp(-1 - building, 0, 3)] : kind == 1 ? roofColour : kind == 2 ? wallColour : soilColour;
  vec4 texel = texelFetch(buildings, ivec2(max(building, 0) % ${kRowTexels}, max(building, 0) / ${kRowTexels}), 0);
  if (colouring == ${Colouring.byBuilding} && building >= 0) colour = texel.rgb;
  if (colouring == ${Colouring.byHeight} && building >= 0)
    colour = texture(ramp, vec2((vPlace.z - heights.x - heights.y * texel.a) / heights.z, 0.5)).rgb;
  if (colouring == ${Colouring.byAngle} && kind != 3) colour = texture(ramp, vec2(vAngle, 0.5)).rgb;
  if (building >= 0 && building == selected) colour = mix(colour, accent, 0.75);
  else if (building >= 0 && building == hovered) colour = mix(colour, accent, 0.3);
  // Thin lines, that fade where triangles are smaller than pixels.
  vec3 width = fwidth(vCorner);
  vec3 near = smoothstep(vec3(0.0), width * 1.15, vCorner);
  float line = 1.0 - min(near.x, min(near.y, near.z));
  float fine = max(width.x, max(width.y, width.z));
  colour = mix(colour, edgeColour, edges * line * (1.0 - smoothstep(0.15, 0.6, fine)));
  bvec3 isOutline = bvec3((ivec3(vFeature) >> ivec3(${kOutlineBit}, ${kOutlineBit + 1}, ${kOutlineBit + 2})) & 1);
  vec3 far = mix(vec3(1.0), smoothstep(vec3(0.0), width * 1.4, vCorner), isOutline);
  return mix(colour, edgeColour, 0.5 * (1.0 - min(far.x, min(far.y, far.z))) * (1.0 - smoothstep(0.3, 0.9, fine)));
}

/** Share of the light of the whole sky that arrives. */
float skyLight() {
  int kind = vFeature & 3;
  if (kind == 3) return 1.0;
  vec2 share = texture(sky, (vPlace.xy + vUpright.xy * skyCell * 1.5 - skyOrigin) / skySize).rg;
  float light = kind == 1 ? share.g : share.r;
  if (kind == 2) light = mix(min(1.0, 1.5 * share.r), 1.0, smoothstep(0.0, 0.45, vLift));
  return mix(1.0, pow(light, 1.3), skyShare);
}
`;

/** Lit by the scene's lights; the sky's light is less where little of it is seen. */
export function surfaceMaterial(uniforms: SurfaceUniforms): MeshLambertMaterial {
  const material = new MeshLambertMaterial({clipShadows: true});
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = kVertexDeclarations +
        shader.vertexShader.replace('#include <begin_vertex>', `#include <begin_vertex>\n${kVertexCode}`);
    shader.fragmentShader = kFragmentDeclarations +
        shader.fragmentShader
            .replace('#include <color_fragment>', 'diffuseColor.rgb = surfaceColour();')
            .replace('#include <aomap_fragment>', 'reflectedLight.indirectDiffuse *= skyLight();');
  };
  return material;
}

/** What a pick draws instead of colours: three bytes, lowest first. */
export const enum PickMode { building, depth }

/** What regionBuilding has plus kPickOffset, or depth in 2^24 parts. */
export const kPickOffset = 16;

export function pickMaterial(side: Side): ShaderMaterial {
  return new ShaderMaterial({
    clipping: true, side,
    uniforms: {mode: {value: PickMode.building}},
    vertexShader: /* glsl */ `
      #include <clipping_planes_pars_vertex>
      in int feature;
      flat out int vFeature;
      void main() {
        vFeature = feature;
        #include <begin_vertex>
        #include <project_vertex>
        #include <clipping_planes_vertex>
      }`,
    fragmentShader: /* glsl */ `
      #include <clipping_planes_pars_fragment>
      uniform int mode;
      flat in int vFeature;
      void main() {
        vec4 diffuseColor = vec4(1.0);
        #include <clipping_planes_fragment>
        int value = mode == ${PickMode.building} ? (vFeature >> ${kBuildingBit}) + ${kPickOffset - 1} : int(gl_FragCoord.z * 16777215.0);
        gl_FragColor = vec4(value & 255, value >> 8 & 255, value >> 16, 255) / 255.0;
      }`,
  });
}
