// The npm package: packed, installed in an empty folder, checked against its types, and its example in the browser.
// usage: node test_package.mjs PROGRAM PAGE MODULES
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {check, folder, main, modules, open, run, writeTorus} from './browser.mjs';

const source = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../render/web'), home = path.join(folder, 'home');
const example = 'node_modules/lodestone-web/example/index.html';

function makeFiles() {
  mkdirSync(home);
  writeTorus(80, 50);
  run('progressive', 'torus.obj', '-o', 'home/torus.lpm', '--up=-z');
  run('progressive', 'torus.obj', '-o', 'home/torus.glb', '--up=-z');
  run('build', 'torus.obj', '-o', 'torus.lode', '--cell-triangles', '250');
  run('export', 'torus.lode', '--tiles', 'home/tiles', '--morph');
}

function testInstall() {
  const [packed] = JSON.parse(execFileSync('npm', ['pack', source, '--json', '--pack-destination', folder], {cwd: folder, stdio: ['ignore', 'pipe', 'ignore']}));
  const dependencies = {'lodestone-web': `file:${path.join(folder, packed.filename)}`, three: `file:${path.join(modules, 'three')}`};
  writeFileSync(path.join(home, 'package.json'), JSON.stringify({type: 'module', dependencies}));
  execFileSync('npm', ['install', '--offline', '--no-audit', '--no-fund', '--ignore-scripts'], {cwd: home, stdio: ['ignore', 'ignore', 'inherit']});
  const names = execFileSync('node', ['-e', "import('lodestone-web').then((m) => console.log(Object.keys(m).join()))"], {cwd: home, encoding: 'utf8'}).trim();
  check(names === 'load', `a package of ${packed.size} bytes is installed in an empty folder; it exports ${names}`);
}

// The declarations are written by hand: what tsc infers of the code has to fit them, and what the example does, too.
function testTypes() {
  const compiler = path.join(modules, '.bin/tsc');
  if (!existsSync(compiler) || !existsSync(path.join(modules, '@types/three'))) {
    console.log('typescript or @types/three is not installed: types are not checked');
    return;
  }
  const at = (name) => JSON.stringify(path.join(source, name));
  writeFileSync(path.join(home, 'fits.ts'), `
    import type {Model, load} from ${at('types/index.js')};
    import * as code from ${at('src/load.js')};
    export const fits: typeof load = code.load;
    export const model: Model = await code.load('');
    // The other way round: nothing public of the code is missing from the declarations.
    type Own = Exclude<keyof Awaited<ReturnType<typeof code.load>>, 'view' | 'stop' | 'time' | 'disposed'>;
    import {MorphPlugin as DeclaredPlugin} from ${at('types/3d-tiles.js')};
    import {MorphPlugin} from ${at('src/tiles_plugin.js')};
    export const plugin: DeclaredPlugin = new MorphPlugin();
    export const all: Record<Own, unknown> = null as unknown as Model;
  `);
  const types = path.join(modules, '@types/three');
  const options = {target: 'es2022', module: 'esnext', moduleResolution: 'bundler', strict: true, noEmit: true, allowJs: true, skipLibCheck: true,
                   lib: ['es2024', 'dom', 'dom.iterable'], types: [],
                   paths: {three: [types], 'three/addons/*': [path.join(types, 'examples/jsm/*')], 'lodestone-web': [path.join(source, 'types/index.d.ts')]}};
  writeFileSync(path.join(home, 'tsconfig.json'), JSON.stringify({compilerOptions: options, files: ['fits.ts', path.join(source, 'example/example.js')]}));
  let told = '';
  try {
    execFileSync(compiler, ['-p', home], {encoding: 'utf8'});
  } catch (error) {
    told = error.stdout;
  }
  check(told === '', `the types fit the code ${told}`);
}

const state = (page) => page.evaluate(() => {
  const {model, renderer} = window.example, {memory, programs} = renderer.info;
  return {up: model.up.toArray(), triangles: model.triangleCount, low: model.box.min.toArray(), high: model.box.max.toArray(), ...memory, programs: programs.length};
});
const rest = (page) => page.waitForFunction(() => window.example?.rests);

// Each kind of file: in its coordinates, by the pixels of the picture, and without a trace when it has gone.
async function testExample(browser) {
  for (const name of ['torus.lpm', 'torus.glb', 'tiles/tileset.json']) {
    const {page, close} = await open(browser, 'home', {query: `${example}?url=/${name}`});
    await rest(page);
    const first = await state(page);
    // y of the file is up in tiles, too: coordinates are those of the file.
    const box = [-1.43, -0.4, -1.43, 1.43, 0.4, 1.43], near = [...first.low, ...first.high].every((x, k) => Math.abs(x - box[k]) < 0.07);
    check(near, `${name}: ${first.triangles} triangles from ${first.low.map((x) => x.toFixed(2))} to ${first.high.map((x) => x.toFixed(2))}`);
    check(first.up.join() === (name.endsWith('.json') ? '0,1,0' : '0,0,-1'), `${name}: up is ${first.up}`);
    check(first.geometries > 0 && first.textures > 0 && first.programs > 0, `${first.geometries} geometries, ${first.textures} textures, ${first.programs} programs`);
    const found = await page.evaluate(async () => {
      const {model, camera, controls, scene, wake} = window.example;
      const settle = async () => {
        wake();
        do await new Promise((next) => requestAnimationFrame(next)); while (!window.example.rests);
        return model.triangleCount;
      };
      const fine = await settle();
      model.pixels = 20;
      const coarse = await settle();
      // A scene ten times as large looks the same.
      scene.scale.setScalar(10);
      for (const v of [camera.position, controls.target]) v.multiplyScalar(10);
      for (const side of ['near', 'far']) camera[side] *= 10;
      controls.update();
      const large = await settle();
      model.level = 0;
      return {fine, coarse, large, base: await settle()};
    });
    check(found.coarse < found.fine / 2 && found.large === found.coarse && found.base <= found.coarse,
          `${found.fine} triangles, of 20 pixels ${found.coarse}, ten times as large ${found.large}, at least ${found.base}`);
    const {left, plain} = await page.evaluate(async () => {
      const THREE = await import('three'), {model, renderer, scene, camera} = window.example;
      const count = (r) => JSON.stringify({...r.info.memory, programs: r.info.programs.length});
      model.dispose();
      renderer.render(scene, camera);
      // What a renderer keeps of its own after it has drawn a material like this.
      const other = new THREE.WebGLRenderer(), ball = new THREE.Mesh(new THREE.SphereGeometry(), new THREE.MeshStandardMaterial());
      scene.add(ball);
      other.render(scene, camera);
      scene.remove(ball);
      ball.geometry.dispose();
      ball.material.dispose();
      other.render(scene, camera);
      return {left: count(renderer), plain: count(other)};
    });
    check(left === plain && JSON.parse(left).geometries === 0 && JSON.parse(left).programs === 0, `disposed, it leaves ${left}, as a plain material does ${plain}`);
    await close();
  }
}

// A model that goes while it arrives.
async function testEarly(browser) {
  let release;
  const later = new Promise((next) => { release = next; });
  const {page, close} = await open(browser, 'home', {query: `${example}?url=/torus.lpm`, gate: (file) => (file.endsWith('.lpm') ? later : null)});
  await page.waitForFunction(() => window.example?.model.triangleCount > 0);
  const {arrived, left} = await page.evaluate(() => {
    const {model, renderer, scene, camera} = window.example, {arrived} = model;
    model.dispose();
    renderer.render(scene, camera);
    return {arrived, left: renderer.info.memory.geometries + renderer.info.programs.length};
  });
  release();
  check(arrived.bytes > 0 && arrived.bytes < arrived.all, `${arrived.bytes} of ${arrived.all} bytes are drawn`);
  check(left === 0 && await page.evaluate(() => window.example.model.update(window.example.camera, 100) === false), 'then it goes');
  await close();
}

async function testRefused(browser) {
  writeFileSync(path.join(home, 'bad.lpm'), 'not a model');
  const {page, close} = await open(browser, 'home', {query: example, expected: /404/});
  for (const [url, reason] of [['/bad.lpm', /^bad\.lpm: /], ['/none.lpm', /none\.lpm: cannot be loaded \(404/], ['/none/tileset.json', /cannot be loaded \(404/]]) {
    const text = await page.evaluate((at) => import('lodestone-web').then(({load}) => load(at)).then(() => 'loaded', (e) => e.message), url);
    check(reason.test(text) && !text.includes('\n'), text);
  }
  await close();
}

await main(makeFiles, [testInstall, testTypes, testExample, testEarly, testRefused], {bundle: false});
