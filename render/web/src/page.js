// The page: models side by side, levels by slider or by pixels, files dropped on it.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {countCracks} from './cracks.js';
import {readProgressiveGlb} from './glb.js';
import {LpmDecoder} from './lpm.js';
import {ProgressiveView} from './progressive_view.js';
import {TilesView} from './tiles_view.js';
import {loadTileset} from './tileset.js';

const $ = (id) => document.getElementById(id);
const ask = async (url, signal) => {
  const answer = await fetch(url, {signal});
  if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
  return answer;
};

const isGlb = (bytes) => String.fromCharCode(...bytes.subarray(0, 4)) === 'glTF';

class Page {
  constructor() {
    this.renderer = new THREE.WebGLRenderer({canvas: $('view'), antialias: true, preserveDrawingBuffer: true});
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0x20242a);
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
    this.head = new THREE.DirectionalLight(0xffffff, 2.2);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x605850, 1.3), this.head);
    this.controls = new OrbitControls(this.camera, $('view'));
    this.controls.addEventListener('change', () => this.wake());
    this.models = [];
    this.awake = false;
    this.listen();
    this.resize();
    $('view').tabIndex = 0;
  }

  get automatic() { return $('automatic').checked; }
  get pixels() { return Number($('pixels').value); }
  // Of tiles in memory, each model: ?megabytes=N in the address, or what such a machine can spare.
  get megabytes() {
    return Number(new URLSearchParams(location.search).get('megabytes')) || ((navigator.deviceMemory ?? 8) < 8 ? 192 : 512);
  }
  get slider() { return Number($('level').value) / 1000; }

  listen() {
    addEventListener('resize', () => this.resize());
    addEventListener('dragover', (e) => e.preventDefault());
    addEventListener('drop', (e) => {
      e.preventDefault();
      for (const file of e.dataTransfer.files) this.openFile(file).catch((x) => this.say(x.message));
    });
    addEventListener('keydown', (e) => this.key(e));
    $('file').addEventListener('change', (e) => {
      for (const file of e.target.files) this.openFile(file).catch((x) => this.say(x.message));
    });
    $('level').addEventListener('input', () => {
      $('automatic').checked = false;
      this.applySlider();
    });
    $('automatic').addEventListener('change', () => this.wake());
    $('pixels').addEventListener('input', () => this.wake());
    $('wireframe').addEventListener('change', () => this.applyWireframe());
    $('home').addEventListener('click', () => this.frameAll());
  }

  key(e) {
    if (e.target.type === 'number') return;
    const step = e.shiftKey ? 0.1 : 0.02;
    const keys = {
      ArrowRight: () => this.setSlider(this.slider + step), ArrowLeft: () => this.setSlider(this.slider - step),
      w: () => { $('wireframe').checked = !$('wireframe').checked; this.applyWireframe(); },
      a: () => { $('automatic').checked = !$('automatic').checked; this.wake(); },
      h: () => this.frameAll()};
    if (e.target.type === 'range' && e.key.startsWith('Arrow')) return;
    keys[e.key]?.();
  }

  setSlider(share) {
    $('level').value = Math.round(1000 * Math.min(Math.max(share, 0), 1));
    $('automatic').checked = false;
    this.applySlider();
  }

  applySlider() {
    for (const m of this.models) if (m.ladder) m.show(this.slider * m.ladder.top);
    this.wake();
  }

  applyWireframe() {
    for (const m of this.models) m.setWireframe($('wireframe').checked);
    this.wake();
  }

  say(text) {
    $('message').textContent = text;
    $('message').hidden = text === '';
  }

  async openFile(file) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    await this.openBytes(bytes, file.name);
  }

  async openBytes(bytes, name) {
    const view = new ProgressiveView(name, this.renderer.capabilities.getMaxAnisotropy());
    if (isGlb(bytes)) {
      await view.setMesh(await readProgressiveGlb(bytes, name));
    } else {
      const decoder = new LpmDecoder(name);
      decoder.push(bytes);
      if (!decoder.complete) throw new Error(`${name}: the file ends early`);
      await view.setMesh(decoder.mesh());
    }
    this.add(view);
  }

  // As it arrives: what there is of it is drawn.
  async openUrl(url, name) {
    const answer = await ask(url);
    if (url.toLowerCase().endsWith('.glb')) return this.openBytes(new Uint8Array(await answer.arrayBuffer()), name);
    const view = new ProgressiveView(name, this.renderer.capabilities.getMaxAnisotropy());
    const decoder = new LpmDecoder(name), reader = answer.body.getReader();
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      if (!decoder.push(part.value)) continue;
      await view.setMesh(decoder.mesh());
      if (!this.models.includes(view)) this.add(view);
      view.arrived = decoder.complete ? 1 : decoder.groups / decoder.header.groups * 0.99;
      if (!this.automatic) view.show(this.slider * view.ladder.top);
      this.wake();
      await new Promise((next) => setTimeout(next));
    }
    if (!decoder.complete) throw new Error(`${name}: the file ends early`);
  }

  async openTiles(url, name) {
    const json = async (at) => (await ask(at)).json();
    const tileset = await loadTileset(new URL(url, location.href).href, json);
    const view = new TilesView(name, tileset, this.renderer.capabilities.getMaxAnisotropy(),
                               {request: async (at, signal) => (await ask(at, signal)).arrayBuffer(),
                                say: (e) => this.say(e.message), budget: 2 ** 20 * this.megabytes});
    await view.start();
    this.add(view);
  }

  add(view) {
    this.models.push(view);
    this.scene.add(view.node);
    view.setWireframe($('wireframe').checked);
    this.layOut();
    this.frameAll();
    this.say('');
  }

  // Side by side, each a unit wide at most.
  layOut() {
    this.models.forEach((m, k) => {
      const middle = m.box.getCenter(new THREE.Vector3());
      m.node.position.set(1.15 * k - middle.x, -middle.y, -middle.z);
      m.node.updateMatrixWorld(true);
    });
  }

  frameAll() {
    const box = new THREE.Box3();
    for (const m of this.models) box.union(m.box.clone().applyMatrix4(m.node.matrixWorld));
    if (box.isEmpty()) return;
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    const half = THREE.MathUtils.degToRad(this.camera.fov) / 2;
    const distance = sphere.radius / Math.sin(Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect)));
    this.camera.position.copy(sphere.center).add(new THREE.Vector3(0.25, 0.2, 1).normalize().multiplyScalar(1.05 * distance));
    this.camera.near = distance / 1000;
    this.camera.far = distance * 100;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(sphere.center);
    this.controls.update();
    this.wake();
  }

  resize() {
    const {clientWidth: w, clientHeight: h} = $('view');
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / Math.max(h, 1);
    this.camera.updateProjectionMatrix();
    this.wake();
  }

  // Frames are drawn while something changes, and not otherwise.
  wake() {
    if (this.awake) return;
    this.awake = true;
    this.last = performance.now();
    requestAnimationFrame((t) => this.frame(t));
  }

  frame(time) {
    const seconds = Math.min(Math.max(time - this.last, 1) / 1000, 0.1);
    this.last = time;
    const height = this.renderer.domElement.height;
    let moving = false;
    for (const m of this.models)
      if (this.automatic || m instanceof TilesView) moving = m.approach(this.camera, height, this.pixels, seconds) || moving;
    if (this.automatic) this.followSlider();
    this.head.position.copy(this.camera.position);
    this.renderer.render(this.scene, this.camera);
    this.report();
    if (moving) requestAnimationFrame((t) => this.frame(t));
    else this.awake = false;
  }

  followSlider() {
    const first = this.models.find((m) => m.ladder);
    if (first) $('level').value = Math.round(1000 * first.place / Math.max(first.ladder.top, 1));
  }

  report() {
    const sum = this.models.reduce((n, m) => n + m.triangleCount, 0);
    $('count').textContent = `${sum.toLocaleString('en')} triangles`;
    $('models').textContent = this.models.map((m) => `${m.name}: ${m.triangleCount.toLocaleString('en')}` +
      (m.arrived !== undefined && m.arrived < 1 ? ` (${Math.floor(100 * m.arrived)} % here)` : '')).join(' · ');
  }

  cracks() {
    return countCracks(this.renderer, this.scene, this.camera, this.models.flatMap((m) => m.objects));
  }
}

const page = new Page();
window.lodestone = page;  // for tests and the console

async function start() {
  const list = await (await ask('models.json')).json();
  for (const {name, url, kind} of list)
    await (kind === 'tiles' ? page.openTiles(url, name) : page.openUrl(url, name));
}
start().then(() => { page.ready = true; }, (e) => { page.say(e.message); page.ready = true; });
