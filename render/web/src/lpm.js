// .lpm files as they arrive (core/progressive/lpm/lpm.h): feed bytes, take a mesh whenever there is more of it.
import {isLayout} from './octahedral_image.js';
import {RangeDecoder} from './range_decoder.js';
import {SplitCodec} from './split_codec.js';
import {SplitMesh} from './split_mesh.js';
import {surfaceOf} from './surface.js';

const MAGIC = 'LODELPM1';

const crcTable = Uint32Array.from({length: 256}, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const b of bytes) crc = crcTable[(crc ^ b) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}

const wraps = ['repeat', 'clamp', 'mirror'];
const isTexture = ({type, wrap, thumbnail}) => typeof type === 'string' && Array.isArray(wrap) && wrap.length === 2 &&
  wrap.every((w) => wraps.includes(w)) && (thumbnail === undefined || typeof thumbnail === 'string');

// Checks what is read without a further look.
function checkHeader(header, name) {
  const {version, vertices, groups, baseGroups, positionBits, uvBits, textures, materials} = header;
  if (Number.isInteger(version) && version !== 3) throw new Error(`${name}: version ${version} is not known`);
  const holds = [version, vertices, groups, baseGroups, positionBits, uvBits].every(Number.isInteger) && baseGroups >= 0 &&
    baseGroups <= groups && groups <= vertices && vertices < 2 ** 31 && [positionBits, uvBits].every((b) => b >= 4 && b <= 20) &&
    header.scale > 0 && header.origin.every(Number.isFinite) && textures.every(isTexture) &&
    materials.every((m) => isLayout(m.octahedral) && [m.texture, m.normalMap, m.objectNormals].every((t) => t == null || textures[t] !== undefined));
  if (!holds) throw new Error(`${name}: the header contradicts itself; the file is damaged`);
}

const withSurface = ({surface, ...m}) => ({...m, surface: surface ? surfaceOf(surface, (info) => info?.index ?? null) : null});

export class LpmDecoder {
  constructor(name = 'the file') {
    this.name = name;
    this.bytes = new Uint8Array(0);
    this.at = 0;
    this.header = null;
    this.thumbnails = [];
    this.textures = [];
    this.made = null;
    this.splits = new SplitMesh();
    this.values = {positions: [], errors: [], uv: [], colours: [], materials: []};
  }

  get complete() {
    return this.header !== null && this.splits.stars.length === this.header.groups &&
           this.textures.length === this.header.textures.length;
  }
  get groups() { return this.splits.stars.length; }

  // Returns true if the mesh has grown. Throws for damaged or foreign files.
  push(bytes) {
    const before = this.groups + this.textures.length;
    for (const _ of this.steps(bytes));
    return this.groups + this.textures.length > before;
  }

  // The same in steps of at most some milliseconds, so that the caller can do other work between them; a mesh can be
  // taken after the last one.
  *steps(bytes) {
    const joined = new Uint8Array(this.bytes.length - this.at + bytes.length);
    joined.set(this.bytes.subarray(this.at));
    joined.set(bytes, this.bytes.length - this.at);
    this.bytes = joined;
    this.at = 0;
    if (this.header === null && !this.readHeader()) return;
    for (let frame = this.nextFrame(); frame !== null; frame = this.nextFrame()) yield* this.readFrame(frame);
  }

  word(at) {
    return new DataView(this.bytes.buffer, this.bytes.byteOffset).getUint32(at, true);
  }

  take(length, crc) {
    const part = this.bytes.subarray(this.at, this.at + length);
    if (crc32(part) !== crc) throw new Error(`${this.name}: the checksum is wrong; the file is damaged`);
    this.at += length;
    return part;
  }

  readHeader() {
    const seen = Math.min(8, this.bytes.length);
    if (String.fromCharCode(...this.bytes.subarray(0, seen)) !== MAGIC.slice(0, seen))
      throw new Error(`${this.name}: is not a progressive mesh (.lpm)`);
    if (this.bytes.length < 16 || this.bytes.length < 16 + this.word(8)) return false;
    const length = this.word(8), crc = this.word(12);
    this.at = 16;
    this.header = JSON.parse(new TextDecoder().decode(this.take(length, crc)));
    checkHeader(this.header, this.name);
    this.codec = new SplitCodec(this.header, this.splits, this.values);
    this.skipThumbnails();
    return true;
  }

  // Textures without a thumbnail have no frame for it.
  skipThumbnails() {
    const {textures} = this.header;
    while (this.thumbnails.length < textures.length && !textures[this.thumbnails.length].thumbnail) this.thumbnails.push(null);
  }

  // The images, or the thumbnails of those that have not come.
  textureList() {
    return this.header.textures.map(({thumbnail, ...t}, k) => {
      const image = this.textures[k], small = this.thumbnails[k];
      return small && !(image?.length > 0) ? {...t, type: thumbnail, bytes: small} : {...t, bytes: image ?? null};
    });
  }

  nextFrame() {
    const left = this.bytes.length - this.at;
    if (this.complete || left < 12 || left - 12 < this.word(this.at)) return null;
    const length = this.word(this.at), crc = this.word(this.at + 4), vertices = this.word(this.at + 8);
    this.at += 12;
    return {bytes: this.take(length, crc), vertices};
  }

  *readFrame({bytes, vertices}) {
    const {header, splits, codec} = this, now = this.groups;
    if (this.thumbnails.length < header.textures.length) {
      this.thumbnails.push(bytes.slice());
      this.skipThumbnails();
      return;
    }
    if (now === header.groups) {
      this.textures.push(bytes.slice());
      return;
    }
    const coder = new RangeDecoder(bytes);
    if (now === 0) {
      codec.decodeBase(coder, header.baseGroups);
      this.baseVertices = splits.wedgeCount;
    } else {
      const count = Math.min(Math.min(Math.max(now >> 1, 256), 16384), header.groups - now);
      for (let k = 0; k < count; ++k) {
        codec.decode(coder);
        if (k % 256 === 255) yield;
      }
    }
    if (splits.wedgeCount !== vertices) throw new Error(`${this.name}: the splits do not add up; the file is damaged`);
  }

  // The mesh so far, as levels.js takes it.
  mesh() {
    const {header, splits, values} = this, count = splits.wedgeCount;
    if (this.made?.vertexCount === count) return {...this.made, textures: this.textureList()};
    const positions = new Float32Array(3 * count), errors = new Float32Array(count), parents = new Uint32Array(count);
    const step = 2 ** -header.positionBits, bits = new Uint32Array(1), asFloat = new Float32Array(bits.buffer);
    let v = 0;
    splits.stars.forEach((star, g) => {
      bits[0] = values.errors[g] << 16;
      for (let w = 0; w < star.wedgeCount; ++w, ++v) {
        for (let i = 0; i < 3; ++i) positions[3 * v + i] = values.positions[g][i] * step;
        errors[v] = asFloat[0];
      }
    });
    parents.set(splits.parents, this.baseVertices);
    const uv = header.uv ? new Float32Array(2 * count) : null;
    for (let w = 0; uv && w < count; ++w)
      for (let i = 0; i < 2; ++i) uv[2 * w + i] = header.uvLow[i] + values.uv[w][i] * header.uvStep[i];
    this.made = {vertexCount: count, baseVertices: this.baseVertices, positions, parents, errors, uv,
            colours: header.colours ? Uint8Array.from(values.colours.flat()) : null, normals: null,
            materialIds: header.materialIds ? Int32Array.from(values.materials) : null, materials: header.materials.map(withSurface),
            textures: this.textureList(), triangles: splits.triangles(), whole: splits.stars.length === header.groups,
            origin: header.origin, scale: header.scale, up: header.up ?? 'y'};
    return this.made;
  }
}
