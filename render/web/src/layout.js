// Positions of models, a camera that sees them all, and their labels.
import * as THREE from 'three';

const WIDE = 1.15, HIGH = 1.4;  // of the place of a model, which is at most a unit across

// Columns for so many models, so that they are as large as they can be in a view of this aspect.
export function columnsFor(count, aspect) {
  const size = (columns) => Math.max(WIDE * columns / aspect, HIGH * Math.ceil(count / columns));
  let best = 1;
  for (let columns = 2; columns <= count; ++columns) if (size(columns) < size(best)) best = columns;
  return best;
}

export function layOut(models, columns) {
  models.forEach((m, k) => {
    const middle = m.box.getCenter(new THREE.Vector3());
    m.node.position.set(WIDE * (k % columns), -HIGH * Math.floor(k / columns), 0).sub(middle);
    m.node.updateMatrixWorld(true);
  });
}

// Moves the camera so that all boxes are in sight; returns their middle.
export function seeAll(camera, models) {
  const boxes = models.map((m) => m.box.clone().applyMatrix4(m.node.matrixWorld));
  const middle = boxes.reduce((all, b) => all.union(b), new THREE.Box3()).getCenter(new THREE.Vector3());
  const back = new THREE.Vector3(models.length > 1 ? 0.12 : 0.25, 0.2, 1).normalize();
  const right = new THREE.Vector3(0, 1, 0).cross(back).normalize(), up = back.clone().cross(right);
  const vertical = Math.tan(THREE.MathUtils.degToRad(camera.fov) / 2), horizontal = vertical * camera.aspect;
  let distance = 0;
  const corner = new THREE.Vector3();
  for (const {min, max} of boxes)
    for (let k = 0; k < 8; ++k) {
      corner.set(k & 1 ? min.x : max.x, k & 2 ? min.y - 0.16 : max.y + 0.04, k & 4 ? min.z : max.z).sub(middle);
      distance = Math.max(distance, corner.dot(back) + Math.max(Math.abs(corner.dot(right)) / horizontal, Math.abs(corner.dot(up)) / vertical));
    }
  distance = Math.max(distance, 0.1) * 1.03;
  camera.position.copy(middle).addScaledVector(back, distance);
  camera.near = distance / 1000;
  camera.far = distance * 100;
  camera.updateProjectionMatrix();
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
    const point = new THREE.Vector3();
    for (const model of models) {
      if (!this.entries.has(model)) {
        this.entries.set(model, this.make(model));
        this.sort(models);
      }
      const {button, small, progress} = this.entries.get(model), box = model.box.clone().applyMatrix4(model.node.matrixWorld);
      const low = Math.min(...[0, 1, 2, 3].map((k) => point.set(k & 1 ? box.min.x : box.max.x, box.min.y, k & 2 ? box.min.z : box.max.z).project(camera).y));
      box.getCenter(point).project(camera).setY(low);
      const seen = Math.abs(point.z) < 1 && Math.abs(point.x) < 1.2 && low > -1.2 && low < 1;
      button.hidden = !seen;
      const {bytes, all} = model.arrived ?? {};
      small.textContent = `${model.triangleCount.toLocaleString('en')} triangles${model.arrived ? `, ${kilobytes(bytes, all)} kB` : ''}`;
      progress.hidden = !model.arrived;
      if (all > 0) Object.assign(progress, {max: all, value: bytes});
      const x = (point.x + 1) / 2 * width, y = Math.min((1 - point.y) / 2 * height, height - 44) + 2;
      button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translateX(-50%)`;
    }
  }
}
