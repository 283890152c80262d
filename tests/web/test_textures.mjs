// Textures on the page: thumbnails before images, and octahedral images without a seam.
// usage: node test_textures.mjs PROGRAM PAGE MODULES [PICTURES]   with a folder for the pictures
import {mkdirSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {check, differ, folder, keep, main, open, run, squares, writeTorus} from './browser.mjs';

const pictures = process.argv[5];
let firstBytes = {};

// A closed surface with bumps, with smooth colours at its vertices, and crumbs of so many sizes beside it.
function writeBlob(name, n, m, crumbs = []) {
  const points = [], faces = [];
  addBlob(points, faces, n, m, 1, 0);
  crumbs.forEach((scale, k) => addBlob(points, faces, 24, 12, scale, 1.5 + 0.3 * k));
  writeFileSync(path.join(folder, name), ['ply', 'format ascii 1.0', `element vertex ${points.length}`,
    ...['x', 'y', 'z'].map((c) => `property float ${c}`), ...['red', 'green', 'blue'].map((c) => `property uchar ${c}`),
    `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header',
    ...points, ...faces.map((f) => `3 ${f.join(' ')}`)].join('\n') + '\n');
}

function addBlob(points, faces, n, m, scale, shift) {
  const first = points.length, id = (i, j) => first + (j === 0 ? 0 : j === m ? 1 : 2 + (j - 1) * n + (i % n));
  const place = (i, j) => {
    const a = 2 * Math.PI * i / n, b = Math.PI * j / m, r = 1 + 0.12 * Math.sin(5 * b) * Math.cos(3 * a) * Math.sin(b);
    return [r * Math.sin(b) * Math.cos(a), r * Math.cos(b), r * Math.sin(b) * Math.sin(a)];
  };
  const add = (p) => points.push([...p.map((x, k) => scale * x + (k === 0 ? shift : 0)), ...p.map((x, k) => Math.round(128 + 100 * Math.sin(3 * x + k)))].join(' '));
  add(place(0, 0)), add(place(0, m));
  for (let j = 1; j < m; ++j) for (let i = 0; i < n; ++i) add(place(i, j));
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) {
      if (j > 0) faces.push([id(i, j), id(i + 1, j), id(i, j + 1)]);
      if (j < m - 1) faces.push([id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
    }
}

function makeFiles() {
  writeTorus(80, 50);
  writeFileSync(path.join(folder, 'squares.png'), squares(1024));
  for (const name of ['torus.lpm', 'torus.glb']) {
    firstBytes[name] = JSON.parse(run('progressive', 'torus.obj', '-o', name, '--metric', 'attribute-quadric', '--base', '200', '--json', '-')).base_bytes;
    run('page', name, '-o', path.extname(name).slice(1));
  }
  writeBlob('blob.ply', 120, 60);
  run('spherical', 'blob.ply', '-o', 'blob.glb', '--up', 'y', '--texture', '256', '--images', 'png');
  run('progressive', 'blob.ply', '-o', 'plain.glb', '--up', 'y');
  run('spherical', 'blob.ply', '-o', 'blob.lpm', '--up', 'y', '--texture', '256');
  run('page', 'blob.glb', '-o', 'blob');
  run('page', 'plain.glb', '-o', 'plain');
  run('page', 'blob.lpm', '-o', 'small');
  writeBlob('crumbs.ply', 60, 30, [0.05, 0.03, 0.02, 0.03]);
  for (const name of ['crumbs.lpm', 'crumbs.glb']) {
    run('spherical', 'crumbs.ply', '-o', name, '--texture', '512', '--images', 'jpeg', '--quality', '60');
    run('page', name, '-o', name.replace('.', '-'));
  }
}

async function picture(page, name) {
  if (!pictures) return;
  mkdirSync(pictures, {recursive: true});
  await page.screenshot({path: path.join(pictures, `${name}.png`)});
}

const reds = (page) => page.evaluate(() => {
  const gl = window.lodestone.renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height), count = {red: 0, yellow: 0, grey: 0};
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  for (let k = 0; k < out.length; k += 4)
    if (out[k + 3] === 255) ++count[out[k] > 1.5 * out[k + 1] ? 'red' : out[k] > 1.15 * out[k + 2] ? 'yellow' : 'grey'];
  return count;
});

// With no more than what a file says to need for its first picture, that picture has its textures.
async function testThumbnails(browser) {
  for (const kind of ['lpm', 'glb']) {
    let release;
    const rest = new Promise((next) => { release = next; });
    const is = (file) => file.endsWith(`.${kind}`);
    const {page, quiet, close, triangles} = await open(browser, kind, {gate: (file) => (is(file) ? rest : null), part: () => firstBytes[`torus.${kind}`]});
    await page.waitForFunction(() => window.lodestone?.models.length === 1 && !window.lodestone.awake);
    const side = () => page.evaluate(() => window.lodestone.models[0].object.material[0].map.image.width);
    const [early, {bytes, all}, count, width] = [await triangles(), await page.evaluate(() => window.lodestone.models[0].arrived), await reds(page), await side()];
    await picture(page, `${kind} first`);
    check(bytes < all / 2 && width === 64, `${kind}: ${bytes} of ${all} bytes give ${early} triangles and a texture of ${width} pixels`);
    check(count.red > 1000 && count.yellow > 1000, `its colours are on the screen: ${JSON.stringify(count)}`);
    await keep(page, 'first');
    release();
    await quiet();
    await picture(page, `${kind} last`);
    await keep(page, 'last');
    check(await side() === 1024, 'then the image itself comes');
    const off = await differ(page, 'first', 'last', 100);
    check(early < 8000 || off < 0.05, `${off} of the picture changes much`);
    await close();
  }
}

// Shows the model at a place of its ladder, from a distance.
const show = (page, place, away = 1) => page.evaluate(([p, d]) => {
  const {camera, controls, models: [m], renderer, scene, head} = window.lodestone;
  window.way ??= camera.position.clone().sub(controls.target);
  camera.position.copy(controls.target).addScaledVector(window.way, d);
  camera.updateMatrixWorld(true);
  head.position.copy(camera.position);
  m.show(p ?? m.ladder.top);
  renderer.render(scene, camera);
}, [place, away]);

// All levels are closed, and exchanging one is not seen.
async function testLevels(browser) {
  const {page, quiet, close} = await open(browser, 'blob');
  await quiet();
  const top = await page.evaluate(() => window.lodestone.models[0].ladder.top), changes = [];
  for (let rung = 1; rung <= top; ++rung) {
    await show(page, rung - 1e-5), await keep(page, 'below');
    if (rung < top) {
      await show(page, rung + 1e-5), await keep(page, 'above');
      changes.push(await differ(page, 'below', 'above', 4));
    }
  }
  check(top > 10 && Math.max(...changes) < 0.001, `exchanging a level changes at most ${Math.max(...changes)} of the picture, at ${changes.length} levels`);
  const cracks = await page.evaluate((last) => Array.from({length: 2 * last + 1}, (_, k) => {
    window.lodestone.models[0].show(k / 2);
    return window.lodestone.cracks();
  }), top);
  check(cracks.every((c) => c.cracks === 0 && c.covered > 5000), `no crack at ${cracks.length} places of the slider`);
  await close();
}

// The mean difference of two pictures where both show the model.
const shading = (page, a, b) => page.evaluate(([first, second]) => {
  const found = [], x = window.kept[first], y = window.kept[second];
  for (let k = 0; k < x.length; k += 4)
    if (x[k + 3] === 255 && y[k + 3] === 255) found.push(Math.max(...[0, 1, 2].map((i) => Math.abs(x[k + i] - y[k + i]))));
  return found.reduce((sum, d) => sum + d, 0) / found.length;
}, [a, b]);

// Normals of the image, right at every level, light coarse levels as they do the finest one: the better, the more
// triangles there are.
async function testNormals(browser) {
  const {page, quiet, close} = await open(browser, 'blob');
  await quiet();
  check(await page.evaluate(() => window.lodestone.models[0].object.material[0].normalMapType === 1), 'normals are in object space');
  const top = await page.evaluate(() => window.lodestone.models[0].ladder.top);
  const coarse = [[Math.floor(0.3 * top), 0.7], [Math.floor(0.4 * top), 0.5]];
  await picture(page, 'blob');
  const without = (map) => page.evaluate((key) => {
    const [material] = window.lodestone.models[0].object.material;
    material[key] = null;
    material.needsUpdate = true;
  }, map);
  await without('map');
  await show(page), await keep(page, 'finest'), await picture(page, 'blob finest');
  for (const [place] of coarse) await show(page, place), await keep(page, `at ${place}`), await picture(page, `blob at ${place}`);
  await show(page, 0), await picture(page, 'blob base');
  await without('normalMap');
  for (const [place, part] of coarse) {
    await show(page, place), await keep(page, 'bare'), await picture(page, `blob at ${place} without normals`);
    const off = await shading(page, 'finest', `at ${place}`), bare = await shading(page, 'finest', 'bare');
    check(off < part * bare, `level ${place} is lit as the finest but for ${off.toFixed(2)} of 255, ${bare.toFixed(2)} without its normals`);
  }
  await close();
}

// How much pixels on the visible cut stand out from those three pixels beside them: at each end of each edge of the cut.
const ridges = (page) => page.evaluate(() => {
  const {camera, models: [m], renderer} = window.lodestone, {mesh} = m, gl = renderer.getContext(), {width, height} = gl.canvas;
  const out = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  const point = camera.position.clone(), eye = m.frame.worldToLocal(camera.position.clone());
  const onScreen = (v) => {
    point.fromArray(mesh.positions, 3 * v);
    m.frame.localToWorld(point).project(camera);
    return [(point.x + 1) / 2 * width, (point.y + 1) / 2 * height];
  };
  const colour = (x, y) => Array.from(out.subarray(4 * (Math.floor(y) * width + Math.floor(x))).subarray(0, 4));
  const side = (v) => [0, 1].flatMap((i) => [0, 1].map((s) => (mesh.uv[2 * v + i] === s ? 1 << (2 * i + s) : 0))).reduce((a, b) => a | b);
  const found = [];
  for (let k = 0; k < mesh.triangles.length; k += 3)
    for (let c = 0; c < 3; ++c) {
      const a = mesh.triangles[k + c], b = mesh.triangles[k + (c + 1) % 3];
      if ((side(a) & side(b)) === 0) continue;
      const n = [0, 1, 2].map((i) => mesh.normals[3 * a + i]), to = [0, 1, 2].map((i) => eye.getComponent(i) - mesh.positions[3 * a + i]);
      if (n.reduce((s, x, i) => s + x * to[i], 0) < 0.5 * Math.hypot(...to)) continue;
      const [p, q] = [onScreen(a), onScreen(b)], length = Math.hypot(q[0] - p[0], q[1] - p[1]);
      const across = length > 1e-6 ? [(p[1] - q[1]) / length, (q[0] - p[0]) / length] : [1, 0];
      const [x, y] = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
      const [here, left, right] = [0, -3, 3].map((d) => colour(x + d * across[0], y + d * across[1]));
      if ([here, left, right].some((z) => z[3] !== 255)) continue;
      found.push([x, y, ...across, Math.max(...[0, 1, 2].map((i) => Math.abs(here[i] - (left[i] + right[i]) / 2)))]);
    }
  return found;
});

// The same of another picture at the same pixels.
const ridgesAt = (page, places) => page.evaluate((list) => {
  const gl = window.lodestone.renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  const colour = (x, y) => out.subarray(4 * (Math.floor(y) * width + Math.floor(x))).subarray(0, 4);
  return list.map(([x, y, ax, ay]) => {
    const [here, left, right] = [0, -3, 3].map((d) => colour(x + d * ax, y + d * ay));
    return Math.max(...[0, 1, 2].map((i) => Math.abs(here[i] - (left[i] + right[i]) / 2)));
  });
}, places);

const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;

// The cut is no line in the picture, near and far: along it pixels stand out as they do in the model with the colours at
// its vertices, which has no cut. WebP stores the hue of four texels as one, which shifts colours at the sides by half a
// texel: a few of 255 in images as small as these.
async function testCut(browser) {
  for (const [name, loss] of [['blob', 0.5], ['small', 4]]) {
    const cut = await open(browser, name), plain = await open(browser, 'plain');
    await cut.quiet(), await plain.quiet();
    for (const away of [0.6, 1, 3]) {
      await show(cut.page, null, away), await show(plain.page, null, away);
      await picture(cut.page, `${name} from ${away}`), await picture(plain.page, `plain from ${away}`);
      const places = await ridges(cut.page), own = places.map((p) => p[4]), other = await ridgesAt(plain.page, places);
      check(places.length > 10, `${name} from ${away}: ${places.length} edges of the cut are in sight`);
      check(mean(own) < mean(other) + loss, `pixels on the cut stand out by ${mean(own).toFixed(2)} of 255, by ${mean(other).toFixed(2)} where there is none`);
    }
    await cut.close(), await plain.close();
  }
}

// Each mip level reads the same in both directions of a side, to the last bit.
async function testMips(browser) {
  const {page, quiet, close} = await open(browser, 'blob');
  await quiet();
  const found = await page.evaluate(() => window.lodestone.models[0].images.filter((i) => i).map(({texture: {mipmaps}}) => mipmaps.map(({data, width: n}) => {
    const texel = (x, y) => data.subarray(4 * (y * n + x), 4 * (y * n + x) + 4).join();
    return Array.from({length: n}, (_, i) => i).every((i) => texel(i, 0) === texel(n - 1 - i, 0) && texel(i, n - 1) === texel(n - 1 - i, n - 1) &&
                                                            texel(0, i) === texel(0, n - 1 - i) && texel(n - 1, i) === texel(n - 1, n - 1 - i));
  })));
  check(found.length === 2 && found.every((levels) => levels.length === 9 && levels.every((symmetric) => symmetric)), `${found.map((l) => l.length)} symmetric levels`);
  await close();
}

// In an atlas the margins of each square continue its image at each level at which it has 8 texels or more, and a square
// of 4 texels is symmetric, to the last bit.
async function testAtlas(browser) {
  for (const name of ['crumbs-lpm', 'crumbs-glb']) {
    const {page, quiet, close} = await open(browser, name);
    await quiet();
    await picture(page, name);
    const found = await page.evaluate(() => {
      const [m] = window.lodestone.models, k = m.mesh.materials.findIndex(({octahedral}) => octahedral?.squares);
      const {side, squares: [[largest, count]]} = m.mesh.materials[k].octahedral, {map, normalMap} = m.object.material[k], seamless = [];
      for (const {mipmaps} of [map, normalMap])
        for (const {data, width} of mipmaps) {
          const size = largest * width / side, margin = size >> 3, n = size - 2 * margin;
          if (size < 4) break;
          let same = 0, all = 0;
          const bytes = (x, y) => data.subarray(4 * (y * width + x), 4 * (y * width + x) + 4).join();
          for (let s = 0; s < count; ++s)
            for (let y = 0; y < size; ++y)
              for (let x = 0; x < size; ++x) {
                let [a, b] = [x - margin, y - margin];
                if (size === 4) {
                  if (x === 0 || x === 3) b = 3 - b;
                  else if (y === 0 || y === 3) a = 3 - a;
                } else {
                  if (a < 0) [a, b] = [-1 - a, n - 1 - b];
                  if (a >= n) [a, b] = [2 * n - 1 - a, n - 1 - b];
                  if (b < 0) [a, b] = [n - 1 - a, -1 - b];
                  if (b >= n) [a, b] = [n - 1 - a, 2 * n - 1 - b];
                }
                const [left, top] = [s % 2 * size, (s >> 1) * size];
                ++all;
                if (bytes(left + x, top + y) === bytes(left + a + margin, top + b + margin)) ++same;
              }
          seamless.push([size, same === all]);
        }
      return {seamless, count};
    });
    check(found.seamless.length >= 6 && found.seamless.every(([, same]) => same), `${name}: levels of ${found.count} squares are seamless: ${found.seamless}`);
    await close();
  }
}

await main(makeFiles, [testThumbnails, testLevels, testNormals, testCut, testMips, testAtlas]);
