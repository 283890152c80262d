// Binary glTF, as far as this program writes it: progressive meshes, and the tiles of `lodestone export --tiles --morph`.
import {MeshoptDecoder} from 'three/addons/libs/meshopt_decoder.module.js';
import {isLayout} from './octahedral_image.js';
import {showsEmission, surfaceOf} from './surface.js';

const arrays = {5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array};
const components = {SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4};

export class Glb {
  // `bytes` is a Uint8Array, of the whole file unless `partial`. Await `ready` before reading accessors of a compressed
  // file.
  constructor(bytes, name, {partial = false} = {}) {
    this.name = name;
    const words = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (bytes.length < 20 || words.getUint32(0, true) !== 0x46546c67) throw new Error(`${name}: is not a binary glTF`);
    if (!partial && words.getUint32(8, true) > bytes.length) throw new Error(`${name}: the file ends early`);
    const length = words.getUint32(12, true);
    this.json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
    this.binary = bytes.subarray(28 + length);
    this.ready = MeshoptDecoder.ready;
  }

  // The end of a view in the binary chunk, in bytes from its start.
  endOf(index) {
    const view = this.json.bufferViews[index], {byteOffset = 0, byteLength} = view.extensions?.EXT_meshopt_compression ?? view;
    return byteOffset + byteLength;
  }

  view(index) {
    const view = this.json.bufferViews[index], packed = view.extensions?.EXT_meshopt_compression;
    const part = packed ?? view, from = part.byteOffset ?? 0;
    if (!(from >= 0 && part.byteLength >= 0 && this.endOf(index) <= this.binary.length))
      throw new Error(`${this.name}: a part of the file lies beyond its end; the file is damaged`);
    const bytes = this.binary.subarray(from, from + part.byteLength);
    if (!packed) return {bytes, stride: view.byteStride};
    // No codec makes more of a byte than a hundred; a count beyond that would only take memory.
    if (!(packed.count * packed.byteStride <= 1024 * bytes.length + 65536))
      throw new Error(`${this.name}: values do not fit into their part of the file; the file is damaged`);
    const out = new Uint8Array(packed.count * packed.byteStride);
    try {
      MeshoptDecoder.decodeGltfBuffer(out, packed.count, packed.byteStride, bytes, packed.mode, packed.filter);
    } catch {
      throw new Error(`${this.name}: compressed values cannot be decoded; the file is damaged`);
    }
    return {bytes: out, stride: view.byteStride};
  }

  // The values of an accessor, one element after the other.
  accessor(index) {
    const {bufferView, byteOffset = 0, componentType, count, type} = this.json.accessors[index];
    const {bytes, stride} = this.view(bufferView), Type = arrays[componentType], n = components[type];
    const size = Type.BYTES_PER_ELEMENT, step = stride ?? n * size;
    if (!(count >= 1 && byteOffset >= 0 && byteOffset + (count - 1) * step + n * size <= bytes.length))
      throw new Error(`${this.name}: values do not fit into their part of the file; the file is damaged`);
    const out = new Type(n * count);
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
    // Without a colour it stands for no material.
    return {name: m.name ?? '', colour: m.pbrMetallicRoughness?.baseColorFactor ?? [0.8, 0.8, 0.78, 1],
            texture: source(m.pbrMetallicRoughness?.baseColorTexture), normalMap: source(m.normalTexture),
            objectNormals: source(m.extras?.objectNormalTexture), octahedral: m.extras?.octahedral,
            surface: surfaceOf(m, source)};
  }

  textureOf(image) { return this.json.textures.find((t) => (t.source ?? t.extensions?.EXT_texture_webp?.source) === image); }

  // The image, or its thumbnail if that is all that has come; `bytes` is null if nothing has.
  image(index) {
    const image = this.json.images[index], wraps = {10497: 'repeat', 33071: 'clamp', 33648: 'mirror'};
    const texture = this.textureOf(index), thumbnail = texture?.extras?.thumbnail;
    const sampler = this.json.samplers?.[texture?.sampler] ?? {};
    const wrap = [wraps[sampler.wrapS] ?? 'repeat', wraps[sampler.wrapT] ?? 'repeat'];
    if (image.uri !== undefined) return {uri: image.uri, wrap};
    const [part] = [image, thumbnail].filter((p) => p && this.endOf(p.bufferView) <= this.binary.length);
    return {type: part?.mimeType, wrap, bytes: part ? this.view(part.bufferView).bytes.slice() : null};
  }

  // Bytes of the binary chunk that the first picture takes: all but the images of which there is a thumbnail.
  get firstPicture() {
    const {accessors = [], images = [], materials = []} = this.json;
    const drawn = new Set(materials.flatMap((_, k) => {
      const {texture, normalMap, objectNormals, surface} = this.material(k);
      return [texture, objectNormals ?? normalMap, showsEmission(surface) ? surface.emissiveMap : null];
    }));
    const parts = images.map((image, k) => this.textureOf(k)?.extras?.thumbnail ?? (drawn.has(k) ? image : {}));
    return [...accessors, ...parts].reduce((end, {bufferView}) => (bufferView === undefined ? end : Math.max(end, this.endOf(bufferView))), 0);
  }
}

// A progressive mesh as it arrives, as LpmDecoder has it: all of the geometry with thumbnails, then image by image.
export class GlbDecoder {
  constructor(name) {
    Object.assign(this, {name, bytes: new Uint8Array(1 << 16), size: 0, glb: null, groups: 0, textures: []});
  }

  get complete() { return this.glb !== null && this.size >= this.word(8); }
  word(at) { return new DataView(this.bytes.buffer).getUint32(at, true); }

  *steps(bytes) {
    while (this.size + bytes.length > this.bytes.length) {
      const wider = new Uint8Array(2 * this.bytes.length);
      wider.set(this.bytes);
      this.bytes = wider;
    }
    this.bytes.set(bytes, this.size);
    this.size += bytes.length;
    if (this.size < 20 || this.size < 28 + this.word(12)) return;
    this.glb ??= new Glb(this.bytes.subarray(0, this.size), this.name, {partial: true});
    this.glb.binary = this.bytes.subarray(28 + this.word(12), this.size);
    const come = this.glb.binary.length;
    if (!this.complete && come < this.glb.firstPicture) return;
    yield;
    this.groups = 1;  // there are no levels to wait for
    this.textures = (this.glb.json.images ?? []).filter(({bufferView}) => this.complete || this.glb.endOf(bufferView) <= come);
  }

  mesh() { return progressiveMesh(this.glb); }
}

export const readProgressiveGlb = (bytes, name) => progressiveMesh(new Glb(bytes, name));

// As levels.js takes it.
async function progressiveMesh(glb) {
  const {name} = glb;
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
          uv: get('TEXCOORD_0'), normals: get('NORMAL'), hasNormals: attributes.NORMAL !== undefined, colours: colours && srgbBytes(colours),
          materialIds: mesh.primitives.length > 1 ? materialIds : null,
          materials: (glb.json.materials ?? []).map((_, k) => glb.material(k)),
          textures: (glb.json.images ?? []).map((_, k) => glb.image(k)), triangles, whole: true, scale,
          origin: node.extras?.origin ?? node.translation ?? [0, 0, 0], up: node.extras?.up ?? 'y'}, name);
}

// Checks the properties that levels.js relies on.
function checked(mesh, name) {
  const {vertexCount, baseVertices, parents, errors, triangles, positions, origin, scale} = mesh;
  const fail = (what) => { throw new Error(`${name}: ${what}; the file is damaged`); };
  if (!(baseVertices >= 1 && baseVertices <= vertexCount)) fail('the base has more vertices than the model');
  if (parents.length !== vertexCount || errors.length !== vertexCount) fail('numbers of vertices differ');
  for (const [values, size] of [[mesh.uv, 2], [mesh.normals, 3], [mesh.colours, 4]])
    if (values && values.length !== size * vertexCount) fail('numbers of vertices differ');
  if (![positions, errors, mesh.uv ?? [], origin, [scale]].every((values) => values.every(Number.isFinite))) fail('a number is not finite');
  if (!mesh.materials.every((m) => isLayout(m.octahedral))) fail('an atlas is inconsistent');
  if (triangles.some((v) => v >= vertexCount)) fail('a triangle has a vertex that is not there');
  for (let v = baseVertices; v < vertexCount; ++v) if (parents[v] >= v) fail('a vertex comes before its parent');
  return mesh;
}

// 16 bits of light to bytes in the sRGB encoding; alpha is linear.
function srgbBytes(linear) {
  const encode = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  return Uint8Array.from(linear, (x, k) => Math.round(255 * (k % 4 === 3 ? x / 65535 : encode(x / 65535))));
}
