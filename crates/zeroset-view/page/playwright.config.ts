import { defineConfig } from '@playwright/test';

export default defineConfig({
  testDir: 'tests',
  // Pictures are drawn by the processor there, and the tests share it.
  timeout: 120_000,
  expect: { timeout: 30_000 },
  workers: 1,
  fullyParallel: false,
  reporter: 'list',
  use: {
    viewport: { width: 1000, height: 700 },
    launchOptions: {
      executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      args: ['--enable-unsafe-swiftshader', '--no-sandbox'],
    },
  },
});
