/** Starts `zeroset view` on files that `zeroset` makes itself, opens the page, and watches over what must never happen. */

import { execFileSync, spawn, type ChildProcess } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

import { expect, test as base, type ConsoleMessage, type Page } from '@playwright/test';

import type { Vec3 } from '../src/protocol';

const ZEROSET = process.env.ZEROSET ?? 'zeroset';

/** Files for all tests of a worker: a torus as a cloud, a box as a cloud with its features, and the true surface of the torus. */
export interface Files {
  folder: string;
  torus: string;
  box: string;
  features: string;
  mesh: string;
}

export interface View {
  page: Page;
  address: string;
  /** Waits until nothing is loading, and the last frame is drawn. */
  settled(): Promise<void>;
  /** Where a world position is in the window. */
  place(world: Vec3): Promise<[number, number]>;
}

function makeFiles(): Files {
  const folder = mkdtempSync(join(tmpdir(), 'zeroset-page-'));
  const path = (name: string) => join(folder, name);
  const run = (...options: string[]) => execFileSync(ZEROSET, options, { cwd: folder, stdio: 'pipe' });
  run('sample', 'torus', '-o', 'torus.laz');
  run('sample', 'box', '--points', '20000', '-o', 'box.ply', '--noise', '0.001');
  run('features', 'box.ply', '-o', 'box.json', '--scene', 'object');
  run('sample', 'torus', '--points', '1000', '-o', 'x.las', '--truth', 'torus-mesh.ply');
  return { folder, torus: path('torus.laz'), box: path('box.ply'), features: path('box.json'), mesh: path('torus-mesh.ply') };
}

async function firstLine(server: ChildProcess): Promise<string> {
  const lines = createInterface({ input: server.stdout as NodeJS.ReadableStream });
  return new Promise((resolve, reject) => {
    lines.once('line', resolve);
    server.once('exit', (code) => reject(new Error(`zeroset view ended with ${code}`)));
  });
}

async function settle(page: Page): Promise<void> {
  await page.waitForFunction(() => {
    const { scene, frame, layers } = window.zeroset;
    return !scene.isWorking && scene.revision >= 0 && layers.length > 0 && frame.drawn > 0 && frame.loading === 0;
  });
  let before = -1;
  await expect
    .poll(async () => {
      const drawn = await page.evaluate(() => window.zeroset.frame.drawn);
      const isStill = drawn === before;
      before = drawn;
      return isStill;
    }, { intervals: [400] })
    .toBe(true);
}

/** The graphics driver reports its own slowness as warnings, and the browser logs each refused upload; neither is the page's. */
const isForeign = (message: ConsoleMessage) =>
  message.text().includes('GL Driver Message') || new URL(message.location().url || 'about:blank').pathname.endsWith('/files');

export const test = base.extend<{ view: View }, { files: Files }>({
  files: [
    async ({}, use) => {
      const files = makeFiles();
      await use(files);
      rmSync(files.folder, { recursive: true });
    },
    { scope: 'worker' },
  ],
  view: async ({ page, files: { torus, box, features } }, use) => {
    const server = spawn(ZEROSET, ['view', torus, box, features, '--no-open', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
    const complaints: string[] = [];
    page.on('console', (message) => {
      const isComplaint = ['error', 'warning'].includes(message.type()) && !isForeign(message);
      if (isComplaint) {
        complaints.push(`${message.type()}: ${message.text()}`);
      }
    });
    page.on('pageerror', (error) => complaints.push(`exception: ${error.message}`));
    page.on('request', (request) => {
      const { hostname, protocol } = new URL(request.url());
      if (['http:', 'https:', 'ws:'].includes(protocol) && hostname !== '127.0.0.1') {
        complaints.push(`request: ${request.url()}`);
      }
    });
    const address = await firstLine(server);
    await page.goto(address);
    await settle(page);
    await use({
      page,
      address,
      settled: () => settle(page),
      place: async (world) => (await page.evaluate((position) => window.zeroset.project(position), world)) as [number, number],
    });
    server.kill();
    expect(complaints).toEqual([]);
  },
});

export { expect };

/** Drops a file on the page. */
export async function drop(page: Page, name: string, bytes: Buffer): Promise<void> {
  const transfer = await page.evaluateHandle(
    ([text, fileName]) => {
      const data = new DataTransfer();
      data.items.add(new File([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], fileName));
      return data;
    },
    [bytes.toString('base64'), name] as const,
  );
  await page.dispatchEvent('body', 'dragenter', { dataTransfer: transfer });
  await page.dispatchEvent('body', 'drop', { dataTransfer: transfer });
}
