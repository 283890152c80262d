// The run-time library of the page against the program, on the same files: every level index by index.
// usage: node same_levels.mjs PROGRAM FOLDER LIBRARY FILE...   prints {"files": ..., "levels": ..., "vertices": ...}
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

const [program, folder, bundle, ...files] = process.argv.slice(2);
const {LpmDecoder, Levels, readProgressiveGlb, Glb} = await import(pathToFileURL(bundle));

const fail = (what) => {
  console.error(what);
  process.exit(1);
};
const same = (a, b) => a.length === b.length && a.every((x, k) => x === b[k]);

async function load(file) {
  const bytes = new Uint8Array(readFileSync(file));
  if (file.endsWith('.glb')) return readProgressiveGlb(bytes, file);
  const decoder = new LpmDecoder(file);
  for (let at = 0; at < bytes.length; at += 1000) decoder.push(bytes.subarray(at, at + 1000));  // as it arrives
  if (!decoder.complete) fail(`${file}: is not complete`);
  return decoder.mesh();
}

// In the space of the model, which the node turns y up if z is.
const middleOf = ({translation: [x, y, z], rotation}) => rotation ? [x, -z, y] : [x, y, z];

// By definition: follow the parents.
const ancestor = (mesh, v, count) => {
  while (v >= count) v = mesh.parents[v];
  return v;
};

let levelCount = 0, vertices = 0;
for (const file of files) {
  const mesh = await load(file), levels = new Levels(mesh);
  vertices += mesh.vertexCount;
  for (const share of [0, 0.01, 0.1, 0.3, 0.5, 0.77, 1]) {
    const want = Math.floor(mesh.baseVertices + share * (mesh.vertexCount - mesh.baseVertices));
    const out = path.join(folder, 'level.glb');
    const told = JSON.parse(execFileSync(program, ['lod', file, '--vertices', want, '-o', out, '--json', '-']));
    const count = levels.verticesFor(want), triangles = levels.computeLevel(count);
    if (count !== told.vertices) fail(`${file}: ${want} vertices: ${count} here, ${told.vertices} there`);
    const glb = new Glb(new Uint8Array(readFileSync(out)), out), [primitive] = glb.json.meshes[0].primitives;
    if (glb.json.meshes[0].primitives.length === 1 && !same(triangles, glb.accessor(primitive.indices)))
      fail(`${file}: ${count} vertices: other triangles`);
    if (triangles.length !== 3 * told.triangles) fail(`${file}: ${count} vertices: ${triangles.length / 3} triangles`);
    if (Math.abs(levels.errorOf(count) * mesh.scale - told.estimate) > 1e-6 * (told.estimate + 1e-9)) fail(`${file}: other error`);
    const positions = levels.placeLevel(count);
    const places = glb.accessor(primitive.attributes.POSITION), middle = middleOf(glb.json.nodes[0]);
    for (let k = 0; k < 3 * count; ++k) {
      const here = mesh.origin[k % 3] + mesh.scale * positions[k] - middle[k % 3];
      if (Math.abs(here - places[k]) > 1e-6 * mesh.scale) fail(`${file}: vertex ${Math.floor(k / 3)} stands elsewhere`);
    }
    if (mesh.uv && !same(mesh.uv.subarray(0, 2 * count), glb.accessor(primitive.attributes.TEXCOORD_0)))
      fail(`${file}: other texture coordinates`);
    const morph = levels.computeGeomorph(Math.min(count, mesh.baseVertices + 50), count);
    for (let v = 0; v < count; v += 7)
      if (morph[v] !== ancestor(mesh, v, Math.min(count, mesh.baseVertices + 50))) fail(`${file}: another ancestor of ${v}`);
    ++levelCount;
  }
}
console.log(JSON.stringify({files: files.length, levels: levelCount, vertices}));
