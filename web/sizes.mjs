// What a first visit loads, as a server that compresses sends it.

import { readdirSync, readFileSync } from 'node:fs';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';

const dist = new URL('dist/', import.meta.url);
const kib = (n) => `${(n / 1024).toFixed(0)} KiB`.padStart(9);
for (const name of ['index.html', ...readdirSync(new URL('assets/', dist)).map((f) => `assets/${f}`)]) {
  const bytes = readFileSync(new URL(name, dist));
  const brotli = brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_QUALITY]: 9, [constants.BROTLI_PARAM_LGWIN]: 24 } });
  console.log(`${name.padEnd(32)} ${kib(bytes.length)}  gzip ${kib(gzipSync(bytes, { level: 9 }).length)}  brotli ${kib(brotli.length)}`);
}
