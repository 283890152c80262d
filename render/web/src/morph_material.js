// Materials whose vertices travel: three's standard material with a few lines of its vertex shader replaced.
import * as THREE from 'three';
import {look, withLook} from './look.js';

// `share`: 0 at the ancestors, 1 at their own places.
export function morphMaterial(parameters, share, surface = null) {
  const unlit = surface?.unlit ?? false;
  const material = new THREE.MeshStandardMaterial({roughness: 0.85, metalness: 0, side: THREE.DoubleSide, ...parameters});
  material.onBeforeCompile = (shader) => {
    shader.uniforms.morphShare = share;
    shader.vertexShader = withMorph(shader.vertexShader);
    placeMaps(shader, surface);
    shader.uniforms.look = look;
    shader.fragmentShader = withSides(withLook(shader.fragmentShader, unlit));
  };
  material.customProgramCacheKey = () => (unlit ? 'progressive, unlit' : 'progressive');
  return material;
}

const declarations = `
uniform float morphShare;
attribute vec3 fromPosition;
attribute vec3 fromNormal;
attribute vec2 fromUv;
invariant gl_Position;
`;

// The sum of two products, or exactly one end: a vertex at its ancestor's position has exactly that position.
const between = (from, to) =>
    `(morphShare >= 1.0 ? ${to} : morphShare <= 0.0 ? ${from} : morphShare * ${to} + (1.0 - morphShare) * ${from})`;

export function withMorph(source) {
  return declarations + source
    .replace('#include <uv_vertex>', `#include <uv_vertex>
      #ifdef USE_MAP
        vMapUv = (mapTransform * vec3(${between('fromUv', 'MAP_UV')}, 1)).xy;
      #endif
      #ifdef USE_NORMALMAP
        vNormalMapUv = (normalMapTransform * vec3(${between('fromUv', 'NORMALMAP_UV')}, 1)).xy;
      #endif
      #ifdef USE_EMISSIVEMAP
        vEmissiveMapUv = (emissiveMapTransform * vec3(${between('fromUv', 'EMISSIVEMAP_UV')}, 1)).xy;
      #endif`)
    .replace('#include <beginnormal_vertex>', `vec3 objectNormal = normalize(${between('fromNormal', 'normal')} + vec3(1e-20));`)
    .replace('#include <begin_vertex>', `vec3 transformed = ${between('fromPosition', 'position')};`);
}

// Puts maps where the surface has them; those of three have no transforms of their own here, so that images are shared.
export function placeMaps(shader, surface) {
  const matrix = (rows = [1, 0, 0, 0, 1, 0, 0, 0, 1]) => ({value: new THREE.Matrix3().set(...rows)});
  Object.assign(shader.uniforms, {normalPlace: matrix(surface?.normalPlace), emissivePlace: matrix(surface?.emissivePlace)});
  shader.vertexShader = `uniform mat3 normalPlace, emissivePlace;\n${shader.vertexShader.replace('#include <color_vertex>', `
    #ifdef USE_NORMALMAP
      vNormalMapUv = (normalPlace * vec3(vNormalMapUv, 1)).xy;
    #endif
    #ifdef USE_EMISSIVEMAP
      vEmissiveMapUv = (emissivePlace * vec3(vEmissiveMapUv, 1)).xy;
    #endif
    #include <color_vertex>`)}`;
}

const wraps = {repeat: THREE.RepeatWrapping, clamp: THREE.ClampToEdgeWrapping, mirror: THREE.MirroredRepeatWrapping};
// The properties of a texture, under the names that image() of glb.js gives them.
export const wrapping = ([u, v]) => ({wrapS: wraps[u], wrapT: wraps[v]});

// Parameters of three's standard material for a surface (surface.js). A material without one is drawn from both sides.
export function surfaceParameters(colour, surface) {
  if (!surface) return {side: THREE.DoubleSide};
  const blended = surface.alphaMode === 'BLEND', masked = surface.alphaMode === 'MASK';
  const light = surface.unlit ? [0, 0, 0] : surface.emissive;
  return {side: surface.doubleSided ? THREE.DoubleSide : THREE.FrontSide, transparent: blended, depthWrite: !blended,
          alphaTest: masked ? surface.alphaCutoff : 0, opacity: blended || masked ? colour[3] : 1,
          emissive: new THREE.Color(...light), emissiveIntensity: surface.emissiveStrength};
}

// A back side is lit from behind only if its normal, too, points away: slivers that have folded over remain as bright
// as their surroundings, and the inside of an open surface is not black.
export function withSides(source) {
  return source.replace('#include <normal_fragment_begin>', THREE.ShaderChunk.normal_fragment_begin.replace(
    'gl_FrontFacing ? 1.0 : - 1.0', 'gl_FrontFacing || dot(vNormal, vViewPosition) > 0.0 ? 1.0 : - 1.0'));
}

// A shader without light that counts surfaces (cracks.js): red for fronts, green for backs.
export function countingMaterial(share) {
  return new THREE.ShaderMaterial({
    uniforms: {morphShare: share},
    vertexShader: `${declarations}
      void main() { gl_Position = projectionMatrix * (modelViewMatrix * vec4(${between('fromPosition', 'position')}, 1.0)); }`,
    fragmentShader: 'void main() { gl_FragColor = gl_FrontFacing ? vec4(1.0 / 255.0, 0, 0, 0) : vec4(0, 1.0 / 255.0, 0, 0); }',
    side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true,
    blending: THREE.CustomBlending, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
    blendSrcAlpha: THREE.OneFactor, blendDstAlpha: THREE.OneFactor});
}
