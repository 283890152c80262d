// Uniforms that move the vertices of tiles, for their shaders (tile_material.js): their distances and the bands of their levels, or
// with radii by cell a lambda by signature.
import * as THREE from 'three';
import {limitsNear} from './limits.js';
import {FrameLambdas} from './signatures.js';
import {boxDistance, distanceIn} from './tileset.js';

const FAR = 3e38;  // for shaders, which need not know infinity

// Numbers of a frame that shaders look up, 256 texels in a row.
class FrameTexture {
  constructor(format, channels) {
    Object.assign(this, {format, channels, uniform: {value: null}});
    this.resize(1);
  }

  resize(rows) {
    this.dispose();
    this.data = new Float32Array(256 * this.channels * rows).fill(1);
    this.uniform.value = new THREE.DataTexture(this.data, 256, rows, this.format, THREE.FloatType);
    this.uniform.value.needsUpdate = true;
  }

  // The numbers, of which the first are to be replaced: those of so many texels.
  begin(texels) {
    const size = this.channels * texels;
    if (size > this.data.length) this.resize(2 ** Math.ceil(Math.log2(texels / 256)));
    if (size > 0) this.uniform.value.needsUpdate = true;
    return this.data;
  }

  dispose() { this.uniform.value?.dispose(); }
}

// Both: `uniformsOf(cell)` are those of its materials; `update` is called before each frame with the cells that it draws.
export class MotionByDistance {
  constructor(levels) {
    this.viewpoint = {value: new THREE.Vector3()};
    this.bands = Array.from({length: levels}, () => ({bandBegin: {value: 0}, bandEnd: {value: FAR}}));
    this.limitBoxes = new FrameTexture(THREE.RGBAFormat, 4);
    this.ranges = new WeakMap();  // of limits, by cell
  }

  uniformsOf(cell) {
    const range = new THREE.Vector2();
    this.ranges.set(cell, range);
    return {viewpoint: this.viewpoint, limitBoxes: this.limitBoxes.uniform, limitRange: {value: range}, ...this.bands[cell.level]};
  }

  // Limits of all cells, those of a cell one after the other: two texels each, low corner and radius, high corner.
  update(cells, {begin, end}, viewpoint, limits) {
    this.viewpoint.value.fromArray(viewpoint);
    this.bands.forEach(({bandBegin, bandEnd}, l) => {
      bandBegin.value = Math.min(begin[l], FAR);
      bandEnd.value = Math.min(end[l], FAR);
    });
    const lists = cells.map((c) => limitsNear(c.bounds, boxDistance(viewpoint, c.bounds), limits));
    const data = this.limitBoxes.begin(2 * lists.flat().length);
    let at = 0;
    lists.forEach((list, k) => {
      this.ranges.get(cells[k])?.set(at, at + list.length);
      for (const {box, radius} of list) data.set([box[0], box[1], box[2], radius, box[3], box[4], box[5], 0], 8 * at++);
    });
  }

  dispose() { this.limitBoxes.dispose(); }
}

export class MotionBySignature {
  constructor(tileset) {
    Object.assign(this, {tileset, lambdas: new FrameTexture(THREE.RedFormat, 1), firsts: new WeakMap()});
  }

  uniformsOf(cell) {
    const firstLambda = {value: 0};
    this.firsts.set(cell, firstLambda);
    return {lambdas: this.lambdas.uniform, firstLambda};
  }

  // Lambdas of all cells, those of a cell one after the other.
  update(cells, radii, viewpoint, limits) {
    const frame = new FrameLambdas(this.tileset, radii, distanceIn(viewpoint, limits)), lists = cells.map((c) => frame.of(c));
    const data = this.lambdas.begin(lists.flat().length);
    let at = 0;
    lists.forEach((list, k) => {
      const first = this.firsts.get(cells[k]);
      if (first) first.value = at;
      data.set(list, at);
      at += list.length;
    });
  }

  dispose() { this.lambdas.dispose(); }
}

export const motionOf = (tileset) => (tileset.signatures ? new MotionBySignature(tileset) : new MotionByDistance(tileset.error.length));
