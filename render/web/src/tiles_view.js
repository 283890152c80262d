// A hierarchical level of detail in the scene: cells by distance, vertices on their way to their parents in the vertex
// shader. Both sides of a border between levels stand at the coarser places, so that nothing cracks, and at the instant
// of an exchange both levels do, so that nothing pops.
import * as THREE from 'three';
import {Glb} from './glb.js';
import {makeRadii, selectCells} from './tileset.js';

const declarations = `
uniform vec3 viewpoint;
uniform float bandBegin, bandEnd, leastDistance;
attribute vec3 parentPosition;
attribute vec3 parentNormal;
invariant gl_Position;
float morphShare() {
  vec3 a = abs(position - viewpoint);
  float d = max(sqrt((a.x * a.x + a.y * a.y) + a.z * a.z), leastDistance);
  if (d < bandBegin) return 1.0;
  if (d >= bandEnd) return 0.0;
  return 1.0 - (d - bandBegin) / (bandEnd - bandBegin);
}
vec3 travelled(vec3 own, vec3 parent, float share) {
  return share >= 1.0 ? own : share <= 0.0 ? parent : share * own + (1.0 - share) * parent;
}
`;

export class TilesView {
  constructor(name, tileset, anisotropy, request) {
    Object.assign(this, {name, tileset, anisotropy, request, drawn: [], loading: 0, textures: new Map()});
    this.node = new THREE.Group();
    this.frame = new THREE.Group();  // z up to y up
    this.frame.rotation.x = -Math.PI / 2;
    this.node.add(this.frame);
    this.viewpoint = {value: new THREE.Vector3()};
    this.floor = {value: 1e9};
    this.levels = tileset.error.map(() => ({bandBegin: {value: 0}, bandEnd: {value: 1e9}}));
    const [x0, y0, z0, x1, y1, z1] = tileset.root.bounds;
    this.box = new THREE.Box3(new THREE.Vector3(x0, z0, -y1), new THREE.Vector3(x1, z1, -y0));
    this.wireframe = false;
  }

  get objects() { return this.drawn.filter((c) => c.object).map((c) => c.object); }
  get triangleCount() { return this.drawn.reduce((sum, c) => sum + (c.triangles ?? 0), 0); }

  async start() {
    await this.load(this.tileset.root);
    this.drawn = [this.tileset.root];
  }

  setWireframe(on) {
    this.wireframe = on;
    for (const cell of this.tileset.cells) cell.object?.material.forEach((m) => { m.wireframe = on; });
  }

  uniforms(level) {
    return {viewpoint: this.viewpoint, leastDistance: this.floor, ...this.levels[level]};
  }

  material(level, parameters) {
    const uniforms = this.uniforms(level);
    const material = new THREE.MeshStandardMaterial({roughness: 0.85, metalness: 0, side: THREE.DoubleSide,
                                                     wireframe: this.wireframe, ...parameters});
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      shader.vertexShader = declarations + shader.vertexShader
        .replace('#include <beginnormal_vertex>', 'float share = morphShare(); vec3 objectNormal = normalize(travelled(normal, parentNormal, share) + vec3(1e-20));')
        .replace('#include <begin_vertex>', 'vec3 transformed = travelled(position, parentPosition, share);');
    };
    material.customProgramCacheKey = () => 'tiles';
    return material;
  }

  counting(level) {
    return new THREE.ShaderMaterial({
      uniforms: this.uniforms(level),
      vertexShader: `${declarations} void main() {
        gl_Position = projectionMatrix * (modelViewMatrix * vec4(travelled(position, parentPosition, morphShare()), 1.0)); }`,
      fragmentShader: 'void main() { gl_FragColor = gl_FrontFacing ? vec4(1.0 / 255.0, 0, 0, 0) : vec4(0, 1.0 / 255.0, 0, 0); }',
      side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true, blending: THREE.CustomBlending,
      blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor, blendSrcAlpha: THREE.OneFactor, blendDstAlpha: THREE.OneFactor});
  }

  async load(cell) {
    if (cell.state !== 'absent' || cell.url === null) return;
    cell.state = 'asked';
    ++this.loading;
    try {
      const glb = new Glb(new Uint8Array(await this.request(cell.url)), cell.url);
      await glb.ready;
      await this.makeObject(cell, glb);
      cell.state = 'there';
    } finally {
      --this.loading;
    }
  }

  async makeObject(cell, glb) {
    const primitives = glb.json.meshes[0].primitives, attributes = primitives[0].attributes;
    const geometry = new THREE.BufferGeometry();
    const add = (to, from, size) => {
      if (from !== undefined) geometry.setAttribute(to, new THREE.BufferAttribute(glb.accessor(from), size));
    };
    add('position', attributes.POSITION, 3);
    add('normal', attributes.NORMAL, 3);
    add('uv', attributes.TEXCOORD_0, 2);
    add('parentPosition', attributes._PARENT ?? attributes.POSITION, 3);
    add('parentNormal', attributes._PARENTNORMAL ?? attributes.NORMAL, 3);
    const materials = [], indices = primitives.map((p) => glb.accessor(p.indices));
    const index = new Uint32Array(indices.reduce((sum, ids) => sum + ids.length, 0));
    let at = 0;
    for (let k = 0; k < primitives.length; ++k) {
      index.set(indices[k], at);
      geometry.addGroup(at, indices[k].length, k);
      at += indices[k].length;
      materials.push(await this.materialOf(cell, glb, primitives[k].material));
    }
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    cell.triangles = index.length / 3;
    cell.object = new THREE.Mesh(geometry, materials);
    cell.object.frustumCulled = false;
    cell.object.visible = false;
    cell.object.userData.counting = this.counting(cell.level);
    this.frame.add(cell.object);
  }

  async materialOf(cell, glb, index) {
    const m = index === undefined ? null : glb.material(index);
    const parameters = {color: m ? new THREE.Color(...m.colour.slice(0, 3)) : new THREE.Color(0.8, 0.8, 0.78)};
    if (m?.texture != null) parameters.map = await this.texture(new URL(glb.image(m.texture).uri, cell.url).href);
    return this.material(cell.level, parameters);
  }

  texture(url) {
    if (!this.textures.has(url))
      this.textures.set(url, (async () => {
        const texture = new THREE.Texture(await createImageBitmap(new Blob([await this.request(url)])));
        Object.assign(texture, {flipY: false, colorSpace: THREE.SRGBColorSpace, anisotropy: this.anisotropy,
                                wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping, needsUpdate: true});
        return texture;
      })());
    return this.textures.get(url);
  }

  // Returns whether the picture changes by itself: cells come in, or the floor sinks.
  approach(camera, height, pixels, seconds) {
    const fov = THREE.MathUtils.degToRad(camera.fov);
    const radii = makeRadii(this.tileset, {pixels, height, fov, aspect: camera.aspect});
    const far = 3e38;
    this.levels.forEach((u, l) => {
      u.bandBegin.value = Math.min(radii.begin[l], far);
      u.bandEnd.value = Math.min(radii.end[l], far);
    });
    const eye = this.frame.worldToLocal(camera.position.clone());
    this.viewpoint.value.copy(eye);
    // As 32-bit floats, like the shader's.
    const viewpoint = [eye.x, eye.y, eye.z].map(Math.fround);
    const before = this.floor.value;
    const {least, missing} = selectCells(this.tileset, radii, viewpoint, 0);
    this.floor.value = Math.fround(least >= before ? least : Math.max(least, Math.min(before, radii.select[0] * 1.01) * Math.exp(-3 * seconds) - 1e-4));
    for (const cell of missing)
      for (const child of cell.children)
        if (this.loading < 6) this.load(child).catch((e) => console.warn(String(e)));
    this.draw(selectCells(this.tileset, radii, viewpoint, this.floor.value).drawn);
    return this.loading > 0 || this.floor.value !== before;
  }

  draw(cells) {
    for (const cell of this.drawn) if (cell.object) cell.object.visible = false;
    for (const cell of cells) if (cell.object) cell.object.visible = true;
    this.drawn = cells;
  }
}
