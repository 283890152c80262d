// A tileset in 3DTilesRendererJS, 3d-tiles.html?url=tileset.json: it morphs between levels; with &plain it does not.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {TilesRenderer} from '3d-tiles-renderer/three';
import {MorphPlugin} from 'lodestone-web/3d-tiles';

const asked = new URLSearchParams(location.search);
const renderer = new THREE.WebGLRenderer({canvas: document.getElementById('view'), antialias: true, alpha: true, preserveDrawingBuffer: true});
const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1);
const controls = new OrbitControls(camera, renderer.domElement);
scene.add(new THREE.HemisphereLight(0xffffff, 0x605850, 3));

const tiles = new TilesRenderer(asked.get('url') ?? 'tileset.json'), plugin = new MorphPlugin();
if (!asked.has('plain')) tiles.registerPlugin(plugin);
tiles.errorTarget = Number(asked.get('pixels') ?? 1);
tiles.setCamera(camera);
tiles.group.rotation.x = -Math.PI / 2;  // z up, as tiles are, to y up
scene.add(tiles.group);

let waiting = false;

function draw() {
  waiting = false;
  const {clientWidth, clientHeight} = document.body;
  renderer.setSize(clientWidth, clientHeight, false);
  camera.aspect = clientWidth / clientHeight;
  camera.updateProjectionMatrix();
  scene.updateMatrixWorld();
  camera.updateMatrixWorld();
  tiles.setResolutionFromRenderer(camera, renderer);
  tiles.update();
  renderer.render(scene, camera);
}

function wake() {
  if (!waiting) requestAnimationFrame(draw);
  waiting = true;
}

// The camera where it sees the whole model.
tiles.addEventListener('load-root-tileset', () => {
  const sphere = new THREE.Sphere();
  tiles.getBoundingSphere(sphere);
  tiles.group.updateMatrixWorld();
  const {center, radius} = sphere.applyMatrix4(tiles.group.matrixWorld), distance = 3.2 * radius * Math.max(innerHeight / innerWidth, 1);
  camera.position.copy(center).add(new THREE.Vector3(0.3, 0.3, 1).setLength(distance));
  Object.assign(camera, {near: distance / 1000, far: 10 * distance});
  controls.target.copy(center);
  controls.update();
});
tiles.addEventListener('needs-update', wake);
controls.addEventListener('change', wake);
addEventListener('resize', wake);
wake();

window.example = {renderer, scene, camera, controls, tiles, plugin, draw, wake};
