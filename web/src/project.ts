// A project: files by name, the one that is run, and the values of its sliders. In memory, in a link, in the browser's storage.

export type Slider = { name: string; define: boolean; low: number; high: number; step: number; text: string };

export type Open = { file: string; files: Record<string, string>; values: Record<string, number>; exercise?: Exercise };

/** What an exercise keeps from the reader until it is asked for. */
export type Exercise = { hidden: string; hints: string[] };

const SLIDER = /^\*[ \t]*@slider[ \t]+(%?)([A-Za-z_][\w.]*)%?[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)[ \t]*(?:'([^']*)'|"([^"]*)")?/gim;

/** `* @slider friction 0 1 0.01 'a text'` marks a scalar, `* @slider %friction% …` what stands for %friction%. */
export function sliders(text: string): Slider[] {
  const found: Slider[] = [];
  for (const [, percent, name, low, high, step, a, b] of text.matchAll(SLIDER)) {
    const s = { name: name!, define: percent === '%', low: Number(low), high: Number(high), step: Number(step), text: a ?? b ?? '' };
    const fits = [s.low, s.high, s.step].every(Number.isFinite) && s.low < s.high && s.step > 0;
    if (fits && found.length < 20 && !found.some((f) => f.name.toLowerCase() === s.name.toLowerCase())) found.push(s);
  }
  return found;
}

/** The value that the text gives, as far as it can be seen without running it: `/ 0.65 /`, `$set friction 0.65`. */
export function written(slider: Slider, files: Record<string, string>): number | undefined {
  const name = slider.name.replaceAll('.', '\\.');
  const pattern = slider.define
    ? new RegExp(`^[^*\\n]*\\$\\s*set(?:global|local)?\\s+${name}\\s+(\\S+)`, 'im')
    : new RegExp(`\\b${name}\\b[^/;]*/\\s*([-+.\\de]+)\\s*/`, 'i');
  for (const text of Object.values(files)) {
    const value = Number(pattern.exec(text)?.[1] ?? NaN);
    if (Number.isFinite(value)) return value;
  }
  return undefined;
}

/** Takes hints and checks out of an exercise (`* @exercise` in its text): they are put back when it is run. */
export function unwrap(text: string): { text: string; exercise?: Exercise } {
  if (!/^\*[ \t]*@exercise\b/im.test(text)) return { text };
  const hidden: string[] = [];
  const hints: string[] = [];
  const shown: string[] = [];
  for (const line of text.split('\n')) {
    const hint = /^\*[ \t]*@hint[ \t]+(.*)/i.exec(line);
    if (hint) hints.push(hint[1]!);
    else if (line.startsWith('*=')) hidden.push(line);
    else if (!/^\*[ \t]*@exercise\b/i.test(line)) shown.push(line);
  }
  return { text: `${shown.join('\n').trimEnd()}\n`, exercise: { hidden: hidden.join('\n'), hints } };
}

/** The files as they are run. */
export function complete(open: Open): Record<string, string> {
  if (!open.exercise) return open.files;
  return { ...open.files, [open.file]: `${open.files[open.file]}\n${open.exercise.hidden}\n` };
}

// ---- links ----

type Packed = { m: string; f: Record<string, string>; v?: Record<string, number>; x?: Exercise };

async function through(bytes: Uint8Array<ArrayBuffer>, stream: CompressionStream | DecompressionStream): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

export async function pack(open: Open): Promise<string> {
  const packed: Packed = { m: open.file, f: open.files, v: open.values, x: open.exercise };
  const bytes = await through(new TextEncoder().encode(JSON.stringify(packed)), new CompressionStream('deflate-raw'));
  let text = '';
  for (const b of bytes) text += String.fromCharCode(b);
  return btoa(text).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** The project in a link. Throws if it is none: a link is a stranger's text. */
export async function unpack(text: string): Promise<Open> {
  const binary = atob(text.replaceAll('-', '+').replaceAll('_', '/'));
  const bytes = Uint8Array.from(binary, (c) => c.charCodeAt(0));
  const json = new TextDecoder().decode(await through(bytes, new DecompressionStream('deflate-raw')));
  return checked(JSON.parse(json));
}

function record<T>(value: unknown, fits: (v: unknown) => v is T): Record<string, T> {
  const entries = typeof value === 'object' && value !== null ? Object.entries(value) : [];
  return Object.fromEntries(entries.filter((e): e is [string, T] => fits(e[1])));
}

const isText = (v: unknown): v is string => typeof v === 'string';
const isNumber = (v: unknown): v is number => typeof v === 'number' && Number.isFinite(v);

function checked(packed: Partial<Packed>): Open {
  const files = record(packed.f, isText);
  const file = packed.m;
  if (!isText(file) || !Object.hasOwn(files, file)) throw new Error('no such project');
  const open: Open = { file, files, values: record(packed.v, isNumber) };
  if (packed.x && isText(packed.x.hidden) && Array.isArray(packed.x.hints)) {
    open.exercise = { hidden: packed.x.hidden, hints: packed.x.hints.filter(isText) };
  }
  return open;
}

// ---- storage: what was typed is there after a reload ----

const KEY = 'bmod.project';

export function keep(open: Open): void {
  try {
    localStorage.setItem(KEY, JSON.stringify({ m: open.file, f: open.files, v: open.values, x: open.exercise }));
  } catch {
    // Full or forbidden: the page works without.
  }
}

export function kept(): Open | undefined {
  try {
    const text = localStorage.getItem(KEY);
    return text === null ? undefined : checked(JSON.parse(text));
  } catch {
    return undefined;
  }
}
