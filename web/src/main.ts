// The playground: a text on the left, what comes of it on the right.

import './style.css';
import { AnswerView } from './answer';
import { byId, copy, h } from './dom';
import { Editor } from './editor';
import { compiled, Engine, Stopped } from './engine';
import { showExercise } from './exercise';
import { Figures } from './figures';
import { fromUrl, load, opened, showGallery } from './gallery';
import { complete, keep, kept, pack, unpack, type Open } from './project';
import { Sliders } from './sliders';
import { Service, serviceExtensions, type Change, type Location, type Look } from './service';
import { Tabs, type TabName } from './tabs';
import { texts } from './texts';
import { takeTour } from './tour';
import { View } from './views';
import type { Answer, Place, Project, Settings, Table } from './protocol';

const FIRST = 'wall.blk';
const LARGEST_FILE = 20e6;

const parameters = new URLSearchParams(location.search);
const embedded = parameters.has('embed');
const readOnly = parameters.has('readonly');

let open: Open = { file: 'model.blk', files: { 'model.blk': '' }, values: {} };
let shown = open.file;
let last: Answer | undefined;

const runner = new Engine(
  (kind, text) => kind === 'progress' && say(text),
  (busy) => (byId<HTMLButtonElement>('stop').disabled = !busy),
);
const checker = new Engine();
const answerView = new AnswerView();
const figures = new Figures();

const service = new Service(checker, () => open);
const extensions = serviceExtensions({ ask: (question) => service.ask(shown, question), go: goTo, change, say: toast });
const editor = new Editor(byId('editor'), { readOnly, changed, run: () => void run(), stop, extensions });
const sliders = new Sliders(byId('sliders'), () => void run(true));
const view = (tab: 'formulas' | 'dual' | 'kkt' | 'words' | 'prices' | 'rows' | 'steps' | 'why') => new View(tab, runner, () => request(), say);
const tabs = new Tabs(byId('tabs'), byId('panel'), {
  answer: { element: answerView.element },
  figures: { element: figures.element },
  formulas: view('formulas'),
  dual: view('dual'),
  kkt: view('kkt'),
  words: view('words'),
  prices: view('prices'),
  why: view('why'),
  steps: view('steps'),
  rows: view('rows'),
  json: { element: h('pre', { tabindex: 0 }), show: (e) => void (e.textContent = last ? JSON.stringify(last.report, null, 1) : texts.empty) },
});

function say(text: string): void {
  byId('state').textContent = text;
}

let toastEnds = 0;
function toast(text: string): void {
  const e = byId('toast');
  e.textContent = text;
  e.hidden = false;
  clearTimeout(toastEnds);
  toastEnds = window.setTimeout(() => (e.hidden = true), 5000);
}

// ---- running ----

function request(): Project & Settings {
  return { file: open.file, files: complete(open), time_limit: 120, max_memory: 1.5e9, ...sliders.settings() };
}

let again = false;
/** What is being run; a view that is computed meanwhile is waited for by the engine. */
let running: Open | undefined;

/** Runs the model. While a slider moves, one run follows the other, always with the newest values. */
async function run(following = false): Promise<void> {
  if (running === open) {
    if (following) again = true;
    return;
  }
  running = open;
  document.body.dataset.state = 'running';
  say(texts.running);
  const begin = performance.now();
  const project = open;
  try {
    const answer = await runner.call<Answer>({ do: 'run', ...request() });
    if (project !== open) return;
    show(answer, following);
    say(texts.took((performance.now() - begin) / 1000));
  } catch (error) {
    if (project !== open) return;
    const stopped = error instanceof Stopped;
    const text = stopped ? texts.stopped : `${texts.broke} (${(error as Error).message})`;
    answerView.say(text);
    tabs.show('answer');
    say(stopped ? texts.stopped : '');
    again = false;
  }
  running = undefined;
  document.body.dataset.state = 'done';
  if (again) {
    again = false;
    void run(true);
  }
}

function show(answer: Answer, following: boolean): void {
  last = answer;
  const asked = {
    records: (name: string) => runner.call<Table>({ do: 'records', name }),
    go: goToPlace,
  };
  answerView.show(answer, asked);
  const drawn = figures.show(answer.files);
  showExercise(byId('exercise'), open, open.exercise || parameters.has('claims') ? answer.claims : undefined);
  tabs.changed();
  if (following) return;
  const failed = answer.report.status !== 'ok';
  const wanted: TabName = failed ? 'answer' : drawn > 0 && tabs.current !== 'answer' ? 'figures' : tabs.current;
  tabs.show(failed ? 'answer' : wanted);
}

function stop(): void {
  again = false;
  runner.stop();
  void runner.warm();
}

// ---- the text ----

let waiting = 0;
function changed(text: string): void {
  open.files[shown] = text;
  if (!embedded) {
    keep(open);
    // From now on a reload brings back what was typed, not the link.
    if (location.hash) history.replaceState(null, '', location.pathname + location.search);
  }
  sliders.show(open);
  clearTimeout(waiting);
  waiting = window.setTimeout(check, 250);
}

async function check(): Promise<void> {
  if (checker.busy) {
    waiting = window.setTimeout(check, 100);
    return;
  }
  const [file, text] = [shown, open.files[shown]];
  try {
    const look = await service.ask<Look>(file, { ask: 'look' });
    if (text === open.files[file]) editor.look(file, look);
    markFiles(new Set(look.wrong.filter((w) => w.diagnostics.some((d) => d.severity === 1)).map((w) => w.file)));
  } catch {
    // The checker starts anew with the next change.
  }
}

function goTo(to: Location): void {
  if (!Object.hasOwn(open.files, to.file)) return;
  if (to.file !== shown) showFile(to.file);
  editor.go(to.range);
}

/** The place of a message of a run: it counts from 1. */
function goToPlace(p: Place): void {
  goTo({ file: p.file, range: { start: { line: p.line - 1, character: p.column - 1 }, end: { line: p.end_line - 1, character: p.end_column - 1 } } });
}

/** Carries out changes, perhaps in several files. */
function change(edits: Change[]): void {
  if (readOnly) return;
  const here = shown;
  for (const file of new Set(edits.map((e) => e.file))) {
    if (!Object.hasOwn(open.files, file)) continue;
    showFile(file);
    editor.change(edits.filter((e) => e.file === file));
  }
  if (shown !== here) showFile(here);
}

// ---- files ----

let wrong = new Set<string>();
function markFiles(files: Set<string>): void {
  wrong = files;
  drawFiles();
}

function drawFiles(): void {
  const names = [open.file, ...Object.keys(open.files).filter((n) => n !== open.file).sort()];
  const tab = (name: string) =>
    h('button', {
      onclick: () => showFile(name), class: name === open.file ? 'main' : undefined,
      'aria-current': String(name === shown), title: name === open.file ? texts.mainFile : name,
      onkeydown: (e: Event) => (e as KeyboardEvent).key === 'Delete' && remove(name),
    }, name, wrong.has(name) ? h('span', { class: 'badge', 'aria-label': texts.messages }, ' !') : null);
  const close = !readOnly && shown !== open.file && h('button', { onclick: () => remove(shown), 'aria-label': texts.removeFile(shown), title: texts.removeFile(shown) }, '×');
  const add = !readOnly && h('button', { onclick: newFile, 'aria-label': texts.newFile, title: texts.newFile }, '+');
  byId('files').replaceChildren(...[...names.map(tab), close, add].filter((e): e is HTMLButtonElement => e !== false));
}

function showFile(name: string): void {
  shown = name;
  editor.show(name, open.files[name] ?? '');
  drawFiles();
  void check();
}

function newFile(): void {
  const name = prompt(texts.newFileName)?.trim();
  if (!name) return;
  open.files[name] ??= '';
  showFile(name);
}

function remove(name: string): void {
  if (name === open.file || readOnly || !confirm(texts.sureToRemove(name))) return;
  delete open.files[name];
  showFile(open.file);
  if (!embedded) keep(open);
}

async function take(list: FileList): Promise<void> {
  let count = 0;
  let model: string | undefined;
  for (const file of list) {
    if (file.size > LARGEST_FILE) {
      toast(texts.tooLarge(file.name));
      continue;
    }
    try {
      const text = new TextDecoder('utf-8', { fatal: true }).decode(await file.arrayBuffer());
      open.files[file.name] = text;
      if (/\.(blk|gms)$/i.test(file.name)) model = file.name;
      count++;
    } catch {
      toast(texts.notText(file.name));
    }
  }
  if (count === 0) return;
  // A model that is dropped is the one to run; data stay beside the one that is there.
  if (model) use(opened(model, open.files));
  else showFile(shown);
  toast(texts.dropped(count));
}

function use(project: Open): void {
  open = project;
  if (runner.busy) stop();
  document.body.dataset.state = '';
  again = false;
  last = undefined;
  editor.reset();
  sliders.reset(open);
  answerView.say(texts.empty);
  figures.show({});
  wrong = new Set();
  showExercise(byId('exercise'), open, undefined);
  document.title = `${open.file} · bmod`;
  showFile(open.file);
  tabs.changed();
}

// ---- beginning ----

async function choose(id: string): Promise<void> {
  try {
    use(await load(id));
    history.replaceState(null, '', `${location.search}#model=${id}`);
    await run();
  } catch (error) {
    toast(texts.badUrl(id, (error as Error).message));
  }
}

async function begin(): Promise<void> {
  const hash = new URLSearchParams(location.hash.slice(1));
  const [url, model, project, text] = ['url', 'model', 'p', 'text'].map((k) => hash.get(k));
  try {
    if (project) use(await unpack(project));
    else if (url) use(await fromUrl(url));
    else if (text) use(opened('model.blk', { 'model.blk': text }));
    else if (model) use(await load(model));
    else use(kept() ?? (await load(FIRST)));
  } catch (error) {
    toast(url ? texts.badUrl(url, (error as Error).message) : texts.badLink);
    use(await load(FIRST).catch(() => open));
  }
  const tab = hash.get('tab');
  if (tab && tabs.has(tab)) tabs.show(tab);
  if (hash.has('examples')) void examples();
  // A stranger's model is run because a person says so, or the page around it.
  if (!project || parameters.has('run')) await run();
}

byId('run').addEventListener('click', () => void run());
byId('stop').addEventListener('click', stop);
const examples = () => showGallery(byId<HTMLDialogElement>('gallery'), (id) => void choose(id));
byId('examples').addEventListener('click', () => void examples());
byId('tour').addEventListener('click', () => takeTour({ choose, tab: (t) => tabs.show(t), run }));
byId('skip').addEventListener('click', (e) => {
  e.preventDefault();
  editor.view.focus();
});
byId('share').addEventListener('click', async () => {
  history.replaceState(null, '', `${location.search}#p=${await pack(open)}`);
  toast((await copy(location.href)) ? texts.shared : texts.shareFailed);
});
byId('theme').addEventListener('click', () => {
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  const now = document.documentElement.dataset.theme ?? (dark ? 'dark' : 'light');
  const other = now === 'dark' ? 'light' : 'dark';
  theme(other);
  try {
    localStorage.setItem('bmod.theme', other);
  } catch {
    // Then it lasts as long as the page.
  }
});

function theme(name: string | null): void {
  if (name === 'dark' || name === 'light') document.documentElement.dataset.theme = name;
}
try {
  theme(parameters.get('theme') ?? localStorage.getItem('bmod.theme'));
} catch {
  // Storage may be forbidden.
}

for (const kind of ['dragover', 'dragleave', 'drop'] as const) {
  byId('text').addEventListener(kind, (event) => {
    if (readOnly || !event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    event.stopPropagation();
    byId('text').classList.toggle('over', kind === 'dragover');
    if (kind === 'drop') void take(event.dataTransfer.files);
  }, { capture: true });
}
addEventListener('keydown', (e) => {
  if (e.key === 'F5' || (e.key === 'Enter' && (e.ctrlKey || e.metaKey))) {
    e.preventDefault();
    void run();
  } else if (e.key === 'Escape' && runner.busy && !document.querySelector('dialog[open]')) stop();
});
addEventListener('hashchange', () => void begin());

if (embedded) {
  document.body.classList.add('embed');
  const link = byId<HTMLAnchorElement>('open');
  link.hidden = false;
  link.href = `./${location.hash}`;
  link.addEventListener('click', async (e) => {
    e.preventDefault();
    window.open(`./#p=${await pack(open)}`, '_blank');
  });
}
say(texts.loading);
compiled().then(() => {
  if (!document.body.dataset.state) say('');
}, (error) => toast(String(error)));
void begin();

if ('serviceWorker' in navigator && import.meta.env.PROD && !embedded) {
  navigator.serviceWorker.register('./sw.js').catch(() => {});
}
