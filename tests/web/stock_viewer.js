// three.js as it comes, without a line of the page: what other viewers show of a file.
import * as THREE from 'three';
import {GLTFLoader} from 'three/examples/jsm/loaders/GLTFLoader.js';
import {MeshoptDecoder} from 'three/examples/jsm/libs/meshopt_decoder.module.js';

const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);

// Numbers of vertices and triangles of a file, by GLTFLoader.
window.stockCounts = async (url) => {
  const {scene} = await loader.loadAsync(url);
  let vertices = 0, triangles = 0, textures = 0;
  const seen = new Set();
  scene.traverse(({geometry, material}) => {
    if (!geometry) return;
    triangles += geometry.index.count / 3;
    if (!seen.has(geometry.attributes.position)) vertices += geometry.attributes.position.count;
    seen.add(geometry.attributes.position);
    textures += material.map ? 1 : 0;
  });
  return {vertices, triangles, textures};
};

// The picture of a file, as the page lights it, from the page's camera: its geometry in the place of the model.
window.stockPicture = async (url, model, camera) => {
  const {scene: loaded} = await loader.loadAsync(url), scene = new THREE.Scene(), {width, height} = camera;
  const renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
  renderer.setSize(width, height, false);
  const lens = new THREE.PerspectiveCamera(camera.fov, width / height, camera.near, camera.far);
  lens.position.fromArray(camera.position);
  lens.quaternion.fromArray(camera.quaternion);
  const head = new THREE.DirectionalLight(0xffffff, 2.2);
  head.position.copy(lens.position);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x605850, 1.3), head);
  loaded.updateMatrixWorld(true);
  loaded.traverse((o) => {
    if (!o.isMesh) return;
    const parameters = {roughness: 0.85, metalness: 0, side: THREE.DoubleSide, color: new THREE.Color(...model.colour), map: o.material.map};
    if (parameters.map) parameters.map.anisotropy = renderer.capabilities.getMaxAnisotropy();
    const mesh = new THREE.Mesh(o.geometry, new THREE.MeshStandardMaterial(parameters));
    // World to the page's unit cube, then to where the page has it.
    mesh.matrixAutoUpdate = false;
    mesh.matrix.makeScale(1 / model.scale, 1 / model.scale, 1 / model.scale).setPosition(...model.origin.map((x, i) => model.place[i] - x / model.scale));
    mesh.matrix.multiply(o.matrixWorld);
    mesh.frustumCulled = false;
    scene.add(mesh);
  });
  renderer.render(scene, lens);
  const gl = renderer.getContext(), out = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  renderer.dispose();
  return out;
};
