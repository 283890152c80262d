// Binary glTF, as far as this program writes it: progressive meshes, and the tiles of `lodestone export --tiles --morph`.
import {MeshoptDecoder} from 'three/examples/jsm/libs/meshopt_decoder.module.js';

const arrays = {5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array};
const components = {SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4};

export class Glb {
  // `bytes` is a Uint8Array. Await `ready` before reading accessors of a compressed file.
  constructor(bytes, name) {
    this.name = name;
    const words = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (bytes.length < 20 || words.getUint32(0, true) !== 0x46546c67) throw new Error(`${name}: is not a binary glTF`);
    if (words.getUint32(8, true) > bytes.length) throw new Error(`${name}: the file ends early`);
    const length = words.getUint32(12, true);
    this.json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
    this.binary = bytes.subarray(28 + length);
    this.ready = MeshoptDecoder.ready;
  }

  view(index) {
    const view = this.json.bufferViews[index], packed = view.extensions?.EXT_meshopt_compression;
    const part = packed ?? view, from = part.byteOffset ?? 0;
    const bytes = this.binary.subarray(from, from + part.byteLength);
    if (!packed) return {bytes, stride: view.byteStride};
    const out = new Uint8Array(packed.count * packed.byteStride);
    MeshoptDecoder.decodeGltfBuffer(out, packed.count, packed.byteStride, bytes, packed.mode, packed.filter);
    return {bytes: out, stride: view.byteStride};
  }

  // The values of an accessor, one element after the other.
  accessor(index) {
    const {bufferView, byteOffset = 0, componentType, count, type} = this.json.accessors[index];
    const {bytes, stride} = this.view(bufferView), Type = arrays[componentType], n = components[type];
    const size = Type.BYTES_PER_ELEMENT, step = stride ?? n * size, out = new Type(n * count);
    const to = new Uint8Array(out.buffer);
    if (step === n * size) {
      to.set(bytes.subarray(byteOffset, byteOffset + to.length));
      return out;
    }
    for (let k = 0; k < count; ++k)
      to.set(bytes.subarray(byteOffset + k * step, byteOffset + k * step + n * size), k * n * size);
    return out;
  }

  material(index) {
    const m = this.json.materials?.[index];
    if (!m) return null;
    const source = (t) => {
      const texture = t && this.json.textures[t.index];
      return texture === undefined ? null : texture.source ?? texture.extensions?.EXT_texture_webp?.source ?? null;
    };
    return {name: m.name ?? '', colour: m.pbrMetallicRoughness?.baseColorFactor ?? [1, 1, 1, 1],
            texture: source(m.pbrMetallicRoughness?.baseColorTexture), normalMap: source(m.normalTexture),
            objectNormals: source(m.extras?.objectNormalTexture)};
  }

  image(index) {
    const image = this.json.images[index], wraps = {10497: 'repeat', 33071: 'clamp', 33648: 'mirror'};
    const texture = this.json.textures.find((t) => (t.source ?? t.extensions?.EXT_texture_webp?.source) === index);
    const sampler = this.json.samplers?.[texture?.sampler] ?? {};
    const wrap = [wraps[sampler.wrapS] ?? 'repeat', wraps[sampler.wrapT] ?? 'repeat'];
    if (image.uri !== undefined) return {uri: image.uri, wrap};
    return {type: image.mimeType, wrap, bytes: this.view(image.bufferView).bytes.slice()};
  }
}

// A progressive mesh as levels.js takes it.
export async function readProgressiveGlb(bytes, name) {
  const glb = new Glb(bytes, name);
  await glb.ready;
  const node = glb.json.nodes?.[0] ?? {}, mesh = glb.json.meshes?.[node.mesh], attributes = mesh?.primitives[0].attributes;
  if (attributes?._PARENTINDEX === undefined)
    throw new Error(`${name}: the model is not progressive; make it so with \`lodestone progressive\``);
  const get = (key) => (attributes[key] === undefined ? null : glb.accessor(attributes[key]));
  const positions = get('POSITION'), vertexCount = positions.length / 3, scale = node.scale?.[0] ?? 1;
  const colours = get('COLOR_0');
  const materialIds = new Int32Array(vertexCount).fill(-1), lists = [];
  for (const primitive of mesh.primitives) {
    const ids = glb.accessor(primitive.indices);
    lists.push(ids);
    for (const id of ids) materialIds[id] = primitive.material ?? -1;
  }
  const triangles = new Uint32Array(lists.reduce((sum, ids) => sum + ids.length, 0));
  lists.reduce((at, ids) => (triangles.set(ids, at), at + ids.length), 0);
  return checked({vertexCount, baseVertices: mesh.extras.progressive.baseVertices, positions,
          parents: Uint32Array.from(get('_PARENTINDEX')), errors: get('_ERROR').map((e) => e / scale),
          uv: get('TEXCOORD_0'), normals: get('NORMAL'), colours: colours && srgbBytes(colours),
          materialIds: mesh.primitives.length > 1 ? materialIds : null,
          materials: (glb.json.materials ?? []).map((_, k) => glb.material(k)),
          textures: (glb.json.images ?? []).map((_, k) => glb.image(k)), triangles,
          origin: node.translation ?? [0, 0, 0], scale}, name);
}

// Checks the properties that levels.js relies on.
function checked(mesh, name) {
  const {vertexCount, baseVertices, parents, errors, triangles} = mesh;
  const fail = (what) => { throw new Error(`${name}: ${what}; the file is damaged`); };
  if (!(baseVertices >= 1 && baseVertices <= vertexCount)) fail('the base has more vertices than the model');
  if (parents.length !== vertexCount || errors.length !== vertexCount) fail('numbers of vertices differ');
  if (triangles.some((v) => v >= vertexCount)) fail('a triangle has a vertex that is not there');
  for (let v = baseVertices; v < vertexCount; ++v) if (parents[v] >= v) fail('a vertex comes before its parent');
  return mesh;
}

// 16 bits of light to bytes in the sRGB encoding; alpha is linear.
function srgbBytes(linear) {
  const encode = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  return Uint8Array.from(linear, (x, k) => Math.round(255 * (k % 4 === 3 ? x / 65535 : encode(x / 65535))));
}
