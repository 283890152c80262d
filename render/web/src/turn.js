// Models have y up or z up.
import * as THREE from 'three';

// The box of a model in its frame, turned as the frame is.
export function turnedBox(extent, frame) {
  frame.updateMatrix();
  return extent.clone().applyMatrix4(new THREE.Matrix4().makeRotationFromEuler(frame.rotation));
}
