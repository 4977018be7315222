// The examples: models with all files they read, made by `site.mjs` when the site is built.

import { h } from './dom';
import { texts } from './texts';
import { unwrap, type Open } from './project';

export type Entry = { id: string; group: string; title: string; about: string; files: string[]; picture?: string };

const base = new URL('./models/', document.baseURI);
let list: Promise<Entry[]> | undefined;

async function got(url: URL): Promise<Response> {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
  return response;
}

export function entries(): Promise<Entry[]> {
  return (list ??= got(new URL('gallery.json', base)).then((r) => r.json()));
}

export async function load(id: string): Promise<Open> {
  const entry = (await entries()).find((e) => e.id === id || e.id === `${id}.blk`);
  if (!entry) throw new Error(`there is no example ${id}`);
  const files = await Promise.all(entry.files.map(async (f) => [f, await (await got(new URL(f, base))).text()] as const));
  return opened(entry.id, Object.fromEntries(files));
}

/** A project from files; hints and checks of an exercise are put away. */
export function opened(file: string, files: Record<string, string>): Open {
  const { text, exercise } = unwrap(files[file]!);
  return { file, files: { ...files, [file]: text }, values: {}, exercise };
}

/** A model from an address, with what it includes from beside it. */
export async function fromUrl(address: string): Promise<Open> {
  const url = new URL(address, document.baseURI);
  if (!/^https?:$/.test(url.protocol)) throw new Error('only http and https');
  const files: Record<string, string> = {};
  const read = async (at: URL, name: string, depth: number): Promise<void> => {
    const text = await (await got(at)).text();
    files[name] = text;
    for (const [, included] of text.matchAll(/^\$\s*(?:bat)?include\s+["']?([^\s"']+)/gim)) {
      const folder = name.includes('/') ? name.slice(0, name.lastIndexOf('/') + 1) : '';
      if (included!.includes('%') || included!.includes('..') || files[folder + included] !== undefined || depth > 5) continue;
      await read(new URL(included!, at), folder + included, depth + 1).catch(() => {});
    }
  };
  const name = decodeURIComponent(url.pathname.split('/').pop() ?? '') || 'model.blk';
  await read(url, name, 0);
  return opened(name, files);
}

export async function showGallery(dialog: HTMLDialogElement, choose: (id: string) => void): Promise<void> {
  const all = await entries();
  const pick = (id: string) => {
    dialog.close();
    choose(id);
  };
  const card = (e: Entry) =>
    h('button', { onclick: () => pick(e.id), 'data-model': e.id },
      e.picture ? h('img', { src: new URL(e.picture, base), alt: '', loading: 'lazy' }) : null,
      h('b', {}, e.title), h('small', {}, e.about));
  const groups = [...new Set(all.map((e) => e.group))].map((g) => {
    const cards = all.filter((e) => e.group === g).map((e) => ({ e, element: card(e) }));
    return { cards, element: h('section', {}, h('h2', {}, texts.gallery[g] ?? g), h('div', { class: 'cards' }, ...cards.map((c) => c.element))) };
  });
  const search = (event: Event) => {
    const wanted = (event.target as HTMLInputElement).value.toLowerCase();
    for (const g of groups) {
      for (const c of g.cards) c.element.hidden = !`${c.e.id} ${c.e.title} ${c.e.about}`.toLowerCase().includes(wanted);
      g.element.hidden = g.cards.every((c) => c.element.hidden);
    }
  };
  dialog.replaceChildren(
    h('div', { class: 'bar' },
      h('input', { type: 'search', placeholder: texts.gallerySearch, 'aria-label': texts.gallerySearch, oninput: search }),
      h('button', { onclick: () => dialog.close() }, texts.close)),
    ...groups.map((g) => g.element));
  dialog.setAttribute('aria-label', texts.examples);
  dialog.showModal();
}
