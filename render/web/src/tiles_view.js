// A hierarchical level of detail in the scene: tiles by distance, as far as they are there and memory goes.
import * as THREE from 'three';
import {Archive} from './archive.js';
import {ask, reading} from './files.js';
import {Glb} from './glb.js';
import {edgesOver, showEdges} from './look.js';
import {surfaceParameters} from './morph_material.js';
import {approached, shareOf} from './pace.js';
import {Problem} from './problem.js';
import {radiiOfViews} from './radii.js';
import {ResidentTiles} from './resident_tiles.js';
import {placesOf} from './signatures.js';
import {showsEmission} from './surface.js';
import {TextureCache} from './texture_cache.js';
import {countingTileMaterial, tileMaterial} from './tile_material.js';
import {motionOf} from './tile_motion.js';
import {loadTileset} from './tileset.js';
import {turnedBox} from './turn.js';

const COARSEST = 64;  // pixels of error where levels begin

// Anything else would draw nothing, or all over the picture, without a word.
function checkGeometry({attributes, index}, name) {
  const {count} = attributes.position;
  const holds = Object.values(attributes).every((a) => a.count === count) && index.array.every((v) => v < count) &&
    ['position', 'parentPosition'].every((a) => attributes[a].array instanceof Float32Array && attributes[a].array.every(Number.isFinite));
  if (!holds) throw new Problem(`${name}: vertices or triangles of the tile cannot be; the file is damaged`);
}

// A view of the tileset at an address, with its coarsest tile. `budget`: bytes of memory; `say(error)` is called for tiles
// that cannot be loaded later.
export const openTiles = (url, name, {anisotropy, budget, say}) => reading(name, async () => {
  const at = new URL(url, location.href).href, archive = /\.3tz$/i.test(new URL(at).pathname) ? await Archive.open(at) : null;
  const request = archive ? (file, signal) => archive.get(file, signal) : async (file, signal) => (await ask(file, signal)).arrayBuffer();
  const json = async (file) => JSON.parse(new TextDecoder().decode(await request(file)));
  const view = new TilesView(name, await loadTileset(archive ? `${at}/tileset.json` : at, json), anisotropy, {request, say, budget});
  await view.start();
  return view;
});

export class TilesView {
  // `request(url, signal)` resolves to bytes; `say(error)` is called for tiles that cannot be loaded.
  constructor(name, tileset, anisotropy, {request, say, budget}) {
    Object.assign(this, {name, tileset, request, pixels: null, edges: false, shown: []});
    this.textures = new TextureCache(request, anisotropy, {thumbnails: tileset.thumbnails, say});
    this.residents = new ResidentTiles(tileset, {load: (cell, signal) => this.load(cell, signal), release: (cell) => this.release(cell),
                                                 failed: say}, budget);
    this.node = new THREE.Group();
    this.frame = new THREE.Group();  // turned upright, or not
    this.node.add(this.frame);
    this.motion = motionOf(tileset);
    this.radiiFor = radiiOfViews(tileset);
    const [x0, y0, z0, x1, y1, z1] = tileset.root.bounds;
    this.extent = new THREE.Box3(new THREE.Vector3(x0, y0, z0), new THREE.Vector3(x1, y1, z1));
  }

  get box() { return turnedBox(this.extent, this.frame); }
  get drawn() { return this.residents.drawn; }
  get objects() { return this.drawn.filter((c) => c.object).map((c) => c.object); }
  get triangleCount() { return this.objects.reduce((sum, o) => sum + o.geometry.index.count / 3, 0); }

  // The tolerance of a level from 0 to 1, and the level of a tolerance.
  pixelsOf(level) { return COARSEST ** (1 - level); }
  levelOf(pixels) { return 1 - Math.log(pixels) / Math.log(COARSEST); }

  async start() {
    await this.residents.start();
    this.show(this.drawn);
  }

  setEdges(on) {
    this.edges = on;
    for (const {object} of this.tileset.cells) if (object) showEdges(object, on);
  }

  // Resolves to the bytes of the cell's arrays and of its textures. A cell without triangles has no file.
  async load(cell, signal) {
    if (cell.url === null) return {bytes: 0, textures: []};
    return reading(cell.url, () => this.loadFile(cell, signal));
  }

  async loadFile(cell, signal) {
    const glb = new Glb(new Uint8Array(await this.request(cell.url, signal)), cell.url);
    await glb.ready;
    const [{primitives, extras}] = glb.json.meshes;
    cell.taken = [];
    const looks = await Promise.all(primitives.map((p) => this.lookOf(cell, glb, p.material)));
    const geometry = this.makeGeometry(glb, primitives);
    if (this.tileset.signatures) {
      const places = placesOf(cell, extras?.signatures, geometry.attributes.position.count);
      geometry.setAttribute('signature', new THREE.BufferAttribute(places, 1));
    }
    checkGeometry(geometry, glb.name);
    const uniforms = this.motion.uniformsOf(cell);
    const common = {vertexColors: geometry.attributes.color !== undefined};
    cell.object = new THREE.Mesh(geometry, looks.map((look) => tileMaterial(uniforms, {...common, ...look})));
    Object.assign(cell.object, {frustumCulled: false, visible: false});
    cell.object.userData.counting = countingTileMaterial(uniforms);
    edgesOver(cell.object);
    showEdges(cell.object, this.edges);
    this.frame.add(cell.object);
    return {bytes: [geometry.index, ...Object.values(geometry.attributes)].reduce((sum, a) => sum + a.array.byteLength, 0),
            textures: [...new Set(cell.taken)].map((url) => [url, this.textures.bytesOf(url)])};
  }

  makeGeometry(glb, primitives) {
    const {attributes} = primitives[0], geometry = new THREE.BufferGeometry();
    const add = (to, from, size) => {
      if (from === undefined) return;
      const normalized = glb.json.accessors[from].normalized === true;
      geometry.setAttribute(to, new THREE.BufferAttribute(glb.accessor(from), size, normalized));
    };
    add('position', attributes.POSITION, 3);
    add('normal', attributes.NORMAL, 3);
    add('uv', attributes.TEXCOORD_0, 2);
    add('parentPosition', attributes._PARENT ?? attributes.POSITION, 3);
    add('parentNormal', attributes._PARENTNORMAL ?? attributes.NORMAL, 3);
    add('parentUv', attributes._PARENTTEXCOORD ?? attributes.TEXCOORD_0, 2);
    add('color', attributes.COLOR_0, 4);
    add('parentColor', attributes._PARENTCOLOR ?? attributes.COLOR_0, 4);
    const indices = primitives.map((p) => glb.accessor(p.indices));
    const index = new Uint32Array(indices.reduce((sum, ids) => sum + ids.length, 0));
    indices.reduce((at, ids, k) => {
      index.set(ids, at);
      geometry.addGroup(at, ids.length, k);
      return at + ids.length;
    }, 0);
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    return geometry;
  }

  async lookOf(cell, glb, index) {
    const m = index === undefined ? null : glb.material(index);
    if (!m) return {color: new THREE.Color(0.8, 0.8, 0.78)};
    const look = {color: new THREE.Color(...m.colour.slice(0, 3)), surface: m.surface, ...surfaceParameters(m.colour, m.surface)};
    const take = (image) => {
      const {uri, wrap} = glb.image(image), url = new URL(uri, cell.url).href;
      cell.taken.push(url);
      return this.textures.take(url, wrap, new Map(cell.textures).get(url));
    };
    if (m.texture != null) look.map = await take(m.texture);
    if (showsEmission(m.surface)) look.emissiveMap = await take(m.surface.emissiveMap);
    return look;
  }

  release(cell) {
    for (const url of cell.taken ?? []) this.textures.giveBack(url);
    cell.taken = [];
    if (!cell.object) return;
    this.frame.remove(cell.object);
    cell.object.geometry.dispose();
    for (const m of [...cell.object.material, cell.object.userData.counting, cell.object.userData.edges.material]) m.dispose();
    cell.object = null;
  }

  dispose() {
    this.residents.dispose();
    this.motion.dispose();
  }

  // Approaches a tolerance of this number of pixels in small steps. Returns true if the next picture may differ though
  // the camera rests: tiles are on their way, or limits move.
  approach(camera, height, pixels, seconds) {
    const share = shareOf(seconds);
    this.pixels = approached(this.pixels, pixels, share);
    const radii = this.radiiFor({pixels: this.pixels, height, fov: THREE.MathUtils.degToRad(camera.fov), aspect: camera.aspect});
    const eye = this.frame.worldToLocal(camera.getWorldPosition(new THREE.Vector3()));
    const viewpoint = eye.toArray().map(Math.fround);  // like the shader's
    const moves = this.residents.update(radii, viewpoint, share);
    this.show(this.drawn, this.sight(camera));
    this.motion.update(this.drawn, radii, viewpoint, this.residents.limits);
    this.state = {viewpoint, radii, limits: this.residents.limits, share, bytes: this.residents.bytes, drawn: this.drawn};
    this.arrived = this.residents.progress;
    return moves || this.textures.coming > 0 || this.pixels !== pixels;
  }

  // Tells if the camera may see a cell; morphing vertices leave its box by at most the way they may travel.
  sight(camera) {
    camera.updateMatrixWorld();
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(this.frame.matrixWorld));
    const box = new THREE.Box3();
    return ({bounds, level}) => {
      box.min.fromArray(bounds);
      box.max.fromArray(bounds, 3);
      return frustum.intersectsBox(box.expandByScalar(this.tileset.sigma0 * this.tileset.sides[level] / 2));
    };
  }

  show(cells, seen = () => true) {
    for (const cell of this.shown) if (cell.object) cell.object.visible = false;
    for (const cell of cells) if (cell.object) cell.object.visible = seen(cell);
    this.shown = cells;
  }
}
