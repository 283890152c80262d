// A plugin of 3DTilesRendererJS (npm 3d-tiles-renderer) that draws tilesets of `lodestone export --tiles --morph` as the page
// does: levels by distance, vertices that travel between them, no crack where levels meet, none while tiles are missing.
//
// The renderer by itself refines a tile by its own error in pixels. Here the distance decides, cell by cell, limited where
// tiles are missing (limits.js); the renderer loads what is wanted, and shows what the plugin has chosen: a tile whose
// error is infinite is replaced as soon as its children are there, and one without an error is not.
import * as THREE from 'three';
import {LimitTracker} from './limits.js';
import {approached, shareOf} from './pace.js';
import {makeRadii} from './radii.js';
import {morphTiles} from './tile_material.js';
import {MotionByDistance} from './tile_motion.js';
import {boxDistance, figuresOf, selectCells} from './tileset.js';

const LOADED = 4, FAILED = -1;  // states of the renderer's tiles

class Cell {
  constructor(tile, parent, cellOf) {
    const {level, bounds} = tile.extras;
    Object.assign(this, {tile, parent, cellOf, level, bounds});
  }

  // A tile that stands for a tileset of its own has that one's root in its place.
  get slots() { return this.tile.children.map((t) => this.cellOf.get(t) ?? this.cellOf.get(t.children?.[0])); }
  get children() { return this.slots.filter((c) => c); }
  get state() { return this.tile.content ? this.tile.internal.loadingState : LOADED; }
}

export class MorphPlugin {
  constructor() {
    this.name = 'LODESTONE_MORPH_PLUGIN';
    this.cellOf = new WeakMap();
    this.above = new WeakMap();  // of tiles that stand for tilesets: the cell of their parent, with which they are in view
    this.update = () => this.choose();
    this.learn = ({tileset, url}) => this.begin(tileset, url);
  }

  // To be registered before the renderer's first update.
  init(tiles) {
    this.tiles = tiles;
    // Parents take the place of children that are missing, and turning the head exchanges nothing: all cells count as in
    // view, and three leaves out those that are not.
    Object.assign(tiles, {loadAncestors: true, autoDisableRendererCulling: false});
    const {calculateTileViewError} = tiles;
    tiles.calculateTileViewError = (tile, target) => {
      const cell = this.cellOf.get(tile) ?? this.above.get(tile);
      if (cell && this.figures) this.judge(cell, target);
      else calculateTileViewError.call(tiles, tile, target);
    };
    tiles.addEventListener('load-root-tileset', this.learn);
    tiles.addEventListener('update-before', this.update);
  }

  dispose() {
    const {tiles} = this;
    delete tiles.calculateTileViewError;
    tiles.removeEventListener('load-root-tileset', this.learn);
    tiles.removeEventListener('update-before', this.update);
    this.motion?.dispose();
  }

  preprocessNode(tile, folder, parent) {
    if (tile.extras?.bounds === undefined) {
      if (this.cellOf.has(parent)) this.above.set(tile, this.cellOf.get(parent));
      return;
    }
    this.cellOf.set(tile, new Cell(tile, this.cellOf.get(parent) ?? this.cellOf.get(parent?.parent) ?? null, this.cellOf));
    // Children whose error is not below their parent's would always be refined.
    tile.geometricError = 2 ** -tile.extras.level;
  }

  begin(tileset, url) {
    this.figures = figuresOf(tileset, url);
    this.root = this.cellOf.get(tileset.root);
    this.tracker = new LimitTracker();
    this.motion = new MotionByDistance(this.figures.finest + 1);
    Object.assign(this, {viewpoint: [0, 0, 0], pixels: null, time: performance.now(), drawn: [], refined: new Set()});
  }

  processTileModel(scene, tile) {
    const cell = this.cellOf.get(tile), {figures} = this;
    if (!cell || !figures) return;
    const uniforms = this.motion.uniformsOf(cell), materials = new Set();
    scene.traverse((mesh) => {
      if (!mesh.isMesh) return;
      const {geometry, geometry: {attributes: a}, material} = mesh;
      const parents = {parentPosition: a._parent ?? a.position, parentNormal: a._parentnormal ?? a.normal,
                       parentUv: a._parenttexcoord ?? a.uv, parentColor: a._parentcolor ?? a.color};
      for (const [name, values] of Object.entries(parents)) if (values) geometry.setAttribute(name, values);
      for (const name of ['_parent', '_parentnormal', '_parenttexcoord', '_parentcolor']) geometry.deleteAttribute(name);
      geometry.boundingSphere.radius += figures.sigma0 * figures.sides[cell.level] / 2;  // as far as vertices may travel
      materials.add(material);
      mesh.userData.morph = uniforms;
    });
    materials.forEach((m) => morphTiles(m, uniforms));
  }

  // What this frame draws, and what it wants besides.
  choose() {
    const {tiles, root, figures} = this, [camera] = tiles.cameras;
    if (!root || !camera) return;
    const seconds = (performance.now() - this.time) / 1000, share = shareOf(seconds), p = camera.projectionMatrix.elements;
    this.time += 1000 * seconds;
    this.pixels = approached(this.pixels, tiles.errorTarget, share);
    const height = tiles.getResolution(camera, new THREE.Vector2()).y;
    const radii = makeRadii(figures, {pixels: this.pixels, height, fov: 2 * Math.atan(1 / p[5]), aspect: p[5] / p[0]});
    const eye = new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld).applyMatrix4(tiles.group.matrixWorldInverse);
    eye.applyMatrix4(root.tile.engineData.transformInverse).divideScalar(figures.scale);
    const viewpoint = this.viewpoint = eye.toArray().map(Math.fround);  // like the shader's
    const {limits, missing, changed} = this.tracker.update({root, finest: figures.finest}, radii, viewpoint, stateOf, share);
    this.drawn = root.state === LOADED ? selectCells({root, finest: figures.finest}, radii, viewpoint, limits) : [];
    this.refined = new Set(missing.filter((c) => c.slots.every((k) => k?.state !== FAILED)));
    for (const cell of this.drawn) for (let c = cell.parent; c !== null; c = c.parent) this.refined.add(c);
    this.motion.update(this.drawn, radii, viewpoint, limits);
    if (changed || this.pixels !== tiles.errorTarget) tiles.dispatchEvent({type: 'needs-update'});
  }

  judge(cell, target) {
    target.inView = true;
    target.error = this.refined.has(cell) ? Infinity : 0;
    target.distanceFromCamera = this.figures.scale * boxDistance(this.viewpoint, cell.bounds);
  }
}

const stateOf = (cell) => (cell.slots.every((c) => c?.state === LOADED) ? 'there' : 'missing');
