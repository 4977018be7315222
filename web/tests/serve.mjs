// Serves the built site under a sub-path, as an intranet would, compressed where the browser takes it; and files of a test beside it.

import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

export const dist = fileURLToPath(new URL('../dist/', import.meta.url));
const TYPES = {
  '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm',
  '.svg': 'image/svg+xml', '.json': 'application/json',
};

/** `extra`: further texts by path, for pages of a lecture. Gives the address of the site and how to close it. */
export async function serve(extra = {}) {
  const server = createServer(async (request, response) => {
    let path = decodeURIComponent(request.url.split('?')[0]);
    if (path.endsWith('/')) path += 'index.html';
    const type = TYPES[extname(path)] ?? 'text/plain';
    try {
      const inside = path.startsWith('/some/path/') ? normalize(path.slice('/some/path/'.length)) : '..';
      const taken = String(request.headers['accept-encoding'] ?? '');
      const ways = [['br', '.br'], ['gzip', '.gz']].filter(([way]) => taken.includes(way));
      let body = extra[path];
      let encoding;
      for (const [way, end] of [...ways, [undefined, '']]) {
        if (body !== undefined || inside.startsWith('..')) break;
        body = await readFile(join(dist, inside + end)).catch(() => undefined);
        encoding = way;
      }
      if (body === undefined) throw new Error('not here');
      response.writeHead(200, {
        'content-type': type.startsWith('text/') ? `${type}; charset=utf-8` : type, 'content-length': Buffer.byteLength(body),
        ...(encoding && { 'content-encoding': encoding, vary: 'accept-encoding' }),
      });
      response.end(body);
    } catch {
      response.writeHead(404);
      response.end();
    }
  });
  await new Promise((done) => server.listen(Number(process.env.PORT ?? 0), '127.0.0.1', done));
  const origin = `http://127.0.0.1:${server.address().port}`;
  return { origin, site: `${origin}/some/path/`, close: () => server.close() };
}

// `node tests/serve.mjs` shows the site to a person.
if (process.argv[1] === fileURLToPath(import.meta.url)) console.log((await serve()).site);
