// Cracks in the picture of a closed surface: a line of sight that enters it leaves it, so that every pixel sees as many
// fronts as backs, whatever folds or turns. Rasterization covers shared edges once; where the counts differ there is a
// crack.
import * as THREE from 'three';

export function countCracks(renderer, scene, camera, objects, size = 512) {
  const target = new THREE.WebGLRenderTarget(size, size, {depthBuffer: false, type: THREE.UnsignedByteType});
  const kept = objects.map((o) => [o.material, o.visible]), background = scene.background;
  const lens = camera.clone();
  lens.aspect = 1;
  lens.updateProjectionMatrix();
  objects.forEach((o) => { Object.assign(o, {material: o.userData.counting, visible: true}); });
  scene.background = null;
  renderer.setRenderTarget(target);
  renderer.setClearColor(0x000000, 0);
  renderer.clear();
  renderer.render(scene, lens);
  const pixels = new Uint8Array(4 * size * size);
  renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
  renderer.setRenderTarget(null);
  objects.forEach((o, k) => { [o.material, o.visible] = kept[k]; });
  scene.background = background;
  target.dispose();
  let cracks = 0, covered = 0;
  for (let k = 0; k < pixels.length; k += 4) {
    covered += pixels[k] + pixels[k + 1] > 0 ? 1 : 0;
    cracks += pixels[k] !== pixels[k + 1] ? 1 : 0;
  }
  return {cracks, covered};
}
