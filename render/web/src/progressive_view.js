// A progressive mesh in the scene: one vertex buffer, an index per rung of the ladder, ancestors as a second vertex.
import * as THREE from 'three';
import {bitmapOf} from './bitmap.js';
import {Ladder} from './ladder.js';
import {edgesOver, showEdges} from './look.js';
import {countingMaterial, morphMaterial, surfaceParameters, wrapping} from './morph_material.js';
import {seamlessLevels} from './octahedral_image.js';
import {Problem} from './problem.js';
import {unstacked} from './stacked_normals.js';
import {showsEmission} from './surface.js';
import {turnedBox} from './turn.js';

export class ProgressiveView {
  constructor(name, anisotropy) {
    Object.assign(this, {name, anisotropy, place: 0, wanted: null, drawn: null, mesh: null, images: [], outdated: []});
    this.share = {value: 1};
    this.node = new THREE.Group();
    this.frame = new THREE.Group();  // turned upright, or not
    this.node.add(this.frame);
    this.object = new THREE.Mesh(new THREE.BufferGeometry(), [morphMaterial({}, this.share)]);
    this.object.frustumCulled = false;  // of one model, always in sight
    this.object.userData.counting = countingMaterial(this.share);
    this.frame.add(this.object);
    edgesOver(this.object);
  }

  get ladder() { return this.ladder_; }
  get triangleCount() { return this.drawn?.triangles ?? 0; }
  get vertexCount() { return this.drawn?.fine ?? 0; }
  get box() { return turnedBox(this.extent, this.frame); }
  get objects() { return [this.object]; }

  // A mesh, or more of the mesh than before, which then is drawn as before: the top of the ladder that was is a rung of
  // the one that is.
  async setMesh(mesh) {
    if (this.mesh?.vertexCount === mesh.vertexCount) {  // images alone have come
      this.mesh.textures = mesh.textures;
      await this.makeMaterials();
      return;
    }
    const before = this.mesh && this.ladder_.rungs;
    this.ladder_ = new Ladder(mesh, before ?? []);
    this.mesh = mesh;
    if (!mesh.normals) mesh.normals = smoothNormals(mesh, this.ladder_.levels.groups);
    this.makeGeometry();
    if (!before) this.place = this.ladder_.top;
    this.drawn = null;
    this.show(this.place);
    await this.makeMaterials();
  }

  makeGeometry() {
    const {mesh} = this, geometry = new THREE.BufferGeometry();
    const add = (name, array, size) => geometry.setAttribute(name, new THREE.BufferAttribute(array, size));
    const uv = mesh.uv ?? new Float32Array(2 * mesh.vertexCount);
    add('position', mesh.positions.slice(), 3);
    add('normal', mesh.normals, 3);
    add('uv', uv, 2);
    add('fromPosition', mesh.positions.slice(), 3);
    add('fromNormal', mesh.normals.slice(), 3);
    add('fromUv', uv.slice(), 2);
    if (mesh.colours) {
      const linear = new Float32Array(mesh.colours.length);
      for (let k = 0; k < linear.length; ++k) {
        const x = mesh.colours[k] / 255;
        linear[k] = k % 4 === 3 ? x : x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
      }
      add('color', linear, 4);
    }
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    mesh.positions.forEach((x, k) => {
      low[k % 3] = Math.min(low[k % 3], x);
      high[k % 3] = Math.max(high[k % 3], x);
    });
    this.extent = new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high));
    this.object.geometry.dispose();
    this.object.geometry = this.object.userData.edges.geometry = geometry;
  }

  async makeMaterials() {
    const {mesh} = this, list = mesh.materials.length > 0 ? mesh.materials : [{colour: [0.8, 0.8, 0.78, 1]}];
    const materials = [];
    for (const m of list) {
      const parameters = {vertexColors: mesh.colours !== null};
      Object.assign(parameters, {color: new THREE.Color(...m.colour.slice(0, 3))}, surfaceParameters(m.colour, m.surface));
      if (mesh.uv && m.texture != null) parameters.map = await this.texture(m.texture, THREE.SRGBColorSpace, m.octahedral);
      if (mesh.uv && m.objectNormals != null) {  // right at every level, as the normals of vertices are not
        parameters.normalMap = await this.texture(m.objectNormals, THREE.NoColorSpace, m.octahedral, unstacked);
        parameters.normalMapType = THREE.ObjectSpaceNormalMap;
      } else if (mesh.uv && m.normalMap != null) {
        parameters.normalMap = await this.texture(m.normalMap, THREE.NoColorSpace, m.octahedral);
      }
      if (mesh.uv && showsEmission(m.surface)) parameters.emissiveMap = await this.texture(m.surface.emissiveMap, THREE.SRGBColorSpace, m.octahedral);
      materials.push(morphMaterial(parameters, this.share, m.surface));
    }
    for (const old of [...this.object.material, ...this.outdated.splice(0)]) old.dispose();
    this.object.material = materials;
    this.setEdges(this.object.userData.edges.visible);
  }

  // Made once for the thumbnail, and once for the image.
  async texture(index, colorSpace, layout, prepare = (image) => image) {
    const source = this.mesh.textures[index], before = this.images[index];
    if (!source?.bytes) return null;
    if (before?.bytes === source.bytes.length && before.type === source.type) return before.texture;
    const bitmap = prepare(await this.decode(source, index));
    const texture = layout && isOctahedral(bitmap) ? octahedralTexture(bitmap, colorSpace, layout) : new THREE.Texture(bitmap);
    Object.assign(texture, {flipY: false, colorSpace, anisotropy: this.anisotropy, ...wrapping(source.wrap), needsUpdate: true});
    if (before) this.outdated.push(before.texture);
    this.images[index] = {texture, bytes: source.bytes.length, type: source.type};
    return texture;
  }

  async decode({bytes, type}, index) {
    try {
      return await bitmapOf(new Blob([bytes], {type}));
    } catch {
      throw new Problem(`${this.name}: image ${index + 1} cannot be decoded (${type}, ${bytes.length} bytes)`);
    }
  }

  setEdges(on) { showEdges(this.object, on); }

  // A place on the ladder, with a fraction.
  show(place) {
    if (!this.mesh) return;
    this.place = Math.min(Math.max(place, 0), this.ladder_.top);
    const {coarse, fine, share} = this.ladder_.between(this.place);
    this.share.value = share;
    if (this.drawn?.fine === fine && this.drawn.coarse === coarse) return;
    const index = this.ladder_.levels.computeLevel(fine);
    this.fillAncestors(coarse, fine);
    this.setIndex(index);
    this.drawn = {coarse, fine, triangles: index.length / 3};
  }

  fillAncestors(coarse, fine) {
    const ladder = this.ladder_, ancestor = ladder.levels.computeGeomorph(coarse, fine), {attributes} = this.object.geometry;
    const fill = (target, values) => {
      values(target.array, target.itemSize);
      target.clearUpdateRanges();
      target.addUpdateRange(0, target.itemSize * fine);
      target.needsUpdate = true;
    };
    const take = (source) => (array, size) => {
      for (let v = 0; v < fine; ++v)
        for (let i = 0; i < size; ++i) array[size * v + i] = source[size * ancestor[v] + i];
    };
    fill(attributes.position, (array) => array.set(ladder.placesOf(fine).subarray(0, 3 * fine)));
    fill(attributes.fromPosition, take(ladder.placesOf(coarse)));
    fill(attributes.fromNormal, take(attributes.normal.array));
    fill(attributes.fromUv, take(attributes.uv.array));
  }

  // A group per material, the triangles of a level in their order.
  setIndex(index) {
    const {mesh} = this, {geometry} = this.object;
    geometry.clearGroups();
    if (!mesh.materialIds || mesh.materials.length < 2) {
      geometry.setIndex(new THREE.BufferAttribute(index, 1));
      geometry.addGroup(0, index.length, 0);
      return;
    }
    const sorted = new Uint32Array(index.length);
    let at = 0;
    for (let m = 0; m < mesh.materials.length; ++m) {
      const from = at;
      for (let k = 0; k < index.length; k += 3) {
        if (Math.max(mesh.materialIds[index[k]], 0) !== m) continue;
        sorted.set(index.subarray(k, k + 3), at);
        at += 3;
      }
      geometry.addGroup(from, at - from, m);
    }
    geometry.setIndex(new THREE.BufferAttribute(sorted, 1));
  }

  // Pixels that an error of the model's extent covers at the nearest point of the model.
  pixelsPerUnit(camera, height) {
    const eye = this.frame.worldToLocal(camera.getWorldPosition(new THREE.Vector3()));
    const distance = Math.max(this.extent.distanceToPoint(eye), camera.near / this.frame.getWorldScale(new THREE.Vector3()).x);
    return height / (2 * distance * Math.tan(THREE.MathUtils.degToRad(camera.fov) / 2));
  }

  // The place where the error is this many pixels.
  approach(camera, height, pixels, seconds) {
    return this.travel(this.ladder_.placeForError(pixels / this.pixelsPerUnit(camera, height)), seconds);
  }

  // A step towards a place, so that nothing jumps. Returns whether there was a way to go.
  travel(goal, seconds) {
    const way = goal - this.place, step = Math.max(8, Math.abs(way) * 4) * seconds;
    if (Math.abs(way) < 1e-4) return false;
    this.show(this.place + Math.sign(way) * Math.min(step, Math.abs(way)));
    return true;
  }

  // May be called again, for what has been made since.
  dispose() {
    this.object.geometry.dispose();
    for (const m of [...this.object.material, this.object.userData.counting, this.object.userData.edges.material, ...this.outdated.splice(0)]) m.dispose();
    for (const {texture} of this.images.splice(0).filter((i) => i)) {
      texture.dispose();
      texture.image.close?.();
    }
  }
}

const isOctahedral = ({width, height}) => width === height && (width & (width - 1)) === 0;

// Both sides of the cut show the same at every level.
function octahedralTexture(bitmap, colorSpace, layout) {
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), pen = canvas.getContext('2d');
  pen.drawImage(bitmap, 0, 0);
  const {data} = pen.getImageData(0, 0, bitmap.width, bitmap.height);
  const mipmaps = seamlessLevels(data, bitmap.width, colorSpace === THREE.SRGBColorSpace, layout);
  const texture = new THREE.DataTexture(mipmaps[0].data, bitmap.width, bitmap.height);
  return Object.assign(texture, {mipmaps, generateMipmaps: false, magFilter: THREE.LinearFilter, minFilter: THREE.LinearMipmapLinearFilter});
}

// Normals of the finest level, weighted by area, the same for all wedges of a vertex.
function smoothNormals({positions, triangles, vertexCount}, groups) {
  const sum = new Float32Array(3 * vertexCount), p = positions;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const corner of [a, b, c]) {
      const g = 3 * groups[corner / 3];
      sum[g] += x, sum[g + 1] += y, sum[g + 2] += z;
    }
  }
  const out = new Float32Array(3 * vertexCount);
  for (let v = 0; v < vertexCount; ++v) {
    const g = 3 * groups[v], size = Math.hypot(sum[g], sum[g + 1], sum[g + 2]) || 1;
    for (let i = 0; i < 3; ++i) out[3 * v + i] = sum[g + i] / size;
  }
  return out;
}
