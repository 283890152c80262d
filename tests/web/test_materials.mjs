// Materials on the page, in progressive meshes and in tiles: masked, blended, emissive, unlit, single-sided, maps with
// places of their own.
// usage: node test_materials.mjs PROGRAM PAGE MODULES
import {writeFileSync} from 'node:fs';
import path from 'node:path';
import {check, folder, main, open, png, run} from './browser.mjs';

const unlit = (colour, more = {}, texture) => ({pbrMetallicRoughness: {baseColorFactor: colour, ...(texture && {baseColorTexture: {index: texture}})}, extensions: {KHR_materials_unlit: {}}, doubleSided: true, ...more});
const black = (more) => ({pbrMetallicRoughness: {baseColorFactor: [0, 0, 0, 1], roughnessFactor: 1, metallicFactor: 1}, doubleSided: true, ...more});
// Texture 0 is black, 1 red on the left and orange on the right, 2 green with an alpha of 0.6.
const placed = (transform) => ({pbrMetallicRoughness: {baseColorTexture: {index: 0}, roughnessFactor: 1, metallicFactor: 1}, doubleSided: true, emissiveFactor: [1, 1, 1],
                                emissiveTexture: {index: 1, extensions: {KHR_texture_transform: transform}}});
// By name: the material and the bytes that it shows; light is linear, bytes are in sRGB.
const plates = {
  gone: [unlit([1, 0, 1, 0.3], {alphaMode: 'MASK'}), [255, 0, 255]],
  there: [unlit([0, 0, 1, 0.6], {alphaMode: 'MASK'}), [0, 0, 255]],
  veil: [unlit([1, 1, 1, 1], {alphaMode: 'MASK'}, 2), [40, 200, 90]],
  glass: [unlit([1, 0, 0, 0.5], {alphaMode: 'BLEND'}), null],
  lamp: [black({emissiveFactor: [0, 0.5, 0], extensions: {KHR_materials_emissive_strength: {emissiveStrength: 2}}}), null],
  sign: [unlit([0.2158605, 0.5, 1, 1]), [128, 188, 255]],
  front: [unlit([1, 1, 0, 1], {doubleSided: false}), [255, 255, 0]],
  back: [unlit([0, 1, 1, 1], {doubleSided: false}), [0, 255, 255]],
  right: [placed({offset: [0.625, 0], scale: [0.25, 1]}), null],
  turned: [placed({offset: [0.875, 0], rotation: -Math.PI / 2, scale: [1, 0.25]}), null],
};

// A row of squares of 8 x 8 cells that face z, and one that faces away.
function writePlates(name) {
  const parts = [], primitives = [], accessors = [], bufferViews = [];
  let bytes = 0;
  const add = (array, more) => {
    bufferViews.push({buffer: 0, byteOffset: bytes, byteLength: array.byteLength});
    accessors.push({bufferView: bufferViews.length - 1, ...more});
    parts.push(Buffer.from(array.buffer));
    bytes += array.byteLength;
    return accessors.length - 1;
  };
  Object.keys(plates).forEach((key, k) => {
    const points = [], ids = [], n = 8, id = (i, j) => j * (n + 1) + i;
    for (let j = 0; j <= n; ++j) for (let i = 0; i <= n; ++i) points.push(k + 0.9 * i / n, 0.9 * j / n, 0);
    for (let j = 0; j < n; ++j)
      for (let i = 0; i < n; ++i)
        for (const t of [[id(i, j), id(i + 1, j), id(i + 1, j + 1)], [id(i, j), id(i + 1, j + 1), id(i, j + 1)]]) ids.push(...(key === 'back' ? t.reverse() : t));
    const TEXCOORD_0 = add(Float32Array.from(points.flatMap((_, p) => (p % 3 ? [] : [(points[p] - k) / 0.9, points[p + 1] / 0.9]))),
                           {componentType: 5126, count: points.length / 3, type: 'VEC2'});
    const POSITION = add(Float32Array.from(points), {componentType: 5126, count: points.length / 3, type: 'VEC3', min: [k, 0, 0], max: [k + 0.9, 0.9, 0]});
    primitives.push({attributes: {POSITION, TEXCOORD_0}, indices: add(Uint32Array.from(ids), {componentType: 5125, count: ids.length, type: 'SCALAR'}), material: k});
  });
  const materials = Object.entries(plates).map(([key, [m]]) => ({name: key, ...m}));
  writeFileSync(path.join(folder, name), JSON.stringify({asset: {version: '2.0'}, scene: 0, scenes: [{nodes: [0]}], nodes: [{mesh: 0}], meshes: [{primitives}],
    textures: [{source: 0}, {source: 1}, {source: 2}], extensionsUsed: ['KHR_texture_transform'],
    images: [() => [0, 0, 0], (x) => (x < 8 ? [255, 0, 0] : [255, 128, 0]), () => [40, 200, 90, 153]].map((colour) => ({uri: `data:image/png;base64,${png(16, colour).toString('base64')}`})),
    materials, accessors, bufferViews, buffers: [{byteLength: bytes, uri: `data:application/octet-stream;base64,${Buffer.concat(parts).toString('base64')}`}]}));
}

function makeFiles() {
  writePlates('plates.gltf');
  for (const kind of ['lpm', 'glb']) {
    run('progressive', 'plates.gltf', '-o', `plates.${kind}`);
    run('page', `plates.${kind}`, '-o', kind);
  }
  run('build', 'plates.gltf', '-o', 'plates.lode', '--levels', '1');
  run('page', 'plates.lode', '-o', 'tiles');
}

async function testSurfaces(browser) {
  for (const kind of ['lpm', 'glb', 'tiles']) {
    const {page, quiet, close} = await open(browser, kind);
    await quiet();
    const counts = await page.evaluate((wanted) => {
      const {camera, renderer, scene} = window.lodestone, gl = renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height);
      renderer.render(scene, camera);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
      const found = {glass: 0, lamp: 0, red: 0, orange: 0};
      for (let k = 0; k < out.length; k += 4) {
        const [r, g, b, a] = out.slice(k, k + 4);
        for (const [key, colour] of wanted) if (a === 255 && colour && colour.every((c, i) => Math.abs(c - out[k + i]) <= 1)) found[key] = (found[key] ?? 0) + 1;
        found.glass += Math.abs(a - 128) <= 2 && r > 2 * g + 60 ? 1 : 0;
        found.red += a === 255 && r > 200 && g < 90 && b < 60 ? 1 : 0;
        found.orange += a === 255 && r > 200 && g > 100 && g < 180 && b < 60 ? 1 : 0;
        found.lamp += a === 255 && g > 250 && r < 120 && b < 120 ? 1 : 0;
      }
      return found;
    }, Object.entries(plates).map(([key, [, colour]]) => [key, colour]));
    const seen = (key) => (counts[key] ?? 0) > 200;
    check(['there', 'veil', 'glass', 'lamp', 'sign'].every(seen) && !counts.gone, `${kind}: masked, blended, emissive, unlit: ${JSON.stringify(counts)}`);
    check(seen('orange') && counts.orange > 1.5 * counts.lamp && !counts.red, `${kind}: maps lie where their transforms put them: ${JSON.stringify(counts)}`);
    check(seen('front') !== seen('back') && (!counts.front || !counts.back), `${kind}: single-sided ones are seen from one side`);
    await close();
  }
}

main(makeFiles, [testSurfaces]);
