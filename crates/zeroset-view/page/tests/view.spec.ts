/** What a user does with the mouse. Positions are on the files of the fixture: a box from the origin to (1, 0.8, 0.6), and a torus around the origin. */

import { readFileSync } from 'node:fs';

import type { Vec3 } from '../src/protocol';
import { drop, expect, test, type View } from './fixture';

/** Seen from the corner that the camera starts at. */
const BOX_TOP: Vec3[] = [[0.5, 0.4, 0.6], [0.25, 0.6, 0.6], [0.75, 0.2, 0.6]];
/** Picked points of the clouds lie within a few of their spacings of what was aimed at. */
const NEAR = 0.05;

const away = (a: number[], b: number[]) => Math.hypot(...a.map((c, i) => c - b[i]));

async function clickAt({ page, place }: View, world: Vec3): Promise<void> {
  const [x, y] = await place(world);
  await page.mouse.click(x, y);
}

/** So long after a click the next one is no double click. */
async function clickAll(view: View, positions: Vec3[]): Promise<void> {
  for (const position of positions) {
    await clickAt(view, position);
    await view.page.waitForTimeout(400);
  }
}

test('opens with all layers and tells what it draws', async ({ view: { page } }) => {
  const layers = await page.evaluate(() => window.zeroset.layers);
  expect(new Set(layers.map(({ kind }) => kind))).toEqual(new Set(['points', 'planes', 'lines']));
  await expect(page.getByTestId('title')).toContainText('torus.laz');
  await expect(page.getByTestId('status')).toHaveText(/^\d+ draw calls?, .+ of .+ points, \d+ nodes?$/);
  const { points, of, drawCalls } = await page.evaluate(() => window.zeroset.frame);
  expect(points).toBeLessThanOrEqual(of);
  expect(drawCalls).toBeGreaterThan(0);
});

test('an idle page draws nothing', async ({ view: { page } }) => {
  const drawn = () => page.evaluate(() => window.zeroset.frame.drawn);
  const before = await drawn();
  await page.waitForTimeout(1000);
  expect(await drawn()).toBe(before);
});

test('hides and shows a layer', async ({ view: { page, settled } }) => {
  const [cloud] = await page.evaluate(() => window.zeroset.layers.filter(({ kind }) => kind === 'points'));
  const all = await page.evaluate(() => window.zeroset.frame.of);
  const eye = page.getByTestId(`eye-${cloud.id}`);
  await eye.click();
  await expect(eye).toHaveAttribute('aria-pressed', 'false');
  await settled();
  expect(await page.evaluate(() => window.zeroset.frame.of)).toBe(all - cloud.count);
  await eye.click();
  await expect(eye).toHaveAttribute('aria-pressed', 'true');
});

test('colours a layer and shows the legend', async ({ view: { page, settled } }) => {
  const cloud = await page.evaluate(() => window.zeroset.layers.find(({ name }) => name === 'torus.laz'));
  const select = page.getByTestId(`color-${cloud?.id}`);
  await select.selectOption('height');
  await settled();
  await expect(page.getByTestId('legend')).toBeVisible();
  await expect(page.getByTestId('legend')).toHaveAttribute('aria-label', /height/);
  expect(await page.evaluate((id) => window.zeroset.layers.find((layer) => layer.id === id)?.color, cloud?.id)).toBe('height');
  await select.selectOption({ label: 'plain' });
  await expect(page.getByTestId('legend')).toBeHidden();
});

test('turns, moves and zooms by the mouse', async ({ view: { page } }) => {
  const camera = () => page.evaluate(() => window.zeroset.camera);
  const start = await camera();
  const drag = async (button: 'left' | 'right') => {
    await page.mouse.move(600, 400);
    await page.mouse.down({ button });
    await page.mouse.move(660, 440, { steps: 4 });
    await page.mouse.up({ button });
  };
  await drag('left');
  const turned = await camera();
  expect(turned.azimuth).toBeGreaterThan(start.azimuth);
  expect(turned.elevation).toBeGreaterThan(start.elevation);
  expect(turned.target).toEqual(start.target);
  await drag('right');
  const moved = await camera();
  expect(away(moved.target, turned.target)).toBeGreaterThan(0);
  await page.mouse.wheel(0, -300);
  await expect.poll(async () => (await camera()).distance).toBeLessThan(moved.distance);
  await page.getByTestId('view-top').click();
  expect((await camera()).elevation).toBeCloseTo(90);
  await page.getByTestId('parallel').click();
  expect((await camera()).isParallel).toBe(true);
});

test('zooms to what is under the cursor, which stays there', async ({ view: { page, place } }) => {
  const [x, y] = await place(BOX_TOP[1]);
  await page.mouse.move(x, y);
  await page.mouse.wheel(0, -200);
  await expect.poll(async () => away(await place(BOX_TOP[1]), [x, y])).toBeLessThan(3);
});

test('tells what was clicked', async ({ view }) => {
  const { page } = view;
  await clickAt(view, BOX_TOP[0]);
  await expect(page.getByTestId('picked')).toBeVisible();
  const picked = await page.evaluate(() => window.zeroset.picked);
  expect(away(picked?.world ?? [], BOX_TOP[0])).toBeLessThan(NEAR);
  await expect(page.getByTestId('picked-values')).toContainText(picked?.world[0].toFixed(3) ?? '');
  await page.getByTestId('picked-close').click();
  await expect(page.getByTestId('picked')).toBeHidden();
});

test('tells the numbers of a plane', async ({ view }) => {
  const { page } = view;
  for (const { id, kind } of await page.evaluate(() => window.zeroset.layers)) {
    if (kind !== 'planes') {
      await page.getByTestId(`eye-${id}`).click();
    }
  }
  await clickAt(view, BOX_TOP[0]);
  await expect(page.getByTestId('picked-plane')).toContainText('level');
  await expect(page.getByTestId('picked-plane')).toContainText('area');
});

test('measures a distance and an angle', async ({ view }) => {
  const { page } = view;
  await page.getByTestId('tool-distance').click();
  await clickAll(view, BOX_TOP);
  await page.keyboard.press('Enter');
  await page.getByTestId('tool-angle').click();
  await clickAll(view, [BOX_TOP[1], BOX_TOP[0], BOX_TOP[2]]);
  const [distance, angle] = await page.evaluate(() => window.zeroset.measures);
  expect(distance.points.length).toBe(3);
  const [a, b, c] = distance.points;
  const total = away(a, b) + away(b, c);
  await expect(page.getByTestId('measure-1')).toHaveText(total.toFixed(3));
  expect(angle.points.length).toBe(3);
  // The three lie on one line.
  const degrees = parseFloat((await page.getByTestId('measure-2').textContent()) ?? '');
  expect(degrees).toBeGreaterThan(160);
  await page.getByTestId('measure-remove-1').click();
  expect((await page.evaluate(() => window.zeroset.measures)).length).toBe(1);
});

test('clips: what is cut away can no longer be clicked', async ({ view }) => {
  const { page } = view;
  const clips = () => page.evaluate(() => window.zeroset.clips);
  await page.getByTestId('clip-mode').selectOption('z');
  expect(await clips()).toBe(1);
  await page.getByTestId('clip-position').fill('0.3');
  await page.getByTestId('clip-position').press('Enter');
  await clickAt(view, BOX_TOP[0]);
  const below = await page.evaluate(() => window.zeroset.picked?.world[2] ?? 0);
  expect(below).toBeLessThanOrEqual(0.3);
  await page.getByTestId('clip-flip').click();
  await clickAt(view, BOX_TOP[1]);
  await expect.poll(() => page.evaluate(() => window.zeroset.picked?.world[2] ?? 0)).toBeGreaterThan(0.3);
  const slider = page.getByTestId('clip-slider');
  await slider.focus();
  await slider.press('End');
  await expect(page.getByTestId('clip-position')).toHaveValue(/^0\.6/);
  await page.getByTestId('clip-mode').selectOption('heading');
  await expect(page.getByTestId('clip-heading')).toBeVisible();
  await page.getByTestId('clip-mode').selectOption('off');
  expect(await clips()).toBe(0);
});

test('draws a section and looks at it', async ({ view }) => {
  const { page } = view;
  await page.getByTestId('view-top').click();
  await view.settled();
  await page.getByTestId('tool-section').click();
  await clickAll(view, [BOX_TOP[1], BOX_TOP[2]]);
  expect(await page.evaluate(() => window.zeroset.clips)).toBe(4);
  const length = parseFloat((await page.getByTestId('section-length').textContent()) ?? '');
  expect(Math.abs(length - Math.hypot(0.5, 0.4))).toBeLessThan(2 * NEAR);
  await page.getByTestId('section-look').click();
  const { isParallel, elevation } = await page.evaluate(() => window.zeroset.camera);
  expect([isParallel, elevation]).toEqual([true, 0]);
  await page.getByTestId('section-remove').click();
  expect(await page.evaluate(() => window.zeroset.clips)).toBe(0);
});

test('saves the picture', async ({ view: { page } }) => {
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('save-picture').click()]);
  expect(download.suggestedFilename()).toMatch(/\.png$/);
  const bytes = readFileSync(await download.path());
  expect(bytes.subarray(1, 4).toString()).toBe('PNG');
  expect(bytes.length).toBeGreaterThan(10_000);
});

test('adds a file that is dropped', async ({ view: { page, settled }, files }) => {
  const before = (await page.evaluate(() => window.zeroset.layers)).length;
  await drop(page, 'dropped.ply', readFileSync(files.mesh));
  await expect.poll(async () => (await page.evaluate(() => window.zeroset.layers)).length).toBeGreaterThan(before);
  await settled();
  await expect(page.getByTestId('layers')).toContainText('dropped.ply');
});

test('adds a file that is chosen', async ({ view: { page }, files }) => {
  const revision = () => page.evaluate(() => window.zeroset.scene.revision);
  const before = await revision();
  const [chooser] = await Promise.all([page.waitForEvent('filechooser'), page.getByTestId('add-files').click()]);
  await chooser.setFiles(files.box);
  await expect.poll(revision).toBeGreaterThan(before);
});

test('says what is wrong with a bad file', async ({ view: { page } }) => {
  await drop(page, 'bad.ply', Buffer.from('this is no cloud'));
  const problem = page.getByTestId('problem');
  await expect(problem).toContainText('bad.ply');
  await page.getByTestId('problem-close').click();
  await expect(problem).toHaveCount(0);
});
