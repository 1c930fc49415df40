// read_glb.mjs NODE_MODULES FILE.glb: what the Khronos validator, and three.js with the 3D Tiles renderer's extensions
// make of a file. Prints one JSON object.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const modules = resolve(process.argv[2]);
const load = (file) => import(pathToFileURL(join(modules, file)));
globalThis.self = globalThis; // of a browser
const validator = createRequire(join(modules, 'here.js'))('gltf-validator');
const { GLTFLoader } = await load('three/examples/jsm/loaders/GLTFLoader.js');
const { GLTFMeshFeaturesExtension, GLTFStructuralMetadataExtension } =
  await load('3d-tiles-renderer/build/index.plugins.js');

const bytes = new Uint8Array(readFileSync(process.argv[3]));
const { issues } = await validator.validateBytes(bytes);
const loader = new GLTFLoader();
loader.register(() => new GLTFMeshFeaturesExtension());
loader.register(() => new GLTFStructuralMetadataExtension());
const { scene } = await loader.parseAsync(bytes.buffer, '');

const parts = scene.children.map(({ name, geometry, userData }) => {
  const position = geometry.getAttribute('position'), id = geometry.getAttribute('_feature_id_0');
  const features = userData.meshFeatures?.getFeatureInfo()[0];
  const rows = new Map();
  for (let i = 0; id && i < id.count; ++i) {
    const feature = id.getX(i), y = position.getY(i);
    if (!rows.has(feature)) {
      const [row] = userData.structuralMetadata.getPropertyTableData([features.propertyTable], [feature]);
      rows.set(feature, { ...row, low: y, high: y });
    }
    const row = rows.get(feature);
    row.low = Math.min(row.low, y);
    row.high = Math.max(row.high, y);
  }
  return { name, patch: userData.patch, faces: geometry.index.count / 3, features, rows: Object.fromEntries(rows) };
});
console.log(JSON.stringify({ issues, parts }));
