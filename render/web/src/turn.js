// The page has y up; a model has what its file says.
import * as THREE from 'three';

const Y = new THREE.Vector3(0, 1, 0);
const axes = {x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1], '-x': [-1, 0, 0], '-y': [0, -1, 0], '-z': [0, 0, -1]};

// The direction that is up in the coordinates of a mesh or a tileset; `earth` is away from their origin.
export function directionOf({up, origin}) {
  const away = new THREE.Vector3().fromArray(origin);
  return up === 'earth' && away.length() > 0 ? away.normalize() : new THREE.Vector3().fromArray(axes[up] ?? axes.y);
}

// Turns the frame of a model, a mesh or a tileset, upright.
export function standUp(frame, {up, origin}) {
  frame.userData.up = {own: up, now: up, origin};
  frame.quaternion.setFromUnitVectors(directionOf({up, origin}), Y);
}

// To and fro between the model's own up axis and the other one of y and z.
export function turnOver(frame) {
  const {own, now, origin} = frame.userData.up, other = own === 'y' ? 'z' : 'y';
  frame.userData.up.now = now === own ? other : own;
  frame.quaternion.setFromUnitVectors(directionOf({up: frame.userData.up.now, origin}), Y);
}

// The box of a model in its frame, turned as the frame is.
export function turnedBox(extent, frame) {
  frame.updateMatrix();
  return extent.clone().applyMatrix4(new THREE.Matrix4().makeRotationFromEuler(frame.rotation));
}
