// What is drawn of a surface: as light falls on it, its colours alone, or its normals; and the edges of its triangles.
import * as THREE from 'three';

export const LOOKS = ['light', 'colours', 'normals'];
export const look = {value: 0};  // of everything on the page

// The standard material of three with these looks; `unlit`: its colours are what light gives.
export const withLook = (source, unlit) => `uniform int look;\n${source.replace(
  'vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;',
  `vec3 outgoingLight = ${unlit ? 'diffuseColor.rgb' : 'totalDiffuse + totalSpecular + totalEmissiveRadiance'};
   if (look == 1) outgoingLight = diffuseColor.rgb;
   if (look == 2) outgoingLight = pow(normalize(normal) * 0.5 + 0.5, vec3(2.2));  // what is written is encoded`)}`;

// Lines over the surface of an object, by the vertex shader that counts cracks; not visible yet.
export function edgesOver(object) {
  const {uniforms, vertexShader} = object.userData.counting;
  const material = new THREE.ShaderMaterial({uniforms, vertexShader, fragmentShader: 'void main() { gl_FragColor = vec4(0.02, 0.05, 0.12, 0.55); }',
                                             wireframe: true, transparent: true, depthWrite: false});
  const edges = Object.assign(new THREE.Mesh(object.geometry, material), {frustumCulled: false, visible: false});
  object.userData.edges = edges;
  object.add(edges);
}

// The surface is drawn a little farther away, so that its edges are in front of it.
export function showEdges(object, on) {
  Object.assign(object.userData.edges, {visible: on, geometry: object.geometry});
  for (const m of object.material) Object.assign(m, {polygonOffset: on, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
}
