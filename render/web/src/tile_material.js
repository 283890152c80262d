// The materials of tiles: their vertices travel to their parents' positions as d' grows. Both sides of a border between
// levels are at the coarser positions, so that nothing cracks, and at the instant of an exchange both levels are, so
// that nothing pops. Vertices look their lambda up by signature, or where tiles have none find it by their distance,
// computed by the operations of tileset.js and limits.js; it is selected and not clamped.
import * as THREE from 'three';
import {look, withLook} from './look.js';
import {placeMaps, withSides} from './morph_material.js';

const bySignature = `
uniform highp sampler2D lambdas;
uniform int firstLambda;
attribute float signature;
float morphShare() {
  int k = firstLambda + int(signature);
  return texelFetch(lambdas, ivec2(k & 255, k >> 8), 0).x;
}
`;

const byDistance = `
uniform vec3 viewpoint;
uniform float bandBegin, bandEnd;
uniform highp sampler2D limitBoxes;
uniform ivec2 limitRange;
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
`;

const declarations = (uniforms) => `
attribute vec3 parentPosition;
attribute vec3 parentNormal;
attribute vec2 parentUv;
attribute vec4 parentColor;
invariant gl_Position;
${uniforms.lambdas ? bySignature : byDistance}
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

// Makes the vertices of any material of three travel. `uniforms`: those of a motion (tile_motion.js).
export function morphTiles(material, uniforms) {
  const {onBeforeCompile} = material, key = material.customProgramCacheKey();
  material.onBeforeCompile = (shader, renderer) => {
    onBeforeCompile.call(material, shader, renderer);
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = declarations(uniforms) + morph + shader.vertexShader.replace('void main() {', 'void main() { morphVertex();');
  };
  material.customProgramCacheKey = () => `${key}, tiles ${uniforms.lambdas ? 'by signature' : 'by distance'}`;
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
  vertexShader: `${declarations(uniforms)} void main() {
    gl_Position = projectionMatrix * (modelViewMatrix * vec4(travelled(position, parentPosition, morphShare()), 1.0)); }`,
  fragmentShader: 'void main() { gl_FragColor = gl_FrontFacing ? vec4(1.0 / 255.0, 0, 0, 0) : vec4(0, 1.0 / 255.0, 0, 0); }',
  side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true, blending: THREE.CustomBlending,
  blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor, blendSrcAlpha: THREE.OneFactor, blendDstAlpha: THREE.OneFactor});
