// The materials of tiles: their vertices travel to their parents' positions as d' grows. Both sides of a border between
// levels are at the coarser positions, so that nothing cracks, and at the instant of an exchange both levels are, so
// that nothing pops. Distances are computed by the operations of tileset.js and limits.js, lambda is selected and not
// clamped.
import * as THREE from 'three';
import {withSides, withoutLight} from './morph_material.js';

const declarations = `
uniform vec3 viewpoint;
uniform float bandBegin, bandEnd;
uniform highp sampler2D limitBoxes;
uniform ivec2 limitRange;
attribute vec3 parentPosition;
attribute vec3 parentNormal;
attribute vec2 parentUv;
attribute vec4 parentColor;
invariant gl_Position;
float limitedDistance() {
  vec3 a = abs(position - viewpoint);
  float d = sqrt((a.x * a.x + a.y * a.y) + a.z * a.z);
  for (int k = limitRange.x; k < limitRange.y; ++k) {
    vec4 low = texelFetch(limitBoxes, ivec2((2 * k) & 255, k >> 7), 0);
    vec4 high = texelFetch(limitBoxes, ivec2((2 * k + 1) & 255, k >> 7), 0);
    vec3 from = max(low.xyz - position, position - high.xyz);
    d = max(d, low.w - max(max(from.x, from.y), max(from.z, 0.0)));
  }
  return d;
}
float morphShare() {
  float d = limitedDistance();
  if (d < bandBegin) return 1.0;
  if (d >= bandEnd) return 0.0;
  return 1.0 - (d - bandBegin) / (bandEnd - bandBegin);
}
vec3 travelled(vec3 own, vec3 parent, float share) {
  return share >= 1.0 ? own : share <= 0.0 ? parent : share * own + (1.0 - share) * parent;
}
`;

export function tileMaterial(uniforms, {unlit = false, ...parameters}) {
  const material = new THREE.MeshStandardMaterial({roughness: 0.85, metalness: 0, side: THREE.DoubleSide, ...parameters});
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = declarations + shader.vertexShader
      .replace('#include <beginnormal_vertex>', 'float share = morphShare(); vec3 objectNormal = normalize(travelled(normal, parentNormal, share) + vec3(1e-20));')
      .replace('#include <begin_vertex>', 'vec3 transformed = travelled(position, parentPosition, share);')
      .replace('#include <uv_vertex>', `#include <uv_vertex>
        #ifdef USE_MAP
          vMapUv = mix(parentUv, MAP_UV, morphShare());
        #endif
        #ifdef USE_EMISSIVEMAP
          vEmissiveMapUv = mix(parentUv, EMISSIVEMAP_UV, morphShare());
        #endif`)
      .replace('#include <color_vertex>', `#include <color_vertex>
        #ifdef USE_COLOR_ALPHA
          vColor = mix(parentColor, color, morphShare());
        #endif`);
    shader.fragmentShader = withSides(unlit ? withoutLight(shader.fragmentShader) : shader.fragmentShader);
  };
  material.customProgramCacheKey = () => (unlit ? 'tiles, unlit' : 'tiles');
  return material;
}

// A shader without light that counts surfaces (cracks.js): red for fronts, green for backs.
export const countingTileMaterial = (uniforms) => new THREE.ShaderMaterial({
  uniforms,
  vertexShader: `${declarations} void main() {
    gl_Position = projectionMatrix * (modelViewMatrix * vec4(travelled(position, parentPosition, morphShare()), 1.0)); }`,
  fragmentShader: 'void main() { gl_FragColor = gl_FrontFacing ? vec4(1.0 / 255.0, 0, 0, 0) : vec4(0, 1.0 / 255.0, 0, 0); }',
  side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true, blending: THREE.CustomBlending,
  blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor, blendSrcAlpha: THREE.OneFactor, blendDstAlpha: THREE.OneFactor});

// The limits of all cells of a frame, those of a cell one after the other: two texels each, low corner and radius, high
// corner. 128 of them in a row.
export class LimitTexture {
  constructor() {
    this.uniform = {value: null};
    this.resize(1);
  }

  resize(rows) {
    this.uniform.value?.dispose();
    this.rows = rows;
    this.data = new Float32Array(1024 * rows);
    this.uniform.value = new THREE.DataTexture(this.data, 256, rows, THREE.RGBAFormat, THREE.FloatType);
  }

  // `lists`: [range, limits], the range (a vector of two) is set.
  fill(lists) {
    const count = lists.reduce((sum, [, limits]) => sum + limits.length, 0), rows = Math.ceil(count / 128);
    if (rows > this.rows) this.resize(2 ** Math.ceil(Math.log2(rows)));
    let at = 0;
    for (const [range, limits] of lists) {
      range.set(at, at + limits.length);
      for (const {box, radius} of limits) {
        this.data.set([box[0], box[1], box[2], radius, box[3], box[4], box[5], 0], 8 * at);
        ++at;
      }
    }
    if (count > 0) this.uniform.value.needsUpdate = true;
  }
}
