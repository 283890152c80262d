// A scene with one model, index.html?url=model.lpm: it streams, refines as the camera comes closer, and is drawn only
// when something changes.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {load} from 'lodestone-web';

const renderer = new THREE.WebGLRenderer({canvas: document.getElementById('view'), antialias: true, alpha: true});
const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1);
const controls = new OrbitControls(camera, renderer.domElement);
scene.add(new THREE.HemisphereLight(0xffffff, 0x605850, 3));

let model = null, waiting = false;

function draw() {
  waiting = false;
  const {clientWidth, clientHeight} = document.body;
  renderer.setSize(clientWidth, clientHeight, false);
  camera.aspect = clientWidth / clientHeight;
  camera.updateProjectionMatrix();
  const moves = model?.update(camera, renderer.domElement.height);
  renderer.render(scene, camera);
  if (moves) wake();
}

function wake() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(draw);
}

// The camera where it sees the whole box.
function look(box) {
  const {center, radius} = box.getBoundingSphere(new THREE.Sphere()), distance = 3.2 * radius * Math.max(innerHeight / innerWidth, 1);
  camera.position.copy(center).add(new THREE.Vector3(0.3, 0.3, 1).setLength(distance));
  Object.assign(camera, {near: distance / 1000, far: 10 * distance});
  controls.target.copy(center);
  controls.update();
}

controls.addEventListener('change', wake);
addEventListener('resize', wake);
model = await load(new URLSearchParams(location.search).get('url') ?? 'model.lpm', {onChange: wake});
const upright = new THREE.Group().add(model.object);  // three.js has y up
upright.quaternion.setFromUnitVectors(model.up, camera.up);
upright.updateMatrix();
scene.add(upright);
look(model.box.applyMatrix4(upright.matrix));
wake();

window.example = {renderer, scene, camera, controls, get model() { return model; }, wake, get rests() { return !waiting && model.arrived === null; }};
