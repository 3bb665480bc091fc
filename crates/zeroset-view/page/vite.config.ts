import { defineConfig } from 'vite';

// The server carries the built files inside its binary: their names are fixed, and all addresses relative, so that the page works below any token.
export default defineConfig({
  base: './',
  build: {
    outDir: 'dist',
    // The folder has a file of its own, so that cargo finds it in a clean clone; what is built has the same names each time.
    emptyOutDir: false,
    // The first with `light-dark()` in style sheets.
    target: ['chrome123', 'firefox120', 'safari17.5'],
    sourcemap: false,
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    // Nearly all of it is three.js, and it comes from the same machine.
    chunkSizeWarningLimit: 1000,
    rolldownOptions: {
      output: {
        entryFileNames: 'page.js',
        assetFileNames: 'page[extname]',
        codeSplitting: false,
      },
    },
  },
});
