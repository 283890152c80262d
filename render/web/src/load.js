// The package's entry: a model in the coordinates of its file, for any scene of three.js.
import * as THREE from 'three';
import {streamMesh} from './files.js';
import {ProgressiveView} from './progressive_view.js';
import {openTiles} from './tiles_view.js';
import {directionOf} from './turn.js';

const ANISOTROPY = 8;

// Resolves when there is something to draw; rejects with an Error of one line about what is wrong with the file. The
// rest arrives while the model is drawn. A name that ends in .json or .3tz is that of a tileset.
export async function load(url, {pixels = 1, megabytes = 512, onChange = () => {}, onError = (e) => console.error(e.message)} = {}) {
  const name = new URL(url, location.href).pathname.split('/').pop();
  const how = {name, pixels, onChange, onError};
  return /\.(json|3tz)$/i.test(name) ? loadTiles(url, megabytes, how) : loadProgressive(url, how);
}

async function loadTiles(url, megabytes, how) {
  const budget = Math.floor(2 ** 20 * megabytes);
  const view = await openTiles(url, how.name, {anisotropy: ANISOTROPY, budget, say: how.onError});
  return new Model(view, view.tileset, how, () => {});
}

async function loadProgressive(url, how) {
  const view = new ProgressiveView(how.name, ANISOTROPY), controller = new AbortController(), {signal} = controller;
  let model = /** @type {Model} */ (null);
  await new Promise((shown, failed) => {
    const show = async (mesh) => {
      await view.setMesh(mesh);
      if (signal.aborted) view.dispose();
      model ??= new Model(view, mesh, how, () => controller.abort());
      shown();
      how.onChange();
    };
    const count = (bytes, all) => { view.arrived = {bytes, all}; };
    streamMesh(url, how.name, {show, count, signal}).catch((error) => {
      if (model === null) failed(error);
      else if (!signal.aborted) how.onError(error);
    }).then(() => {
      view.arrived = null;
      if (!signal.aborted) how.onChange();
    });
  });
  return model;
}

class Model {
  // `origin` and `scale`: from the unit cube of the view to the coordinates of the file.
  constructor(view, {origin, scale}, {pixels}, stop) {
    this.view = view;
    this.stop = stop;
    this.object = view.node;
    this.object.name = view.name;
    this.object.position.fromArray(origin);
    this.object.scale.setScalar(scale);
    this.pixels = pixels;
    this.level = /** @type {number | null} */ (null);
    this.time = performance.now();
    this.disposed = false;
  }

  get box() {
    const {origin, scale} = this.view.tileset ?? this.view.mesh, {min, max} = this.view.extent.clone();
    const move = (corner) => corner.multiplyScalar(scale).add(new THREE.Vector3().fromArray(origin));
    return new THREE.Box3(move(min), move(max));
  }
  get up() { return directionOf(this.view.tileset ?? this.view.mesh); }
  get triangleCount() { return this.view.triangleCount; }
  get arrived() { return this.view.arrived ?? null; }

  update(camera, height) {
    if (this.disposed) return false;
    const now = performance.now(), seconds = Math.min(Math.max(now - this.time, 1) / 1000, 0.1), {view} = this;
    this.time = now;
    if (this.level === null) return view.approach(camera, height, this.pixels, seconds);
    return view.ladder ? view.travel(this.level * view.ladder.top, seconds)
                       : view.approach(camera, height, view.pixelsOf(this.level), seconds);
  }

  dispose() {
    this.disposed = true;
    this.stop();
    this.object.removeFromParent();
    this.view.dispose();
  }
}
