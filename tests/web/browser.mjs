// Headless Chromium for the tests of the page, and what they share.
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {deflateSync} from 'node:zlib';
import {serve} from './server.mjs';

const [program, pageFolder, modules] = process.argv.slice(2, 5).map((p) => path.resolve(p));
const chromiumPath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const folder = mkdtempSync(path.join(tmpdir(), 'lodestone-page-'));

export {folder, modules, pageFolder, program};
export const run = (...words) => execFileSync(program, [...words, '--quiet'], {cwd: folder, env: {...process.env, LODESTONE_PAGE: pageFolder}});
export const check = (holds, what) => {
  if (!holds) throw new Error(what);
  console.log(`ok: ${what}`);
};

// Runs the tests one after the other; each gets a browser. Exits with 77, which ctest shows as skipped, without one,
// without the bundled page where that is tested, and where `makeFiles` returns false.
export async function main(makeFiles, tests, {bundle = true} = {}) {
  if (!existsSync(path.join(modules, 'playwright-core')) || (bundle && !existsSync(path.join(pageFolder, 'page.js'))) || !chromiumPath) {
    console.log('skipped: needs playwright-core, three and esbuild (scripts/setup) and Chromium');
    rmSync(folder, {recursive: true, force: true});
    process.exit(77);
  }
  const {chromium} = createRequire(path.join(modules, 'x'))('playwright-core');
  const args = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  let status = 0, browser = null;
  try {
    if (await makeFiles() === false) {
      console.log('skipped: needs the real models (scripts/data)');
      status = 77;
      return;
    }
    browser = await chromium.launch({executablePath: chromiumPath, args});
    for (const test of tests) {
      console.log(test.name);
      await test(browser);
    }
  } catch (error) {
    console.error(`failed: ${error.stack ?? error}`);
    status = 1;
  } finally {
    await browser?.close();
    rmSync(folder, {recursive: true, force: true});
    process.exit(status);  // servers of tests that failed are still open
  }
}

// One sample a pixel: several take more than half of the time that the processor needs for a picture.
function drawOneSample() {
  const {getContext} = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return getContext.call(this, kind, {...options, antialias: false});
  };
}

// A page of the browser that fails the test on any error in its console, but for those that `expected` matches. `smooth`:
// with the samples that it asks for.
export async function open(browser, name, {gate, part, slow, ranges, sent, query = '', expected = null, prepare = null, smooth = false, viewport = {width: 480, height: 360}, ...more} = {}) {
  const server = await serve(path.join(folder, name), {gate, part, slow, ranges, sent});
  const context = await browser.newContext({viewport, ...more}), page = await context.newPage(), errors = [];
  page.setDefaultTimeout(120000);
  const note = (text) => { if (!/GPU stall/.test(text) && !expected?.test(text)) errors.push(text); };
  page.on('console', (m) => { if (['error', 'warning'].includes(m.type())) note(m.text()); });
  page.on('pageerror', (e) => note(e.message));
  if (!smooth) await page.addInitScript(drawOneSample);
  if (prepare) await page.addInitScript(prepare);
  await page.goto(`http://127.0.0.1:${server.port}/${query}`);
  const quiet = () => page.waitForFunction(() => window.lodestone?.ready && !window.lodestone.awake, null, {timeout: 120000});
  const close = async () => {
    await context.close();
    server.close();
    check(errors.length === 0, `${name}: nothing in the console ${errors.join('; ')}`);
  };
  const triangles = () => page.evaluate(() => window.lodestone.models.reduce((n, m) => n + m.triangleCount, 0));
  return {page, errors, quiet, close, triangles};
}

// Keeps the picture under a name; tells what share of the pixels of two pictures differ by more than `by`.
export const keep = (page, name) => page.evaluate((key) => {
  const gl = window.lodestone.renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  (window.kept ??= {})[key] = out;
  return [...out.filter((_, k) => k % 997 === 0)];
}, name);
export const differ = (page, a, b, by = 12) => page.evaluate(([x, y, least]) => {
  let count = 0;
  for (let k = 0; k < window.kept[x].length; k += 4)
    count += [0, 1, 2, 3].some((i) => Math.abs(window.kept[x][k + i] - window.kept[y][k + i]) > least) ? 1 : 0;
  return count / (window.kept[x].length / 4);
}, [a, b, by]);

// A closed torus with normals, texture coordinates, seams and charts of its own; with a texture as torus.mtl has it.
export function writeTorus(n, m) {
  const lines = ['mtllib torus.mtl', 'usemtl squares'], id = (i, j) => (j % m) * n + (i % n) + 1, uv = (i, j) => j * (n + 1) + i + 1;
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) {
      const a = 2 * Math.PI * i / n, b = 2 * Math.PI * j / m, r = 1 + (0.4 + 0.03 * Math.sin(9 * a)) * Math.cos(b);
      lines.push(`v ${r * Math.cos(a)} ${0.4 * Math.sin(b)} ${r * Math.sin(a)}`);
      lines.push(`vn ${Math.cos(b) * Math.cos(a)} ${Math.sin(b)} ${Math.cos(b) * Math.sin(a)}`);
    }
  for (let j = 0; j <= m; ++j) for (let i = 0; i <= n; ++i) lines.push(`vt ${i / n} ${j / m}`);
  const corner = (i, j) => `${id(i, j)}/${uv(i, j)}/${id(i, j)}`;
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i)
      lines.push(`f ${corner(i, j)} ${corner(i, j + 1)} ${corner(i + 1, j + 1)}`, `f ${corner(i, j)} ${corner(i + 1, j + 1)} ${corner(i + 1, j)}`);
  writeFileSync(path.join(folder, 'torus.obj'), lines.join('\n') + '\n');
  writeFileSync(path.join(folder, 'torus.mtl'), 'newmtl squares\nKd 1 1 1\nmap_Kd squares.png\n');
  writeFileSync(path.join(folder, 'squares.png'), squares(128));
}

export function crc32(bytes) {
  let crc = ~0;
  for (const b of bytes) {
    crc ^= b;
    for (let k = 0; k < 8; ++k) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return ~crc >>> 0;
}

// A PNG of coloured squares.
export const squares = (size) => png(size, (x, y) => ((x >> 4) + (y >> 4) & 1 ? [220, 60, 40] : [240, 220 - y, 90 + x]));

// A PNG of size x size pixels with these bytes: three a pixel, or four with alpha.
export function png(size, bytesAt) {
  const channels = bytesAt(0, 0).length, row = 1 + channels * size, rows = Buffer.alloc(size * row);
  for (let y = 0; y < size; ++y) for (let x = 0; x < size; ++x) rows.set(bytesAt(x, y), y * row + 1 + channels * x);
  const chunk = (type, data) => {
    const out = Buffer.alloc(12 + data.length);
    out.writeUInt32BE(data.length, 0);
    out.write(type, 4);
    data.copy(out, 8);
    out.writeUInt32BE(crc32(out.subarray(4, 8 + data.length)), 8 + data.length);
    return out;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(size, 0);
  head.writeUInt32BE(size, 4);
  head.set([8, channels === 4 ? 6 : 2, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk('IHDR', head), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}
