// Writes every file of the site compressed beside itself (`.br`, `.gz`), for file servers that send such files as they are, and
// says what a first visit loads. A draft is compressed quickly and less.

import { readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { brotliCompress, constants, gzip } from 'node:zlib';

const dist = fileURLToPath(new URL('dist/', import.meta.url));
const draft = Boolean(process.env.DRAFT);
const brotli = (bytes) =>
  promisify(brotliCompress)(bytes, {
    params: { [constants.BROTLI_PARAM_QUALITY]: draft ? 5 : 11, [constants.BROTLI_PARAM_LGWIN]: 24, [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length },
  });
const kib = (n) => `${(n / 1024).toFixed(0)} KiB`.padStart(9);

let [count, all] = [0, 0];
for (const name of readdirSync(dist, { recursive: true }).sort()) {
  const path = join(dist, name);
  // Below a packet's size there is nothing to gain.
  if (!/\.(html|js|css|svg|json|wasm|blk|inc)$/.test(name) || statSync(path).size < 1400) continue;
  const bytes = readFileSync(path);
  const [br, gz] = await Promise.all([brotli(bytes), promisify(gzip)(bytes, { level: draft ? 6 : 9 })]);
  writeFileSync(`${path}.br`, br);
  writeFileSync(`${path}.gz`, gz);
  count++;
  all += br.length;
  if (name === 'index.html' || name.startsWith('assets')) console.log(`${name.padEnd(32)} ${kib(bytes.length)}  gzip ${kib(gz.length)}  brotli ${kib(br.length)}`);
}
console.log(`${`${count} files`.padEnd(32)} ${' '.repeat(26)}  brotli ${kib(all)}`);
