// The run-time library of the page against the program on the same files, and its times in the browser; gltf-validator on
// what the program writes.
// usage: node test_library.mjs PROGRAM PAGE MODULES [MODEL...]   with models: of these, a row each, for docs/decisions/0028-page.md
import {execFileSync} from 'node:child_process';
import {copyFileSync, existsSync} from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {check, folder, main, modules, open, pageFolder, program, run, writeTorus} from './browser.mjs';

const here = path.dirname(fileURLToPath(import.meta.url)), models = process.argv.slice(5);
const files = [];

function makeFiles() {
  if (models.some((m) => !existsSync(m))) return false;
  const make = (input, output, ...more) => {
    run('progressive', input, '-o', output, ...more);
    files.push(output);
  };
  if (models.length > 0) {
    models.forEach((model, k) => {
      const name = `${k}_${path.parse(model).name}`;
      make(path.resolve(model), `${name}.lpm`);
      make(path.resolve(model), `${name}.glb`);
      make(path.resolve(model), `${name}.packed.glb`, '--compress');
    });
  } else {
    run('generate', 'sphere', '--triangles', '120000', '-o', 'large.ply');
    run('generate', 'sphere', '--triangles', '20000', '-o', 'sphere.ply');
    writeTorus(80, 50);
    make('sphere.ply', 'sphere.lpm', '--position-bits', '16');
    make('sphere.ply', 'sphere.glb');
    make('torus.obj', 'torus.lpm', '--metric', 'attribute-quadric');
    make('torus.obj', 'torus.glb');
    make('torus.obj', 'packed.glb', '--compress');
    run('progressive', 'large.ply', '-o', 'large.glb');
  }
  writeTorus(20, 10);
  run('page', 'torus.obj', '-o', 'page');
  copyFileSync(path.join(pageFolder, 'library.mjs'), path.join(folder, 'page/library.mjs'));
  return true;
}

function testSameResults() {
  const told = execFileSync('node', [path.join(here, 'same_levels.mjs'), program, folder, path.join(pageFolder, 'library.mjs'),
                                     ...files.map((f) => path.join(folder, f))], {encoding: 'utf8'});
  const {levels, vertices} = JSON.parse(told);
  check(levels === 7 * files.length, `${levels} levels and geomorphs of ${files.length} files (${vertices} vertices) are those of the program, index by index`);
}

// No error, and no warning but that a normal map comes without tangents.
function testValid() {
  if (!existsSync(path.join(modules, 'gltf-validator'))) {
    console.log('gltf-validator is not installed: not validated');
    return;
  }
  const validator = path.join(here, '../commands/validate_glb.cjs'), glb = files.filter((f) => f.endsWith('.glb'));
  const {files: count, issues} = JSON.parse(execFileSync('node', [validator, modules, folder], {encoding: 'utf8'}));
  check(count >= glb.length && issues.every((i) => i.includes('MESH_PRIMITIVE_GENERATED_TANGENT_SPACE')),
        `gltf-validator has nothing against ${count} files, ${issues.length} normal maps without tangents aside ${issues.filter((i) => !i.includes('TANGENT')).join('; ')}`);
}

// All geomorphs of a ladder, from the base to the top: the ancestors of all vertices, and with the attributes that the
// vertex shader takes from them (positions, normals, texture coordinates).
async function testTimes(browser) {
  const {page, close} = await open(browser, 'page');
  for (const file of models.length > 0 ? files.filter((f) => f.endsWith('.lpm')) : ['large.glb']) {
    copyFileSync(path.join(folder, file), path.join(folder, 'page', file));
    const {vertices, rungs, ancestors, attributes, level} = await page.evaluate(async (url) => {
      const {Ladder, LpmDecoder, readProgressiveGlb} = await import('./library.mjs');
      const bytes = new Uint8Array(await (await fetch(url)).arrayBuffer());
      const decoder = new LpmDecoder(url);
      const mesh = url.endsWith('.glb') ? await readProgressiveGlb(bytes, url) : (decoder.push(bytes), decoder.mesh());
      const ladder = new Ladder(mesh), sources = [[mesh.positions, 3], [new Float32Array(3 * mesh.vertexCount), 3], [new Float32Array(2 * mesh.vertexCount), 2]];
      const targets = sources.map(([array]) => array.slice());
      const all = (each) => {
        const begin = performance.now();
        for (let k = 0; k < ladder.top; ++k) each(ladder.rungs[k], ladder.rungs[k + 1]);
        return performance.now() - begin;
      };
      const fill = (coarse, fine) => {
        const ancestor = ladder.levels.computeGeomorph(coarse, fine);
        sources.forEach(([source, size], which) => {
          const target = targets[which];
          for (let v = 0; v < fine; ++v) for (let i = 0; i < size; ++i) target[size * v + i] = source[size * ancestor[v] + i];
        });
      };
      const rounds = (work) => Array.from({length: 15}, work).sort((a, b) => a - b);
      return {vertices: mesh.vertexCount, rungs: ladder.rungs.length,
              ancestors: rounds(() => all((coarse, fine) => ladder.levels.computeGeomorph(coarse, fine))), attributes: rounds(() => all(fill)),
              level: rounds(() => all((coarse, fine) => ladder.levels.computeLevel(fine)))};
    }, file);
    const told = (times) => `${times[7].toFixed(1)} (${times[0].toFixed(1)} to ${times[14].toFixed(1)})`;
    console.log(`| ${file} | ${vertices.toLocaleString('en')} | ${rungs} | ${told(ancestors)} | ${told(attributes)} | ${told(level)} |`);
    // The median is what counts; but where other work runs beside the tests, the best round tells more.
    if (vertices < 70000) check(attributes[0] < 60, `all geomorphs in ${attributes[0].toFixed(1)} ms in the browser, median ${attributes[7].toFixed(1)}`);
  }
  await close();
}

await main(makeFiles, [testSameResults, testValid, testTimes]);
