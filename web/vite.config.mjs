import { defineConfig } from 'vite';
import { bmodSite } from './site.mjs';

export default defineConfig({
  base: './', // under any path
  plugins: [bmodSite()],
  worker: { format: 'es' },
  build: { target: 'es2022', assetsInlineLimit: 0, chunkSizeWarningLimit: 1000, modulePreload: { polyfill: false } },
});
