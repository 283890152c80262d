// The report in headless Chromium, from disk: nothing in the console, tables sort and filter, pictures enlarge, data is saved,
// and no page is wider than its window.
// usage: node test_report.mjs PROGRAM PAGE MODULES PYTHON MAKER [SCREENSHOTS]
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {check, folder, main, run} from './browser.mjs';

const [python, maker, screenshots] = process.argv.slice(5), file = path.join(folder, 'report.html');

function makeFiles() {
  execFileSync(python, ['-B', maker, path.join(folder, 'ablation')]);
  run('report', 'ablation', '-o', file, '--csv', 'rows.csv', '--json', 'rows.json');
}

// The page from disk; the test fails on any word in its console and on any request but that of the page itself.
async function open(browser, options = {}) {
  const context = await browser.newContext({viewport: {width: 1366, height: 900}, acceptDownloads: true, ...options});
  const page = await context.newPage(), faults = [];
  page.on('console', (m) => faults.push(m.text()));
  page.on('pageerror', (e) => faults.push(e.message));
  page.on('request', (r) => { if (!r.url().startsWith('data:') && !r.url().startsWith('blob:') && r.url() !== pathToFileURL(file).href) faults.push(r.url()); });
  await page.goto(pathToFileURL(file).href);
  return {page, close: async () => {
    await context.close();
    check(faults.length === 0, `nothing in the console, nothing asked for: ${faults.join('; ')}`);
  }};
}

const table = (page, caption) => page.locator('table', {has: page.locator(`caption:has-text("${caption}")`)});
// Texts of a column, without the small print of ranges.
const column = (page, caption, name) => table(page, caption).evaluate((t, heading) => {
  const index = [...t.tHead.rows[0].cells].findIndex((c) => c.textContent.startsWith(heading));
  return [...t.tBodies[0].rows].filter((r) => !r.hidden).map((r) => r.cells[index].firstChild.textContent.trim());
}, name);
const numbers = (texts) => texts.map((t) => Number(t.replaceAll(',', '')));
const rising = (values) => values.every((v, k) => k === 0 || values[k - 1] <= v);

async function testSorting(browser) {
  const {page, close} = await open(browser);
  const heading = (name) => table(page, 'Sweep border').locator('thead th', {hasText: name});
  await heading('triangles').locator('button').click();
  check(await heading('triangles').getAttribute('aria-sort') === 'ascending', 'a click sorts, and says so');
  const triangles = numbers(await column(page, 'Sweep border', 'triangles'));
  check(triangles.length === 25 && rising(triangles), 'by value, not by letters');
  await heading('triangles').locator('button').press('Enter');
  check(rising(numbers(await column(page, 'Sweep border', 'triangles')).reverse()), 'the keyboard turns the order');
  await heading('blend').locator('button').press('Space');
  const blends = await column(page, 'Sweep border', 'blend');
  check(rising(blends) && blends[0] === 'linear', 'texts sort, too');
  check(await heading('triangles').getAttribute('aria-sort') === 'none', 'one column at a time');
  await close();
}

async function testFilter(browser) {
  const {page, close} = await open(browser);
  await page.getByRole('searchbox', {name: /Sweep border/}).fill('ARMADILLO step');
  const data = await column(page, 'Sweep border', 'data');
  check(data.length === 6 && data.every((d) => d === 'armadillo <1>'), `every word must be in a row: ${data.length} are left`);
  check(await page.getByText('6 of 25 rows').isVisible(), 'and the number is said');
  await page.getByRole('searchbox', {name: /Sweep border/}).fill('');
  check((await column(page, 'Sweep border', 'data')).length === 25, 'an empty filter shows all');
  await close();
}

async function testPictures(browser) {
  const {page, close} = await open(browser);
  const sizes = await page.locator('.picture img').evaluateAll(async (images) => {
    await Promise.all(images.map((image) => image.decode()));
    return images.map((image) => image.naturalWidth);
  });
  check(sizes.filter((w) => w === 160).length === 8 && sizes.filter((w) => w === 1).length === 4, 'all pictures decode');
  await page.locator('.picture button').first().click();
  check(await page.locator('dialog[open] img').isVisible(), 'a click enlarges a picture');
  await page.keyboard.press('Escape');
  check(await page.locator('dialog[open]').count() === 0, 'Escape closes it');
  await close();
}

async function testSaving(browser) {
  const {page, close} = await open(browser);
  for (const kind of ['csv', 'json']) {
    const [saved] = await Promise.all([page.waitForEvent('download'), page.click(`[data-save=${kind}]`)]);
    const text = readFileSync(await saved.path(), 'utf8'), written = readFileSync(path.join(folder, `rows.${kind}`), 'utf8');
    check(saved.suggestedFilename() === `report.${kind}`, `report.${kind} is saved`);
    check(kind === 'csv' ? text === written : JSON.stringify(JSON.parse(text)) === JSON.stringify(JSON.parse(written)), 'as --csv and --json write it');
  }
  await close();
}

async function testPlots(browser) {
  const {page, close} = await open(browser);
  const seen = await page.evaluate(() => [...document.querySelectorAll('.plot')].map((plot) => ({
    name: plot.querySelector('[role=img]')?.getAttribute('aria-label') ?? '', svg: plot.querySelectorAll('svg').length,
    shown: [...plot.querySelectorAll('svg')].filter((s) => s.getBoundingClientRect().width > 0).length,
    points: plot.querySelectorAll('.wide title').length})));
  if (seen.every((plot) => plot.svg === 0)) {
    check(await page.getByText('python3-matplotlib').isVisible(), 'without matplotlib a note takes the place of plots');
  } else {
    check(seen.length === 6 && seen.every((plot) => plot.shown === 1), 'each figure is drawn once');
    check(seen.every((plot) => plot.name.length > 40), 'and told in words');
    check(seen.every((plot) => plot.points >= 8), 'points say what they are');
  }
  await close();
}

// The report in windows of other sizes, and in the dark scheme.
async function testLayout(browser) {
  for (const [width, colorScheme] of [[1366, 'light'], [1366, 'dark'], [390, 'light'], [390, 'dark'], [320, 'light']]) {
    const {page, close} = await open(browser, {viewport: {width, height: 844}, colorScheme, hasTouch: width < 500});
    await page.evaluate(() => document.querySelectorAll('details').forEach((d) => { d.open = true; }));
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    check(wide <= width, `${width} ${colorScheme}: the page is ${wide} wide`);
    const cut = await page.evaluate(() => [...document.querySelectorAll('main *:not(.scroll *):not(svg *)')]
      .filter((e) => e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.outerHTML.slice(0, 80)));
    check(cut.length === 0, `nothing sticks out: ${cut.slice(0, 3).join(' ')}`);
    const contrast = await page.evaluate(() => {
      const light = (colour) => colour.match(/[\d.]+/g).slice(0, 3).map((c) => c / 255)
        .map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4).reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
      const paper = light(getComputedStyle(document.body).backgroundColor);
      return Math.min(...[...document.querySelectorAll('main :is(h1, p, dd, td, th, small, a, summary, figcaption, caption)')].map((e) => {
        const ink = light(getComputedStyle(e).color);
        return (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
      }));
    });
    check(contrast > 4.5, `text stands out from the paper: ${contrast.toFixed(1)} to 1`);
    if (screenshots) await page.screenshot({path: path.join(screenshots, `report-${width}-${colorScheme}.png`), fullPage: true});
    await close();
  }
}

async function testWithoutScript(browser) {
  const context = await browser.newContext({javaScriptEnabled: false}), page = await context.newPage();
  await page.goto(pathToFileURL(file).href);
  check(await page.getByText('Cracks below and above the border').first().isVisible(), 'the page is whole without its script');
  check(await page.locator('[data-save=csv]').isHidden(), 'and offers nothing that needs it');
  await context.close();
}

await main(makeFiles, [testSorting, testFilter, testPictures, testSaving, testPlots, testLayout, testWithoutScript], {bundle: false});
