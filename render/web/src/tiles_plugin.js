// A plugin of 3DTilesRendererJS (npm 3d-tiles-renderer) that draws tilesets of `lodestone export --tiles --morph` as the page
// does: cells by distance, vertices that travel between levels, no crack where these meet, none while tiles are missing.
//
// The renderer by itself refines a tile by its own error in pixels. Here the distance decides, cell by cell, limited where
// tiles are missing (limits.js); the renderer loads what is wanted, and shows what the plugin has chosen: a tile whose
// error is infinite is replaced as soon as its children are there, and one without an error is not.
import * as THREE from 'three';
import {LimitTracker} from './limits.js';
import {approached, shareOf} from './pace.js';
import {Problem} from './problem.js';
import {radiiOfViews} from './radii.js';
import {placesOf} from './signatures.js';
import {morphTiles} from './tile_material.js';
import {motionOf} from './tile_motion.js';
import {boxDistance, loadTileset, selectCells} from './tileset.js';

const LOADED = 4, FAILED = -1;  // states of the renderer's tiles

// The state of a cell's tile, which a cell has once the renderer has come to it.
const stateOf = ({tile}) => (!tile ? 0 : tile.content ? tile.internal.loadingState : LOADED);
const childrenOf = (cell) => (cell.children.every((c) => stateOf(c) === LOADED) ? 'there' : 'missing');

export class MorphPlugin {
  constructor() {
    this.name = 'LODESTONE_MORPH_PLUGIN';
    this.cellOf = new WeakMap();  // of tiles, also those that stand for tilesets of their own, whose root the cell is
    this.update = () => this.choose();
  }

  // To be registered before the renderer's first update.
  init(tiles) {
    this.tiles = tiles;
    // Parents take the place of children that are missing, and turning the head exchanges nothing: all cells count as in
    // view, and three leaves out those that are not.
    Object.assign(tiles, {loadAncestors: true, autoDisableRendererCulling: false});
    const {calculateTileViewError} = tiles;
    tiles.calculateTileViewError = (tile, target) => {
      const cell = this.cellOf.get(tile);
      if (cell) this.judge(cell.tile === tile ? cell : cell.parent, target);
      else calculateTileViewError.call(tiles, tile, target);
    };
    tiles.addEventListener('update-before', this.update);
  }

  dispose() {
    const {tiles} = this;
    delete tiles.calculateTileViewError;
    tiles.removeEventListener('update-before', this.update);
    this.motion?.dispose();
  }

  // All cells are known before the first is drawn, as radii follow from the finest ones up.
  async loadRootTileset() {
    const {tiles} = this;
    this.tileset = await loadTileset(new URL(this.requested(tiles.rootURL), location.href).href, (url) => this.fetchJson(url));
    this.motion = motionOf(this.tileset);
    this.radiiFor = radiiOfViews(this.tileset);
    this.tracker = new LimitTracker();
    Object.assign(this, {viewpoint: [0, 0, 0], pixels: null, time: performance.now(), drawn: [], refined: new Set()});
    return tiles.invokeOnePlugin((p) => p !== this && p.loadRootTileset && p.loadRootTileset());
  }

  // As the renderer and its other plugins ask for tilesets.
  requested(url) {
    let processed = url;
    this.tiles.invokeAllPlugins((p) => { processed = p.preprocessURL ? p.preprocessURL(processed, null) : processed; });
    return processed;
  }

  async fetchJson(url) {
    const {tiles} = this, answer = await tiles.invokeOnePlugin((p) => p.fetchData && p.fetchData(this.requested(url), tiles.fetchOptions));
    if (!(answer instanceof Response)) return answer;
    if (!answer.ok) throw new Problem(`${url}: cannot be loaded (${answer.status} ${answer.statusText})`);
    return answer.json();
  }

  preprocessNode(tile, folder, parent) {
    const above = this.cellOf.get(parent);
    const cell = !parent ? this.tileset.root : above?.tile === parent ? above.children[parent.children.indexOf(tile)] : above;
    if (!cell) return;
    this.cellOf.set(tile, cell);
    if (tile.extras?.bounds === undefined) return;
    cell.tile = tile;
    // Children whose error is not below their parent's would always be refined.
    tile.geometricError = 2 ** -cell.level;
  }

  processTileModel(scene, tile) {
    const cell = this.cellOf.get(tile), {tileset} = this;
    if (!cell) return;
    const uniforms = this.motion.uniformsOf(cell), materials = new Set();
    scene.traverse((mesh) => {
      if (!mesh.isMesh) return;
      const {geometry, geometry: {attributes: a}, material} = mesh;
      const parents = {parentPosition: a._parent ?? a.position, parentNormal: a._parentnormal ?? a.normal,
                       parentUv: a._parenttexcoord ?? a.uv, parentColor: a._parentcolor ?? a.color};
      for (const [name, values] of Object.entries(parents)) if (values) geometry.setAttribute(name, values);
      for (const name of ['_parent', '_parentnormal', '_parenttexcoord', '_parentcolor']) geometry.deleteAttribute(name);
      if (tileset.signatures)
        geometry.setAttribute('signature', new THREE.BufferAttribute(placesOf(cell, mesh.userData.signatures, a.position.count), 1));
      geometry.boundingSphere.radius += tileset.sigma0 * tileset.sides[cell.level] / 2;  // as far as vertices may travel
      materials.add(material);
      mesh.userData.morph = uniforms;
    });
    materials.forEach((m) => morphTiles(m, uniforms));
  }

  // What this frame draws, and what it wants besides.
  choose() {
    const {tiles, tileset} = this, [camera] = tiles.cameras;
    if (!tileset?.root.tile || !camera) return;
    const seconds = (performance.now() - this.time) / 1000, share = shareOf(seconds), p = camera.projectionMatrix.elements;
    this.time += 1000 * seconds;
    this.pixels = approached(this.pixels, tiles.errorTarget, share);
    const height = tiles.getResolution(camera, new THREE.Vector2()).y;
    const radii = this.radiiFor({pixels: this.pixels, height, fov: 2 * Math.atan(1 / p[5]), aspect: p[5] / p[0]});
    const eye = new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld).applyMatrix4(tiles.group.matrixWorldInverse);
    eye.applyMatrix4(tileset.root.tile.engineData.transformInverse).divideScalar(tileset.scale);
    const viewpoint = this.viewpoint = eye.toArray().map(Math.fround);  // like the shader's
    const {limits, missing, changed} = this.tracker.update(tileset, radii, viewpoint, childrenOf, share);
    this.drawn = stateOf(tileset.root) === LOADED ? selectCells(tileset, radii, viewpoint, limits) : [];
    this.refined = new Set(missing.filter((cell) => cell.children.every((c) => stateOf(c) !== FAILED)));
    for (const cell of this.drawn) for (let c = cell.parent; c !== null; c = c.parent) this.refined.add(c);
    this.motion.update(this.drawn, radii, viewpoint, limits);
    if (changed || this.pixels !== tiles.errorTarget) tiles.dispatchEvent({type: 'needs-update'});
  }

  judge(cell, target) {
    target.inView = true;
    target.error = this.refined.has(cell) ? Infinity : 0;
    target.distanceFromCamera = this.tileset.scale * boxDistance(this.viewpoint, cell.bounds);
  }
}
