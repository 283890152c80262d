// What the page shows of surfaces, where it looks, what its address tells, and what a screen reader hears.
// usage: node test_view.mjs PROGRAM PAGE MODULES
import {check, differ, keep, main, open, run, writeTorus} from './browser.mjs';

function makeFiles() {
  writeTorus(80, 50);
  run('progressive', 'torus.obj', '-o', 'torus.lpm');
  run('build', 'torus.obj', '-o', 'tiles.lode', '--cell-triangles', '250');
  run('page', 'torus.lpm', '-o', 'one');
  run('page', 'tiles.lode', '-o', 'tiles');
}

// The middle one of the rows in which a column of the canvas shows the model.
const rowOf = (page, column) => page.evaluate((x) => {
  const gl = window.lodestone.renderer.getContext(), {height} = gl.canvas, out = new Uint8Array(4 * height);
  gl.readPixels(x, 0, 1, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  const rows = [...Array(height).keys()].filter((y) => out[4 * (height - 1 - y) + 3] === 255);
  return rows[rows.length >> 1];
}, column);

async function testLooks(browser) {
  for (const name of ['one', 'tiles']) {
    const {page, quiet, close, triangles} = await open(browser, name);
    await quiet();
    await keep(page, 'light');
    await page.selectOption('#look', 'colours');
    await quiet();
    await keep(page, 'colours');
    // The squares of the texture have one colour each, however light falls: many pixels are exactly it.
    const squares = (key) => page.evaluate((k) => {
      const p = window.kept[k];
      let count = 0;
      for (let i = 0; i < p.length; i += 4) count += Math.abs(p[i] - 220) < 2 && Math.abs(p[i + 1] - 60) < 2 && Math.abs(p[i + 2] - 40) < 2 ? 1 : 0;
      return count;
    }, key);
    check(await squares('colours') > 1000 && await squares('light') < 200, `${name}: ${await squares('colours')} pixels have the colour of the texture, ${await squares('light')} in the light`);
    await page.locator('#view').focus();
    await page.keyboard.press('v');
    await quiet();
    await keep(page, 'normals');
    const facing = await page.evaluate(() => {
      const p = window.kept.normals;
      let sum = 0, blue = 0;
      for (let i = 0; i < p.length; i += 4) {
        if (p[i + 3] < 255) continue;
        ++sum;
        const n = [p[i], p[i + 1], p[i + 2]].map((x) => x / 127.5 - 1);
        blue += Math.abs(Math.hypot(...n) - 1) < 0.05 && n[2] > -0.1 ? 1 : 0;
      }
      return blue / sum;
    });
    check(facing > 0.9, `${name}: ${(100 * facing).toFixed(1)} % of the pixels are unit normals that face the viewer`);
    await page.selectOption('#look', 'light');
    await quiet();
    await keep(page, 'again');
    check(await differ(page, 'light', 'again', 0) === 0, 'and back to light');
    // Edges are over the surface: what is between them remains.
    const count = await triangles();
    await page.evaluate(() => { document.getElementById('level').value = 300; document.getElementById('level').dispatchEvent(new Event('input')); });
    await quiet();
    await keep(page, 'coarse');
    await page.locator('#view').focus();
    await page.keyboard.press('e');
    await quiet();
    await keep(page, 'edges');
    const lines = await differ(page, 'coarse', 'edges', 40), rest = await page.evaluate(() => {
      const [a, b] = [window.kept.coarse, window.kept.edges];
      let same = 0, covered = 0;
      for (let i = 0; i < a.length; i += 4) {
        if (a[i + 3] < 255) continue;
        ++covered;
        same += [0, 1, 2].every((k) => Math.abs(a[i + k] - b[i + k]) < 8) ? 1 : 0;
      }
      return same / covered;
    });
    check(await triangles() < count && lines > 0.003 && rest > 0.3, `${name}: edges take ${lines.toFixed(3)} of the picture, ${rest.toFixed(2)} of the surface remains`);
    await close();
  }
}

// A link shows what its sender saw.
async function testShared(browser) {
  const first = await open(browser, 'one');
  await first.quiet();
  check(new URL(first.page.url()).hash === '', 'an address by itself has no view');
  await first.page.mouse.move(240, 120);
  await first.page.mouse.down();
  await first.page.mouse.move(320, 150, {steps: 4});
  await first.page.mouse.up();
  await first.page.locator('#view').focus();
  await first.page.keyboard.press('PageDown');
  await first.page.selectOption('#look', 'colours');
  await first.page.click('label:has(#edges)');
  await first.quiet();
  await first.page.mouse.move(5, 5);
  const {hash} = new URL(first.page.url()), picture = await keep(first.page, 'first');
  check(/^#camera=[-\d.e]+(,[-\d.e]+){5}&level=0\.9&look=colours&edges$/.test(hash), hash);
  const second = await open(browser, 'one', {query: hash});
  await second.quiet();
  const off = (await keep(second.page, 'second')).filter((x, k) => Math.abs(x - picture[k]) > 8).length / picture.length;  // of seven digits
  check(off < 0.01, `the same picture: ${off} of it differ`);
  await second.page.waitForFunction((same) => location.hash === same, hash);  // it is written a while after changes
  await second.page.keyboard.press('h');
  await second.page.selectOption('#look', 'light');
  await second.page.click('label:has(#edges)');
  await second.page.evaluate(() => window.lodestone.setSlider(1));
  await second.quiet();
  check(new URL(second.page.url()).hash === '', 'the view by itself again, and nothing is left in the address');
  await second.page.evaluate(() => { location.hash = 'pixels=8'; });
  await second.page.waitForFunction(() => window.lodestone.automatic);
  await second.quiet();
  check(await second.page.inputValue('#pixels') === '8', 'an address that is changed is followed');
  for (const strange of ['camera=1,2,x,4,5,6&level=no&look=nothing', 'camera=1e999,0,0,0,0,0&pixels=', '%%%&=&&']) {
    const page = await open(browser, 'one', {query: `#${strange}`});
    await page.quiet();
    check(await page.page.inputValue('#look') === 'light' && !await page.page.isVisible('#message') && await page.triangles() === 8000, `strange values do nothing: ${strange}`);
    await page.close();
  }
  await first.close();
  await second.close();
}

// The point that is clicked twice is in the middle, nearer; where there is nothing, nothing happens.
async function testFocus(browser) {
  for (const name of ['one', 'tiles']) {
    const {page, quiet, close} = await open(browser, name);
    await quiet();
    const state = () => page.evaluate(() => {
      const {camera, controls} = window.lodestone;
      return {target: controls.target.toArray(), distance: camera.position.distanceTo(controls.target)};
    });
    const before = await state(), box = await page.locator('#view').boundingBox();
    await page.mouse.dblclick(box.x + 4, box.y + 4);
    await quiet();
    check(JSON.stringify(await state()) === JSON.stringify(before), 'beside the model nothing happens');
    const column = Math.round(0.44 * box.width);
    await page.mouse.dblclick(box.x + column, box.y + await rowOf(page, column));
    await quiet();
    const after = await state(), moved = Math.hypot(...after.target.map((t, k) => t - before.target[k]));
    check(moved > 0.05 && moved < 0.8 && after.distance < 0.55 * before.distance, `${name}: the target moves by ${moved.toFixed(2)}, to ${(after.distance / before.distance).toFixed(2)} of the distance`);
    await close();
  }
}

// Zooming in ends at the surface, however it is done: the picture is full of it, seen from outside; and zooming out shows
// the whole model again.
async function testZoom(browser) {
  for (const name of ['one', 'tiles']) {
    const {page, quiet, close} = await open(browser, name, {hasTouch: true});
    await quiet();
    const box = await page.locator('#view').boundingBox(), x = Math.round(0.44 * box.width), y = await rowOf(page, x);
    await page.mouse.dblclick(box.x + x, box.y + y);  // there is a hole in the middle of a torus
    await page.selectOption('#look', 'normals');
    await quiet();
    const middle = [box.x + box.width / 2, box.y + box.height / 2], session = await page.context().newCDPSession(page);
    const fingers = (type, apart) => session.send('Input.dispatchTouchEvent', {
      type, touchPoints: (apart === null ? [] : [-apart, apart]).map((dx, id) => ({x: middle[0] + dx, y: middle[1], id}))});
    const pinch = async (from, to) => {
      await fingers('touchStart', from);
      for (let k = 1; k <= 8; ++k) await fingers('touchMove', from + (to - from) * k / 8);
      await fingers('touchEnd', null);
    };
    const ways = {
      wheel: async (nearer) => { await page.mouse.move(...middle); for (let k = 0; k < 8; ++k) await page.mouse.wheel(0, nearer ? -400 : 400); },
      pinch: (nearer) => nearer ? pinch(10, 150) : pinch(150, 10),
      keys: async (nearer) => { for (let k = 0; k < 12; ++k) await page.keyboard.press(nearer ? '+' : '-'); }};
    const seen = async () => {
      await quiet();
      return page.evaluate(() => {
        const gl = window.lodestone.renderer.getContext(), {width, height} = gl.canvas, p = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, p);
        let covered = 0, facing = 0;
        for (let i = 0; i < p.length; i += 4) {
          covered += p[i + 3] === 255 ? 1 : 0;
          facing += p[i + 3] === 255 && p[i + 2] > 120 ? 1 : 0;  // unit normals towards the eye
        }
        const {camera, controls} = window.lodestone;
        return {distance: camera.position.distanceTo(controls.target), covered: covered / (width * height), facing: facing / covered};
      });
    };
    for (const [way, zoom] of Object.entries(ways)) {
      await page.locator('#view').focus();
      let last = (await seen()).distance, steps = 0;
      for (; steps < 40 && last > 1.01e-4; ++steps) {
        await zoom(true);
        const {distance} = await seen();
        check(distance < 0.7 * last || distance < 1.01e-4, `${name}, ${way}: from ${last.toPrecision(3)} to ${distance.toPrecision(3)}`);
        last = distance;
      }
      const near = await seen();
      check(near.distance < 1.01e-4 && near.covered > 0.99 && near.facing > 0.95, `${name}: ${way} ends at ${near.distance.toPrecision(3)}, ${near.covered.toFixed(3)} covered, ${near.facing.toFixed(3)} of it facing the eye`);
      for (let k = 0; k < 40 && (await seen()).distance < 3; ++k) await zoom(false);
      const far = await seen();
      check(far.distance > 3 && far.covered > 3e-4 && far.covered < 0.6, `${name}: ${way} goes back to ${far.distance.toPrecision(3)}, where the model covers ${far.covered.toFixed(4)}`);
    }
    await close();
  }
}

// Everything that can be reached has a role and a name.
async function testAccessibility(browser) {
  const {page, quiet, close} = await open(browser, 'one');
  await quiet();
  const tree = await page.locator('body').ariaSnapshot();
  for (const part of ['application "Models. Drag', 'button "torus', 'form "View"', 'slider "Level, from coarse to fine"', 'status "Triangles drawn": 8,000 triangles',
                      'checkbox "Automatic"', 'spinbutton "Pixels of error"', 'checkbox "Edges"', 'combobox "What is drawn of surfaces"', 'button "Show all"', 'button "Full screen"', 'button "Keys"'])
    check(tree.includes(part), part);
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input, select, output, progress, canvas, dialog')].filter((e) => {
    const label = e.getAttribute('aria-label') ?? e.getAttribute('aria-labelledby') ?? e.closest('label')?.textContent ?? e.textContent;
    return !label?.trim();
  }).map((e) => e.outerHTML));
  check(nameless.length === 0, `everything has a name ${nameless.join()}`);
  check(await page.getAttribute('#level', 'aria-valuetext') === '8,000 triangles', 'the slider tells triangles');
  await page.keyboard.press('?');
  check((await page.locator('#help').ariaSnapshot()).includes('dialog "Keys"'), 'help is a dialog with a name');
  await page.keyboard.press('Escape');
  await page.evaluate(() => window.lodestone.say('something is wrong'));
  check(/alert:[^]*something is wrong/.test(await page.locator('body').ariaSnapshot()), 'errors are alerts');
  await close();
}

await main(makeFiles, [testFocus, testZoom, testAccessibility, testLooks, testShared]);
