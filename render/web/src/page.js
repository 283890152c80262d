// The page: models side by side, levels by slider or by pixels, files dropped on it.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {countCracks} from './cracks.js';
import {ask, readMesh, streamMesh} from './files.js';
import {LOOKS, look} from './look.js';
import {Labels, columnsFor, layOut} from './layout.js';
import {ProgressiveView} from './progressive_view.js';
import {fromHash, toHash} from './shared_view.js';
import {openTiles} from './tiles_view.js';
import {standUp, turnOver} from './turn.js';

const $ = (id) => document.getElementById(id);

// The nearest view, in units of a model's size: float32 shows no more of it.
const NEAREST = 1e-4;

class Page {
  constructor() {
    this.renderer = new THREE.WebGLRenderer({canvas: $('view'), antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
    this.head = new THREE.DirectionalLight(0xffffff, 2.2);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x605850, 1.3), this.head);
    this.controls = new OrbitControls(this.camera, $('view'));
    this.controls.addEventListener('change', () => this.wake());
    this.models = [];
    this.labels = new Labels($('labels'), (m) => this.turn(m));
    this.awake = false;
    this.byItself = $('automatic').checked = matchMedia('(pointer: coarse)').matches;  // phones: no more triangles than their pixels ask for
    this.listen();
    this.resize();
  }

  get automatic() { return $('automatic').checked; }
  // Never nothing, whatever is typed.
  get pixels() { return Math.min(Math.max(Number($('pixels').value) || 0.5, 0.1), 100); }
  get slider() { return Number($('level').value) / 1000; }
  // Memory for the tiles of each model: ?megabytes=N in the address, or a default for the kind of machine.
  get megabytes() {
    return Number(new URLSearchParams(location.search).get('megabytes')) || ((navigator.deviceMemory ?? 8) < 8 ? 192 : 512);
  }

  listen() {
    new ResizeObserver(() => this.resize()).observe($('stage'));
    addEventListener('dragover', (e) => {
      e.preventDefault();
      $('stage').classList.add('dropping');
    });
    addEventListener('dragleave', (e) => { if (e.relatedTarget === null) $('stage').classList.remove('dropping'); });
    addEventListener('drop', (e) => {
      e.preventDefault();
      $('stage').classList.remove('dropping');
      this.openFiles(e.dataTransfer.files);
    });
    addEventListener('keydown', (e) => this.key(e));
    $('file').addEventListener('change', (e) => this.openFiles(e.target.files));
    $('level').addEventListener('input', () => {
      $('automatic').checked = false;
      this.applySlider();
    });
    $('automatic').addEventListener('change', () => this.wake());
    $('pixels').addEventListener('input', () => this.wake());
    $('edges').addEventListener('change', () => this.applyLook());
    $('look').addEventListener('change', () => this.applyLook());
    $('view').addEventListener('dblclick', (e) => this.focus(e));
    addEventListener('hashchange', () => this.follow(location.hash));
    $('home').addEventListener('click', () => this.showAll());
    this.controls.addEventListener('start', () => { this.asked = null; });
    // Before the controls, which turn wheel and pinch into distances from the target.
    $('view').addEventListener('wheel', () => this.aim(), {capture: true, passive: true});
    for (const type of ['pointerdown', 'pointermove']) $('view').addEventListener(type, (e) => { if (!e.isPrimary) this.aim(); }, {capture: true});
    $('full').addEventListener('click', () => this.toggleFullScreen());
    $('keys').addEventListener('click', () => $('help').showModal());
    $('full').hidden = !document.fullscreenEnabled;
    $('dismiss').addEventListener('click', () => this.say(''));
    $('view').addEventListener('webglcontextlost', () => this.say('The browser has taken the graphics memory away; reload the page.'));
  }

  key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey || /^(number|select-one)$/.test(e.target.type) || $('help').open) return;
    if (e.target.type === 'range' && /^(Arrow|Page|Home|End)/.test(e.key)) return;
    const turn = (x, y) => () => (e.shiftKey ? this.orbit(0.1 * x, 0.1 * y) : x !== 0 && this.setSlider(this.slider + 0.02 * x));
    const keys = {
      ArrowRight: turn(1, 0), ArrowLeft: turn(-1, 0), ArrowUp: turn(0, -1), ArrowDown: turn(0, 1),
      PageUp: () => this.setSlider(this.slider + 0.1), PageDown: () => this.setSlider(this.slider - 0.1),
      Home: () => this.setSlider(0), End: () => this.setSlider(1),
      '+': () => this.orbit(0, 0, 0.9), '-': () => this.orbit(0, 0, 1 / 0.9),
      e: () => { $('edges').checked = !$('edges').checked; this.applyLook(); },
      v: () => { $('look').selectedIndex = ($('look').selectedIndex + 1) % LOOKS.length; this.applyLook(); },
      a: () => { $('automatic').checked = !$('automatic').checked; this.wake(); },
      h: () => this.showAll(), f: () => this.toggleFullScreen(), '?': () => $('help').showModal()};
    keys[e.key.length === 1 ? e.key.toLowerCase() : e.key]?.();
  }

  toggleFullScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else document.documentElement.requestFullscreen?.().catch(() => this.say('The browser does not show this page on the full screen.'));
  }

  // Turns the camera around its target by angles, and scales the distance.
  orbit(around, over, nearer = 1) {
    this.asked = null;
    if (nearer !== 1) this.aim();
    const {target} = this.controls, way = new THREE.Spherical().setFromVector3(this.camera.position.clone().sub(target));
    way.theta += around;
    way.phi += over;
    way.radius = Math.min(Math.max(way.radius * nearer, this.controls.minDistance), this.controls.maxDistance);
    this.camera.position.setFromSpherical(way.makeSafe()).add(target);
    this.controls.update();
    this.wake();
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

  applyLook() {
    look.value = LOOKS.indexOf($('look').value);
    for (const m of this.models) m.setEdges($('edges').checked);
    this.wake();
  }

  // The surface at a point of the picture, x and y from -1 to 1.
  surfaceAt(x, y) {
    const ray = new THREE.Raycaster();
    this.camera.updateMatrixWorld();
    ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return ray.intersectObjects(this.models.flatMap((m) => m.objects.filter((o) => o.visible)), false)[0];
  }

  // Moves the target along the view to the surface there, which changes no picture, unless their distances are alike:
  // a zoom ends at the surface, and neither before it, where the target was, nor in the model. While one goes on, the
  // surface is looked for now and then.
  aim() {
    const {position} = this.camera, {target} = this.controls, ahead = target.clone().sub(position), now = performance.now();
    if (!this.aimed || now - this.aimed.time > 200 || this.aimed.ahead.angleTo(ahead) > 1e-3)
      this.aimed = {point: this.surfaceAt(0, 0)?.point ?? null, ahead, time: now};
    if (this.aimed.point === null) return;
    const ratio = this.aimed.point.clone().sub(position).dot(ahead) / ahead.lengthSq();
    if (ratio > 0 && (ratio < 0.5 || ratio > 2)) target.copy(position).addScaledVector(ahead, ratio);
  }

  // Turns around what is under the pointer from now on, and brings it closer.
  focus(e) {
    const {left, top, width, height} = $('view').getBoundingClientRect();
    const hit = this.surfaceAt((e.clientX - left) / width * 2 - 1, 1 - (e.clientY - top) / height * 2);
    if (!hit) return;
    this.asked = null;
    const {target} = this.controls, back = this.camera.position.clone().sub(target);
    back.setLength(Math.max(Math.min(back.length(), hit.distance) / 2, this.controls.minDistance));
    target.copy(hit.point);
    this.camera.position.copy(hit.point).add(back);
    this.controls.update();
    this.wake();
  }

  // The view that an address tells; its camera waits until all models are there.
  follow(hash) {
    if (hash === this.hash) return;
    const view = fromHash(hash, LOOKS);
    $('look').value = view.look;
    $('edges').checked = view.edges;
    if (view.pixels !== null) $('pixels').value = view.pixels;
    if (view.pixels !== null || view.level !== null) $('automatic').checked = view.pixels !== null;
    if (view.level !== null) $('level').value = Math.round(1000 * view.level);
    this.asked = view.camera;
    this.applyLook();
    if (view.level !== null) this.applySlider();
    if (this.models.length > 0) this.frameAll();
  }

  // What differs from the view by itself goes into the address.
  tell() {
    const {automatic, byItself} = this, camera = this.asked ?? (this.atHome ? null : this.pose());
    const level = !automatic && (this.slider < 1 || byItself) ? this.slider : null;
    const pixels = automatic && !(byItself && this.pixels === 0.5) ? this.pixels : null;
    const hash = toHash({camera, level, pixels, look: $('look').value, edges: $('edges').checked});
    if (hash === (this.hash ?? '').slice(1)) return;
    this.hash = hash === '' ? '' : `#${hash}`;
    history.replaceState(null, '', this.hash || location.pathname + location.search);
  }

  get atHome() { return !this.home || this.pose().flat().every((x, k) => Math.abs(x - this.home[k]) < 1e-6); }
  pose() { return [this.camera.position.toArray(), this.controls.target.toArray()]; }

  // One line about what went wrong; more of them below each other.
  say(text) {
    const lines = text === '' || $('message').hidden ? [] : $('text').textContent.split('\n');
    if (!lines.includes(text)) lines.push(text);
    $('text').textContent = lines.slice(-4).join('\n');
    $('message').hidden = text === '';
    $('hint').hidden = this.models.length > 0 || text !== '';
  }

  openFiles(files) {
    this.say('');
    for (const file of files) this.openFile(file).catch((e) => this.say(e.message));
  }

  async openFile(file) {
    const view = this.makeProgressive(file.name);
    await view.setMesh(await readMesh(new Uint8Array(await file.arrayBuffer()), file.name));
    this.add(view, this.models.length);
  }

  makeProgressive(name) { return new ProgressiveView(name, this.renderer.capabilities.getMaxAnisotropy()); }

  // Draws the file as it arrives: the part received so far, refined by later parts.
  async openUrl(url, name, order) {
    const view = this.makeProgressive(name);
    const count = (bytes, all) => {
      view.arrived = {bytes, all};
      this.report();
    };
    const show = async (mesh) => {
      await view.setMesh(mesh);
      if (!this.models.includes(view)) this.add(view, order);
      else if (this.asked || this.atHome) this.frameAll();  // a finer part can be larger
      else this.wake();
    };
    await streamMesh(url, name, {show, count});
    view.arrived = null;
    this.report();
  }

  async openTiles(url, name, order) {
    const anisotropy = this.renderer.capabilities.getMaxAnisotropy(), budget = Math.floor(2 ** 20 * this.megabytes);
    this.add(await openTiles(url, name, {anisotropy, budget, say: (e) => this.say(e.message)}), order);
  }

  // `order`: models with a smaller one are placed before it, whichever arrived first.
  add(view, order) {
    view.order = order;
    standUp(view.frame, view.tileset ?? view.mesh);
    this.models.push(view);
    this.models.sort((a, b) => a.order - b.order);
    this.scene.add(view.node);
    view.setEdges($('edges').checked);
    if (view.ladder && !this.automatic) view.show(this.slider * view.ladder.top);
    $('hint').hidden = true;
    this.frameAll();
  }

  turn(model) {
    turnOver(model.frame);
    this.frameAll();
  }

  showAll() {
    this.asked = null;
    this.frameAll();
  }

  frameAll() {
    if (this.models.length === 0) return;
    this.columns = columnsFor(this.models.length, this.camera.aspect);
    this.controls.target.copy(layOut(this.models, this.columns, this.camera, $('stage').clientHeight));
    // Nearer, each step would be less than the one before, for ever; farther away, the models would be lost.
    const distance = this.camera.position.distanceTo(this.controls.target);
    Object.assign(this.controls, {minDistance: NEAREST, maxDistance: 8 * distance});
    this.nearPlane = this.camera.near;
    this.controls.update();
    this.home = this.pose().flat();
    if (this.asked) {
      this.camera.position.fromArray(this.asked[0]);
      this.controls.target.fromArray(this.asked[1]);
      this.controls.update();
    }
    this.wake();
  }

  resize() {
    const {clientWidth: w, clientHeight: h} = $('stage');
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / Math.max(h, 1);
    this.camera.updateProjectionMatrix();
    if (this.models.length > 0 && columnsFor(this.models.length, this.camera.aspect) !== this.columns) this.frameAll();
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
    const moving = this.models.map((m) => this.advance(m, seconds)).some((m) => m);
    if (this.automatic) this.followSlider();
    this.head.position.copy(this.camera.position);
    this.placeNearPlane();
    this.renderer.render(this.scene, this.camera);
    this.report();
    this.onFrame?.();
    if (moving) requestAnimationFrame((t) => this.frame(t));
    else this.awake = false;
    if (!moving && this.ready) this.tell();
  }

  // Before the surface that is looked at, however near that is, and no nearer than that needs: depths stay apart.
  placeNearPlane() {
    if (this.models.length === 0) return;
    const near = Math.min(this.nearPlane, this.camera.position.distanceTo(this.controls.target) / 20);
    if (near === this.camera.near) return;
    this.camera.near = near;
    this.camera.updateProjectionMatrix();
  }

  // Returns whether the model changes by itself.
  advance(m, seconds) {
    const height = this.renderer.domElement.height;
    if (!m.ladder) return m.approach(this.camera, height, this.automatic ? this.pixels : m.pixelsOf(this.slider), seconds);
    return this.automatic ? m.approach(this.camera, height, this.pixels, seconds) : m.travel(this.slider * m.ladder.top, seconds);
  }

  followSlider() {
    if (this.models.length === 0) return;
    const first = this.models.find((m) => m.ladder);
    const share = first ? first.place / Math.max(first.ladder.top, 1) : this.models[0].levelOf(this.pixels);
    $('level').value = Math.round(1000 * Math.min(Math.max(share, 0), 1));
  }

  report() {
    const sum = this.models.reduce((n, m) => n + m.triangleCount, 0);
    $('count').textContent = `${sum.toLocaleString('en')} triangles`;
    $('level').setAttribute('aria-valuetext', $('count').textContent);
    this.labels.place(this.models, this.camera, $('stage').clientWidth, $('stage').clientHeight);
  }

  cracks() {
    return countCracks(this.renderer, this.scene, this.camera, this.models.flatMap((m) => m.objects));
  }
}

async function start(page) {
  page.follow(location.hash);
  const list = await (await ask('models.json')).json();
  const open = ({name, url, kind}, order) => (kind === 'tiles' ? page.openTiles(url, name, order) : page.openUrl(url, name, order));
  await Promise.all(list.map((model, order) => open(model, order).catch((e) => page.say(e.message))));
  $('hint').hidden = list.length > 0;
}

try {
  const page = new Page();
  window.lodestone = page;  // for tests and the console
  start(page).catch((e) => page.say(e.message)).then(() => { page.ready = true; });
} catch {
  $('text').textContent = 'This browser shows no models: WebGL 2 is missing or switched off.';
  $('message').hidden = false;
  $('panel').hidden = true;
}
