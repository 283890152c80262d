// Archives of tiles (.3tz): their bytes, the page that streams them, and damaged ones.
// usage: node test_archive.mjs PROGRAM PAGE MODULES
import {execFileSync} from 'node:child_process';
import {createHash} from 'node:crypto';
import {mkdirSync, readFileSync, readdirSync, statSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {check, folder, keep, main, open, pageFolder, run, writeTorus} from './browser.mjs';
import {serve} from './server.mjs';

const at = (name) => path.join(folder, name);
const files = (below, under = '') => readdirSync(path.join(below, under), {withFileTypes: true}).flatMap((f) =>
  (f.isDirectory() ? files(below, `${under}${f.name}/`) : [`${under}${f.name}`]));

function makeFiles() {
  writeTorus(160, 100);
  run('build', 'torus.obj', '-o', 'torus.lode', '--cell-triangles', '150');
  run('export', 'torus.lode', '--tiles', 'tiles', '--morph');
  run('export', 'torus.lode', '--tiles', 'torus.3tz', '--morph', '--threads', '1');
  run('page', 'tiles', '-o', 'loose');
  run('page', 'torus.3tz', '-o', 'packed');
}

// As the specification has it: stored files, and the last one an index by MD5.
function testFormat() {
  run('export', 'torus.lode', '--tiles', 'again.3tz', '--morph', '--threads', '4');
  const bytes = readFileSync(at('torus.3tz')), paths = files(at('tiles')).sort();
  check(bytes.equals(readFileSync(at('again.3tz'))), `${bytes.length} bytes, the same for any number of threads`);
  check(readdirSync(folder).every((name) => !name.includes('.files')), 'nothing is left beside it');
  const program = 'import sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); assert z.testzip() is None; ' +
    'assert all(i.compress_type == 0 for i in z.infolist()); print(*z.namelist(), sep="\\n")';
  const told = execFileSync('python3', ['-c', program, at('torus.3tz')], {encoding: 'utf8'}).trim().split('\n');
  check(told.at(-1) === '@3dtilesIndex1@' && told.slice(0, -1).join() === paths.join(), `a ZIP of the ${paths.length} files of the folder, the index at its end`);
  const name = Buffer.from('@3dtilesIndex1@'), last = bytes.lastIndexOf(name), first = bytes.indexOf(name), size = bytes.readUInt32LE(last - 46 + 24);
  const index = bytes.subarray(first + name.length, first + name.length + size);
  check(size === 24 * paths.length, 'the index has 24 bytes for each');
  let before = [0n, 0n];
  for (let k = 0; k < size; k += 24) {
    const key = [index.readBigUInt64LE(k), index.readBigUInt64LE(k + 8)], offset = Number(index.readBigUInt64LE(k + 16));
    if (!(key[0] > before[0] || (key[0] === before[0] && key[1] > before[1]))) throw new Error('the index is not in order');
    before = key;
    const length = bytes.readUInt16LE(offset + 26), own = bytes.subarray(offset + 30, offset + 30 + length);
    if (!createHash('md5').update(own).digest().equals(index.subarray(k, k + 16))) throw new Error(`the index is wrong about ${own}`);
    const content = bytes.subarray(offset + 30 + length, offset + 30 + length + bytes.readUInt32LE(offset + 18));
    if (!content.equals(readFileSync(at(`tiles/${own}`)))) throw new Error(`${own} is another`);
  }
  check(true, 'all paths are found by their MD5, and the files are those of the folder');
}

// The page from afar takes a part of the archive; it draws what it draws of the folder.
async function testPage(browser) {
  const size = statSync(at('torus.3tz')).size;
  const view = async (name, more) => {
    const {page, quiet, close, triangles} = await open(browser, name, more);
    await quiet();
    await page.fill('#pixels', '20');
    if (!await page.isChecked('#automatic')) await page.click('label:has(#automatic)');
    await page.evaluate(() => {
      const {camera, controls} = window.lodestone;
      controls.maxDistance = 100;
      camera.position.set(0, 3, 20);
      controls.update();
    });
    await quiet();
    await page.evaluate(() => window.lodestone.frameAll());
    await page.fill('#pixels', '3');
    await quiet();
    await keep(page, 'picture');
    const found = {count: await triangles(), picture: await page.evaluate(() => [...window.kept.picture].join())};
    await close();
    return found;
  };
  const loose = await view('loose', {});
  for (const ranges of [true, false]) {
    let bytes = 0, answers = 0;
    const sent = (count, file) => { if (file.endsWith('.3tz')) [bytes, answers] = [bytes + count, answers + 1]; };
    const packed = await view('packed', {ranges, sent});
    check(packed.count === loose.count && packed.picture === loose.picture, `${packed.count} triangles, the picture is that of the folder`);
    if (ranges) check(answers > 5 && bytes < size + 70000, `${answers} parts, ${bytes} of ${size} bytes`);
    else check(answers >= 1 && bytes === answers * size, `a server without ranges sends all of it, ${answers} times`);
  }
}

// Whatever bytes change, a file comes as it was, or there is one line that begins with the address.
async function testDamaged() {
  const {Archive} = await import(pathToFileURL(path.join(pageFolder, 'library.mjs')));
  mkdirSync(at('bad'));
  const bytes = readFileSync(at('torus.3tz')), paths = files(at('tiles')), {port, close} = await serve(at('bad'));
  const url = `http://127.0.0.1:${port}/bad.3tz`, problem = (work) => work().then(() => null, (e) => e.message);
  const tell = (changed, name) => {
    writeFileSync(at('bad/bad.3tz'), changed);
    return problem(async () => {
      const content = await (await Archive.open(url)).get(`${url}/${name}`);
      if (!readFileSync(at(`tiles/${name}`)).equals(Buffer.from(content))) throw new Error('another content without a word');
    });
  };
  check(await tell(bytes, 'tileset.json') === null, 'the archive itself is read');
  for (const changed of [bytes.subarray(0, 5000), Buffer.alloc(0)])
    check(/bad\.3tz: it has no list of files; the archive is damaged$/.test(await tell(changed, 'tileset.json')), `of ${changed.length} bytes it is not`);
  const broken = Buffer.from(bytes), where = broken.indexOf('0/0_0_0.glb') + 40;
  broken[where] ^= 1;
  check(/bad\.3tz: 0\/0_0_0\.glb: the checksum is wrong; the archive is damaged$/.test(await tell(broken, '0/0_0_0.glb')), 'a bit that changed is told');
  check(/bad\.3tz: no\.glb: is not in the archive/.test(await problem(async () => (await Archive.open(url)).get(`${url}/no.glb`))), 'so is a file that is missing');
  let told = 0, state = 7;
  for (let k = 0; k < 300; ++k) {
    const changed = Buffer.from(bytes);
    for (let n = 0; n < 3; ++n) {
      state = state * 48271 % 2147483647;
      changed[bytes.length - 1 - state % 9000] = state >> 8 & 255;
    }
    const text = await tell(changed, paths[state % paths.length]);
    told += text === null ? 0 : 1;
    if (text !== null && !(text.startsWith(url) && !text.includes('\n') && !/undefined|NaN|RangeError|TypeError|DataView/.test(text))) throw new Error(text);
  }
  check(told > 20, `300 damaged lists of files: ${told} are told in one line, the others change nothing of the file`);
  close();
}

await main(makeFiles, [testFormat, testPage, testDamaged]);
