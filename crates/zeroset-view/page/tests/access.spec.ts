/** Keyboard, themes and narrow screens. */

import { expect, test } from './fixture';

test('everything works by the keyboard alone', async ({ view: { page } }) => {
  const state = () => page.evaluate(() => ({ picked: window.zeroset.picked, measures: window.zeroset.measures, camera: window.zeroset.camera, clips: window.zeroset.clips }));
  await page.keyboard.press('t');
  expect((await state()).camera.elevation).toBeCloseTo(90);
  await page.keyboard.press('ArrowDown');
  expect((await state()).camera.elevation).toBeLessThan(90);
  await page.keyboard.press('t');
  await page.keyboard.press('p');
  await expect(page.getByTestId('picked')).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.getByTestId('picked')).toBeHidden();

  await page.keyboard.press('d');
  await expect(page.getByTestId('hint')).toContainText('first point');
  await page.keyboard.press('p');
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('p');
  await page.keyboard.press('Enter');
  await page.keyboard.press('Escape');
  expect((await state()).measures[0].points.length).toBe(2);

  await page.keyboard.press('c');
  expect((await state()).clips).toBe(1);
  await page.keyboard.press('c');
  expect((await state()).clips).toBe(0);

  const before = (await state()).camera.distance;
  await page.keyboard.press('+');
  expect((await state()).camera.distance).toBeLessThan(before);
  await page.keyboard.press('v');
  expect((await page.evaluate(() => window.zeroset.layers))[0].isVisible).toBe(false);
});

test('Tab reaches every control, and shows where it is', async ({ view: { page } }) => {
  const wanted = await page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>('button, select, input, canvas[tabindex]')]
      .filter((element) => element.checkVisibility())
      .map((element) => element.dataset.testid),
  );
  const reached = new Set<string | undefined>();
  for (let press = 0; press < 2 * wanted.length; press++) {
    await page.keyboard.press('Tab');
    const focus = await page.evaluate(() => {
      const element = document.activeElement as HTMLElement;
      return { testid: element.dataset.testid, tag: element.tagName, outline: getComputedStyle(element).outlineStyle };
    });
    if (focus.tag !== 'BODY') {
      expect(focus.outline, focus.testid).toBe('solid');
      reached.add(focus.testid);
    }
  }
  expect(wanted.filter((testid) => !reached.has(testid))).toEqual([]);
});

test('every control has a name', async ({ view: { page } }) => {
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>('button, select, input, canvas, dialog')]
      .filter((element) => !element.hidden)
      .filter((element) => !element.ariaLabel && !element.textContent?.trim() && !element.closest('label') && element.ariaHidden !== 'true')
      .map((element) => element.outerHTML),
  );
  expect(nameless).toEqual([]);
});

test('help opens by its key and its button, and closes by Escape', async ({ view: { page } }) => {
  const help = page.getByTestId('help');
  await page.keyboard.press('?');
  await expect(help).toBeVisible();
  await expect(help).toContainText('Zoom in');
  await page.keyboard.press('Escape');
  await expect(help).toBeHidden();
  await page.getByTestId('open-help').click();
  await expect(help).toBeVisible();
  await page.getByTestId('help-close').click();
  await expect(help).toBeHidden();
});

test('light and dark: as the system says, or as the user does', async ({ view: { page } }) => {
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await page.emulateMedia({ colorScheme: 'light' });
  const light = await background();
  await page.emulateMedia({ colorScheme: 'dark' });
  const dark = await background();
  expect(dark).not.toBe(light);
  await page.getByTestId('theme').click();
  expect(await background()).toBe(light);
});

test('on a narrow screen the panel is a drawer', async ({ view: { page } }) => {
  await page.setViewportSize({ width: 420, height: 760 });
  const panel = page.getByTestId('panel');
  await expect(panel).toBeHidden();
  await page.getByTestId('toggle-panel').click();
  await expect(panel).toBeVisible();
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(420);
});
