// What the site has beside the program: examples with their pictures, pages of docs/, the service worker. A plugin of Vite, so
// that one command builds everything.

import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { basename, dirname, join, posix } from 'node:path';
import { fileURLToPath } from 'node:url';
import MarkdownIt from 'markdown-it';

const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const models = join(root, 'models');
const text = (...path) => readFileSync(join(...path), 'utf8');
const blk = (folder) => readdirSync(join(models, folder)).filter((f) => f.endsWith('.blk')).sort();

/** Models shown as examples: group and file, as it lies in models/. */
function chosen() {
  // The order of the page that presents them.
  const taught = [...text(models, 'teaching/README.md').matchAll(/\]\((\w+\.blk)\)/g)].map((m) => m[1]);
  return [
    ...taught.map((f) => ['teaching', `teaching/${f}`]),
    ['walls', 'wall.blk'],
    ...[1, 2, 3, 4, 5, 6].map((k) => ['walls', `walls/example${k}.blk`]),
    ...blk('structures').map((f) => ['structures', `structures/${f}`]),
    ...exercises().map((f) => ['exercises', `exercises/${f}`]),
  ];
}

const exercises = () => readdirSync(join(root, 'web/exercises')).filter((f) => f.endsWith('.blk')).sort();
const pathOf = (id) => (id.startsWith('exercises/') ? join(root, 'web', id) : join(models, id));

/** The files that a model reads, itself first. */
function needs(id, found = []) {
  if (found.includes(id) || !existsSync(pathOf(id))) return found;
  found.push(id);
  for (const [, name] of text(pathOf(id)).matchAll(/^\$\s*include\s+["']?([^\s"']+)/gim)) {
    needs(posix.normalize(posix.join(posix.dirname(id), name)), found);
  }
  return found;
}

function entry(group, id) {
  const source = text(pathOf(id));
  const title = /^\$title\s+(.*)/im.exec(source)?.[1] ?? basename(id);
  const comment = /^(?:\*(?![=#@]).*\n?)+/m.exec(source)?.[0] ?? '';
  const words = comment.split(/\n\*[ \t]*\n/)[0].replace(/^\*[ \t]*/gm, '').replace(/\s+/g, ' ').trim();
  const about = words.length > 200 ? `${words.slice(0, 200).replace(/\s\S*$/, '')} …` : words;
  const [head, ...rest] = title.split(/:\s+/);
  const picture = `docs/figures/${basename(id, '.blk')}.svg`;
  const least = `docs/figures/${basename(id, '.blk')}_least.svg`;
  const wall = id === 'wall.blk' ? 'docs/wall.svg' : undefined;
  const drawn = [picture, least, wall].find((p) => p && existsSync(join(root, p)));
  return {
    id, group, title: group === 'teaching' && rest.length ? `${head}: ${rest.join(': ')}` : title,
    about: about === title ? '' : about, files: needs(id), picture: drawn && `figures/${basename(drawn)}`, drawn,
  };
}

// ---- pages ----

const escaped = (t) => t.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/"/g, '&quot;');

/** Where a page of the project stands in the site: `docs/lab/nlp.md` in `docs/lab/nlp.html`. */
const htmlOf = (path) => path.replace(/README\.md$/, 'index.md').replace(/\.md$/, '.html');

function page(path, source, pages) {
  const markdown = new MarkdownIt({ html: false, linkify: false });
  const title = /^#\s+(.*)/m.exec(source)?.[1] ?? path;
  const up = '../'.repeat(path.split('/').length - 1);
  markdown.renderer.rules.fence = (tokens, at) => {
    const { info, content } = tokens[at];
    const [language, file] = info.trim().split(/\s+/);
    // The examples of the language are whole programs, but for those that show an error (tests/suite.rs holds them to it).
    const whole = (language === 'blk' && file?.endsWith('.blk')) || (language === 'gams' && !/^\*!/m.test(content));
    const code = `<pre tabindex="0"><code>${escaped(content)}</code></pre>`;
    if (!whole) return code;
    return `<div class="example" data-file="${escaped(file ?? 'example.blk')}">${code}</div>`;
  };
  // Code without a fence. What may be too wide for a phone can be reached, and moved, with the keyboard.
  markdown.renderer.rules.code_block = (tokens, at) => `<pre tabindex="0"><code>${escaped(tokens[at].content)}</code></pre>`;
  markdown.renderer.rules.table_open = () => '<table tabindex="0">';
  const rewrite = (href) => {
    if (/^[a-z]+:/.test(href)) return href;
    const [file, hash] = href.split('#');
    const at = file ? posix.normalize(posix.join(posix.dirname(path), file)) : path;
    if (pages.has(at)) return `${up}${htmlOf(at)}${hash ? `#${hash}` : ''}`;
    if (/^models\/\w+\/README.md$/.test(at)) return `${up}index.html#examples`;
    if (at.startsWith('models/') && at.endsWith('.blk')) return `${up}index.html#model=${at.slice(7)}`;
    if (at.startsWith('docs/') && at.endsWith('.svg')) return `${up}models/figures/${basename(at)}`;
    return null;
  };
  markdown.core.ruler.push('links', (state) => {
    for (const block of state.tokens) {
      for (const t of [block, ...(block.children ?? [])]) {
        for (const a of t.attrs ?? []) if (a[0] === 'href' || a[0] === 'src') a[1] = rewrite(a[1]) ?? up;
      }
      // A column without a name has no head.
      const at = state.tokens.indexOf(block);
      if (block.type === 'th_open' && state.tokens[at + 1].content === '') block.tag = state.tokens[at + 2].tag = 'td';
      if (block.type === 'heading_open') {
        const words = state.tokens[at + 1].content;
        block.attrSet('id', words.toLowerCase().replace(/[^\w\s-]/g, '').trim().replace(/\s+/g, '-'));
      }
    }
  });
  const body = markdown.render(source);
  return `<!doctype html>
<html lang="en"><head><meta charset="utf-8" /><meta name="viewport" content="width=device-width, initial-scale=1" />
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'" />
<meta name="color-scheme" content="light dark" /><title>${escaped(title)} · bmod</title>
<link rel="icon" href="${up}icon.svg" type="image/svg+xml" /><link rel="stylesheet" href="${up}pages.css" /><script src="${up}pages.js" defer></script></head>
<body><nav><a href="${up}index.html"><b>bmod</b> playground</a> · <a href="${up}docs/index.html">All pages</a></nav><main>
${body}</main></body></html>
`;
}

/** All files of the site that are not compiled: name and content. */
function site() {
  const out = new Map();
  const list = chosen().map(([group, id]) => entry(group, id));
  for (const e of list) {
    for (const f of e.files) out.set(`models/${f}`, readFileSync(pathOf(f)));
    if (e.drawn) out.set(`models/${e.picture}`, readFileSync(join(root, e.drawn)));
  }
  out.set('models/gallery.json', JSON.stringify(list.map(({ drawn, ...e }) => e)));
  const pages = readdirSync(join(root, 'docs'), { recursive: true }).filter((f) => f.endsWith('.md')).map((f) => `docs/${f}`);
  for (const path of pages) out.set(htmlOf(path), page(path, text(root, path), new Set(pages)));
  for (const f of readdirSync(join(root, 'docs/figures'))) {
    if (f.endsWith('.svg')) out.set(`models/figures/${f}`, readFileSync(join(root, 'docs/figures', f)));
  }
  return out;
}

const TYPES = { json: 'application/json', html: 'text/html', svg: 'image/svg+xml', blk: 'text/plain' };

export function bmodSite() {
  return {
    name: 'bmod-site',
    configureServer(server) {
      server.middlewares.use((request, response, next) => {
        const found = site().get(decodeURIComponent(request.url.split('?')[0].slice(1)));
        if (found === undefined) return next();
        response.setHeader('content-type', TYPES[request.url.split('.').pop()] ?? 'text/plain');
        response.end(found);
      });
    },
    generateBundle(_, bundle) {
      const files = site();
      for (const [fileName, source] of files) this.emitFile({ type: 'asset', fileName, source });
      // The service worker keeps the program at once and everything else when it was seen.
      const shell = Object.keys(bundle).filter((f) => !f.startsWith('bmod-model'));
      const hash = createHash('sha256');
      for (const f of shell) hash.update(f).update(bundle[f].code ?? bundle[f].source ?? '');
      for (const [name, source] of files) hash.update(name).update(source);
      const worker = text(root, 'web/src/sw.js')
        .replace("'VERSION'", JSON.stringify(hash.digest('hex').slice(0, 16)))
        .replace("['SHELL']", JSON.stringify(['./', ...shell, 'icon.svg', 'pages.css', 'pages.js', ...files.keys()]));
      this.emitFile({ type: 'asset', fileName: 'sw.js', source: worker });
    },
  };
}
