// Positions of models, a camera that sees them all, and their labels.
import * as THREE from 'three';

const WIDE = 1.15, HIGH = 1.4, HIGHEST = 2;  // of the place of a model, which is at most a unit across
const LABEL = 40;  // pixels: the height of a label and what is between it and its model
const NARROWEST = 80;  // pixels of a label

// Columns for so many models, so that they are as large as they can be in a view of this aspect.
export function columnsFor(count, aspect) {
  const size = (columns) => Math.max(WIDE * columns / aspect, HIGH * Math.ceil(count / columns));
  let best = 1;
  for (let columns = 2; columns <= count; ++columns) if (size(columns) < size(best)) best = columns;
  return best;
}

// Puts the models into rows and moves the camera so that all are in sight, in a view of so many pixels, with their labels
// free of other models: rows are farther apart the smaller they are. Returns the middle of all.
export function layOut(models, columns, camera, height) {
  for (let high = HIGH; ; high += 0.1) {
    models.forEach((m, k) => {
      const middle = m.box.getCenter(new THREE.Vector3());
      m.node.position.set(WIDE * (k % columns), -high * Math.floor(k / columns), 0).sub(middle);
      m.node.updateMatrixWorld(true);
    });
    const middle = seeAll(camera, models, height), rows = models.map((m) => rowsOf(m, camera, height));
    if (high >= HIGHEST || rows.every(({bottom}, k) => bottom + LABEL <= (rows[k + columns]?.top ?? Infinity))) return middle;
  }
}

const cornersOf = ({min, max}) => Array.from({length: 8}, (_, k) => new THREE.Vector3(k & 1 ? min.x : max.x, k & 2 ? min.y : max.y, k & 4 ? min.z : max.z));

// The pixels from the upper edge of the view between which the box of a model is.
function rowsOf(model, camera, height) {
  const rows = cornersOf(model.box.clone().applyMatrix4(model.node.matrixWorld)).map((corner) => (1 - corner.project(camera).y) / 2 * height);
  return {top: Math.min(...rows), bottom: Math.max(...rows)};
}

// Moves the camera so that all boxes are in sight, and a label below them; returns their middle.
function seeAll(camera, models, height) {
  const boxes = models.map((m) => m.box.clone().applyMatrix4(m.node.matrixWorld));
  const middle = boxes.reduce((all, b) => all.union(b), new THREE.Box3()).getCenter(new THREE.Vector3());
  const back = new THREE.Vector3(models.length > 1 ? 0.12 : 0.25, 0.2, 1).normalize();
  const right = new THREE.Vector3(0, 1, 0).cross(back).normalize(), up = back.clone().cross(right);
  const vertical = Math.tan(THREE.MathUtils.degToRad(camera.fov) / 2), horizontal = vertical * camera.aspect;
  const below = vertical * Math.max(1 - 2 * LABEL / height, 0.5);
  let distance = 0;
  for (const corner of boxes.flatMap(cornersOf)) {
    corner.sub(middle);
    const x = corner.dot(right), y = corner.dot(up);
    distance = Math.max(distance, corner.dot(back) + Math.max(Math.abs(x) / horizontal, y / vertical, -y / below));
  }
  distance = Math.max(distance, 0.1) * 1.03;
  camera.position.copy(middle).addScaledVector(back, distance);
  camera.lookAt(middle);
  camera.near = distance / 1000;
  camera.far = distance * 100;
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
  return middle;
}

const kilobytes = (bytes, all) => [bytes, all].filter((n) => n > 0).map((n) => Math.ceil(n / 1000).toLocaleString('en')).join('/');

// A label below each model: its name, triangles and how much of it is there. A click turns the model upright.
export class Labels {
  constructor(root, turn) { Object.assign(this, {root, turn, entries: new Map()}); }

  make(model) {
    const button = document.createElement('button'), name = document.createElement('span'), small = document.createElement('small');
    const progress = document.createElement('progress');
    progress.setAttribute('aria-label', `${model.name}: how much is there`);
    Object.assign(button, {type: 'button', title: `${model.name}: click to turn between y up and z up`});
    button.addEventListener('click', () => this.turn(model));
    name.textContent = model.name;
    button.append(name, small, progress);
    this.root.append(button);
    return {button, small, progress};
  }

  // In the order of the models, which is that of the tabulator key.
  sort(models) {
    this.root.append(...models.map((m) => this.entries.get(m)?.button).filter((b) => b));
  }

  place(models, camera, width, height) {
    const point = new THREE.Vector3(), places = [];
    for (const model of models) {
      if (!this.entries.has(model)) {
        this.entries.set(model, this.make(model));
        this.sort(models);
      }
      const {button, small, progress} = this.entries.get(model), box = model.box.clone().applyMatrix4(model.node.matrixWorld);
      const low = Math.min(...[0, 1, 2, 3].map((k) => point.set(k & 1 ? box.min.x : box.max.x, box.min.y, k & 2 ? box.min.z : box.max.z).project(camera).y));
      box.getCenter(point).project(camera).setY(low);
      button.hidden = !(Math.abs(point.z) < 1 && Math.abs(point.x) < 1.2 && low > -1.2 && low < 1);
      const {bytes, all} = model.arrived ?? {};
      small.textContent = `${model.triangleCount.toLocaleString('en')} triangles${model.arrived ? `, ${kilobytes(bytes, all)} kB` : ''}`;
      progress.hidden = !model.arrived;
      if (all > 0) Object.assign(progress, {max: all, value: bytes});
      if (!button.hidden) places.push({button, x: (point.x + 1) / 2 * width, y: (1 - point.y) / 2 * height + 2});
    }
    this.keepApart(places, width, height);
  }

  // All in the view, and no wider than models beside each other are apart; where that is not enough, the first of labels
  // on one another is shown.
  keepApart(places, width, height) {
    const taken = [], beside = places.flatMap((a, k) => places.slice(k + 1).filter((b) => Math.abs(b.y - a.y) < LABEL).map((b) => Math.abs(b.x - a.x)));
    this.root.style.setProperty('--widest', `${Math.max(Math.min(...beside) - 2, NARROWEST)}px`);
    for (const place of places) Object.assign(place, {w: place.button.offsetWidth + 1, h: place.button.offsetHeight});  // rounded
    for (const {button, x, y, w, h} of places) {
      const left = Math.max(Math.min(x - w / 2, width - w), 0), top = Math.min(y, height - h - 2);
      const free = taken.every((t) => left >= t.left + t.w || t.left >= left + w || top >= t.top + t.h || t.top >= top + h);
      if (free) taken.push({left, top, w, h});
      button.style.visibility = free ? '' : 'hidden';
      button.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
    }
  }
}
