// What is in the window, from a phone to a desk: nothing is outside it, cut, or over something else.
// usage: node test_layout.mjs PROGRAM PAGE MODULES [PICTURES]   with a folder for the pictures
import {mkdirSync} from 'node:fs';
import path from 'node:path';
import {check, main, open, run, writeTorus} from './browser.mjs';

const SIZES = [[390, 844], [768, 1024], [1100, 700], [800, 500]];

const pictures = process.argv[5];
async function picture(page, name) {
  if (!pictures) return;
  mkdirSync(pictures, {recursive: true});
  await page.screenshot({path: path.join(pictures, `${name}.png`)});
}

function makeFiles() {
  writeTorus(40, 24);
  run('progressive', 'torus.obj', '-o', 'torus.lpm');
  run('build', 'torus.obj', '-o', 'tiles.lode', '--cell-triangles', '250');
  run('spherical', 'torus.obj', '-o', 'spherical.lpm', '--texture', '64', '--triangles', '400');
  for (const name of ['torus.lpm', 'tiles.lode', 'spherical.lpm']) run('page', name, '-o', path.parse(name).name);
  const names = Array.from({length: 8}, (_, k) => (k === 5 ? 'a_name_that_is_too_long_for_a_label' : `sphere_${k}`));
  run('generate', 'sphere', '--triangles', '2000', '-o', 'sphere.ply');
  for (const name of names) run('progressive', 'sphere.ply', '-o', `${name}.lpm`);
  run('page', ...names.map((name) => `${name}.lpm`), '-o', 'eight');
}

// What is wrong with the elements of a selector that are shown: outside the window, narrower than their text, or over
// another of them.
const faults = (page, selector) => page.evaluate((s) => {
  const shown = [...document.querySelectorAll(s)].filter((e) => e.checkVisibility({checkVisibilityCSS: true}));
  const name = (e) => e.id || e.textContent, boxes = shown.map((e) => e.getBoundingClientRect()), out = shown.length > 0 ? [] : ['nothing is shown'];
  boxes.forEach(({left, right, top, bottom}, k) => {
    if (left < 0 || top < 0 || right > innerWidth || bottom > innerHeight) out.push(`${name(shown[k])} is outside`);
    if (getComputedStyle(shown[k]).textOverflow !== 'ellipsis' && shown[k].scrollWidth > shown[k].clientWidth + 1) out.push(`${name(shown[k])} is cut`);
    boxes.slice(0, k).forEach((b, i) => {
      if (left < b.right - 0.5 && b.left < right - 0.5 && top < b.bottom - 0.5 && b.top < bottom - 0.5) out.push(`${name(shown[i])} and ${name(shown[k])}`);
    });
  });
  return out;
}, selector);

const CONTROLS = '#levels, #count, #choices > *, #labels button';

async function testControls(browser) {
  for (const name of ['torus', 'tiles', 'spherical'])
    for (const [width, height] of SIZES) {
      const {page, quiet, close} = await open(browser, name, {viewport: {width, height}});
      await quiet();
      const at = `${name} ${width}x${height}`;
      await picture(page, at);
      let found = await faults(page, CONTROLS);
      check(found.length === 0, `${at}: controls are in the window and apart ${found}`);
      // The widest texts: the number while all is drawn, and the longest look.
      await page.evaluate(() => {
        document.getElementById('count').textContent = '123,456,789 triangles';
        document.getElementById('pixels').value = '12.5';
      });
      await page.selectOption('#look', 'colours');
      found = await faults(page, '#levels, #count, #choices > *');
      check(found.length === 0, `${at}: so they are with long texts ${found}`);
      await close();
    }
}

// Labels are below their models, in the window, whole or shortened with three dots, and on nothing else.
async function testLabels(browser) {
  for (const [width, height] of SIZES) {
    const {page, quiet, close} = await open(browser, 'eight', {viewport: {width, height}});
    await quiet();
    const at = `eight ${width}x${height}`;
    await picture(page, at);
    const labels = () => page.locator('#labels button:visible').count();
    let found = await faults(page, '#labels button');
    check(found.length === 0 && await labels() === 8, `${at}: ${await labels()} labels are apart ${found}`);
    found = await page.evaluate(() => {
      const gl = window.lodestone.renderer.getContext();
      return [...document.querySelectorAll('#labels button')].filter((e) => {
        const {left, bottom, width: w, height: h} = e.getBoundingClientRect(), out = new Uint8Array(4 * Math.ceil(w) * Math.ceil(h));
        gl.readPixels(left, gl.canvas.height - bottom, Math.ceil(w), Math.ceil(h), gl.RGBA, gl.UNSIGNED_BYTE, out);
        return out.some((x) => x > 0);
      }).map((e) => e.textContent);
    });
    check(found.length === 0, `${at}: no label is over a sphere ${found}`);
    await page.locator('#view').focus();
    for (const [key, times] of [['-', 12], ['+', 24]]) {
      for (let k = 0; k < times; ++k) await page.keyboard.press(key);
      await quiet();
      found = (await labels()) === 0 ? [] : await faults(page, '#labels button');
      check(found.length === 0, `${at}: after ${key} ${await labels()} labels are in the window and apart ${found}`);
    }
    await close();
  }
}

async function testHelp(browser) {
  for (const [width, height] of SIZES) {
    const {page, quiet, close} = await open(browser, 'torus', {viewport: {width, height}});
    await quiet();
    await page.locator('#view').focus();
    await page.keyboard.press('?');
    const found = await faults(page, '#help dt, #help dd, #help button');
    check(found.length === 0, `${width}x${height}: ? shows the keys in the window ${found}`);
    await picture(page, `help ${width}x${height}`);
    const level = await page.inputValue('#level');
    await page.keyboard.press('PageDown');
    check(await page.inputValue('#level') === level, 'keys are the help\'s while it is shown');
    await page.keyboard.press('Escape');
    check(!await page.isVisible('#help'), 'Escape closes it');
    await page.keyboard.press('f');
    await page.waitForFunction(() => document.fullscreenElement !== null);
    await page.keyboard.press('f');
    await page.waitForFunction(() => document.fullscreenElement === null);
    await close();
  }
}

async function testMessage(browser) {
  for (const [width, height] of SIZES) {
    const {page, quiet, close} = await open(browser, 'torus', {viewport: {width, height}});
    await quiet();
    await page.evaluate(() => {
      for (let k = 0; k < 4; ++k) window.lodestone.say(`a_long_name_without_any_place_to_break_it_${k}.lpm: the file ends too early; it is damaged or was cut off`);
    });
    const found = await faults(page, '#text, #dismiss');
    check(found.length === 0, `${width}x${height}: four errors are in the window ${found}`);
    await picture(page, `message ${width}x${height}`);
    await page.click('#dismiss');
    check(!await page.isVisible('#message'), 'and can be dismissed');
    await close();
  }
}

await main(makeFiles, [testControls, testLabels, testHelp, testMessage]);
