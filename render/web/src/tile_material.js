// The materials of tiles: their vertices travel to their parents' positions as d' grows. Both sides of a border between
// levels are at the coarser positions, so that nothing cracks, and at the instant of an exchange both levels are, so
// that nothing pops. Distances are computed by the operations of tileset.js and limits.js, lambda is selected and not
// clamped.
import * as THREE from 'three';
import {look, withLook} from './look.js';
import {placeMaps, withSides} from './morph_material.js';

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

// In place of what three's vertex shaders read of a vertex; the declarations above read it as it is.
const morph = `
vec3 morphedPosition, morphedNormal;
vec2 morphedUv;
#if defined(USE_COLOR_ALPHA)
  vec4 morphedColor;
#elif defined(USE_COLOR)
  vec3 morphedColor;
#endif
void morphVertex() {
  float share = morphShare();
  morphedPosition = travelled(position, parentPosition, share);
  morphedNormal = normalize(travelled(normal, parentNormal, share) + vec3(1e-20));
  morphedUv = mix(parentUv, uv, share);
  #if defined(USE_COLOR_ALPHA)
    morphedColor = mix(parentColor, color, share);
  #elif defined(USE_COLOR)
    morphedColor = mix(parentColor.rgb, color, share);
  #endif
}
#define position morphedPosition
#define normal morphedNormal
#define uv morphedUv
#define color morphedColor
`;

// Makes the vertices of any material of three travel. `uniforms`: viewpoint, bandBegin and bandEnd, limitBoxes, limitRange.
export function morphTiles(material, uniforms) {
  const {onBeforeCompile} = material, key = material.customProgramCacheKey();
  material.onBeforeCompile = (shader, renderer) => {
    onBeforeCompile.call(material, shader, renderer);
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = declarations + morph + shader.vertexShader.replace('void main() {', 'void main() { morphVertex();');
  };
  material.customProgramCacheKey = () => `${key}, tiles`;
  return material;
}

export function tileMaterial(uniforms, {surface = null, ...parameters}) {
  const unlit = surface?.unlit ?? false;
  const material = new THREE.MeshStandardMaterial({roughness: 0.85, metalness: 0, side: THREE.DoubleSide, ...parameters});
  material.onBeforeCompile = (shader) => {
    shader.uniforms.look = look;
    placeMaps(shader, surface);
    shader.fragmentShader = withSides(withLook(shader.fragmentShader, unlit));
  };
  material.customProgramCacheKey = () => (unlit ? 'unlit' : 'lit');
  return morphTiles(material, uniforms);
}

// A shader without light that counts surfaces (cracks.js): red for fronts, green for backs.
export const countingTileMaterial = (uniforms) => new THREE.ShaderMaterial({
  uniforms,
  vertexShader: `${declarations} void main() {
    gl_Position = projectionMatrix * (modelViewMatrix * vec4(travelled(position, parentPosition, morphShare()), 1.0)); }`,
  fragmentShader: 'void main() { gl_FragColor = gl_FrontFacing ? vec4(1.0 / 255.0, 0, 0, 0) : vec4(0, 1.0 / 255.0, 0, 0); }',
  side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true, blending: THREE.CustomBlending,
  blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor, blendSrcAlpha: THREE.OneFactor, blendDstAlpha: THREE.OneFactor});

const FAR = 3e38;  // for shaders, which need not know infinity

// The bands of the levels, as uniforms.
export const makeBands = (count) => Array.from({length: count}, () => ({bandBegin: {value: 0}, bandEnd: {value: FAR}}));
export const setBands = (bands, {begin, end}) => bands.forEach((u, l) => {
  u.bandBegin.value = Math.min(begin[l], FAR);
  u.bandEnd.value = Math.min(end[l], FAR);
});

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
