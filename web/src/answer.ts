// The tab "Answer": what was solved, in words and numbers; what the model printed; its symbols as tables.

import { download, h } from './dom';
import { shownNumber, tableView } from './table';
import { texts } from './texts';
import type { About, Answer, Diagnostic, Place, Solve, Table } from './protocol';

function tone(code: number): string {
  if ([1, 2, 8, 15, 16, 17].includes(code)) return 'good';
  return [7, 9].includes(code) ? 'fair' : 'bad';
}

function solveView(s: Solve): HTMLElement {
  const code = s.model_status.code;
  const sense = s.sense ? `, ${s.sense === 'max' ? 'maximizing' : 'minimizing'}` : '';
  const what = `${s.model} using ${s.using}${sense}`;
  const residuals = Object.entries(s.residual).filter(([, v]) => v !== null).map(([k, v]) => `${k} ${typeof v === 'number' && v !== 0 ? v.toExponential(0) : v}`);
  return h('section', { class: `solve ${tone(code)}` },
    h('h2', {}, what),
    h('p', { class: 'status' }, s.model_status.name, s.objective !== null && h('strong', {}, ` objective = ${shownNumber(s.objective)}`)),
    h('p', {}, texts.modelStatus[code] ?? ''),
    s.message ? h('p', {}, s.message) : null,
    h('p', { class: 'note' }, [texts.size(s.rows, s.columns, s.nonzeros), s.solver, texts.iterations(s.iterations), texts.took(s.seconds.total)].join(' · ')),
    residuals.length > 0 && h('p', { class: 'note' }, `largest residuals: ${residuals.join(', ')}`));
}

export function messageView(d: Diagnostic, go: (p: Place) => void): HTMLElement {
  const head = d.line ? `${d.file}:${d.line}:${d.column}` : '';
  return h('div', { class: `diagnostic ${d.severity}` },
    h('div', {}, h('span', { class: 'code' }, `${d.severity === 'warning' ? 'warning' : 'error'} ${d.code}`),
      d.line ? h('button', { class: 'place', onclick: () => go(d as Place) }, head) : null),
    h('p', {}, d.message),
    d.label ? h('p', { class: 'note' }, d.label) : null,
    ...(d.labels ?? []).map((l) => h('p', { class: 'note' }, l.line ? h('button', { class: 'place', onclick: () => go(l as Place) }, `${l.file}:${l.line}`) : null, ` ${l.text}`)),
    d.help ? h('p', { class: 'help' }, `${texts.fix}: ${d.help}`) : null);
}

function symbolView(about: About, records: (name: string) => Promise<Table>, open: Set<string>): HTMLElement {
  const domain = about.domain.length ? `(${about.domain.join(',')})` : '';
  const details = h('details', {},
    h('summary', {}, h('b', {}, about.name), domain, ' ', h('span', { class: 'note' }, [about.text, texts.records(about.records)].filter(Boolean).join(' · '))));
  const fill = async () => {
    if (!details.open) return void open.delete(about.name);
    open.add(about.name);
    if (details.querySelector('.table')) return;
    try {
      details.append(tableView(await records(about.name)));
    } catch {
      // Another run has begun: its answer brings its own tables.
    }
  };
  details.addEventListener('toggle', fill);
  if (open.has(about.name)) details.open = true;
  return details;
}

export type Asked = { records(name: string): Promise<Table>; go(p: Place): void };

export class AnswerView {
  readonly element = h('div', { class: 'answer' }, h('p', { class: 'note' }, texts.empty));
  /** Symbols whose tables are open: they stay so in the next run. */
  private open = new Set<string>();

  say(text: string): void {
    this.element.replaceChildren(h('p', { class: 'note' }, text));
  }

  show(answer: Answer, asked: Asked): void {
    const { report } = answer;
    const parts: (Node | null)[] = [];
    if (report.status !== 'ok') parts.push(h('p', { class: 'solve bad' }, texts.status[report.status] ?? report.status));
    if (report.diagnostics.length) {
      parts.push(h('section', { 'aria-label': texts.messages }, ...report.diagnostics.map((d) => messageView(d, asked.go))));
    }
    parts.push(...report.solves.map(solveView));
    if (answer.printed.trim()) parts.push(h('h2', {}, texts.printed), h('pre', { tabindex: 0 }, answer.printed));
    const groups = ['variable', 'equation', 'parameter', 'set'] as const;
    if (answer.symbols.length) parts.push(h('h2', {}, texts.symbols));
    for (const kind of groups) {
      const of = answer.symbols.filter((s) => s.kind === kind && s.records > 0);
      if (of.length) parts.push(h('section', {}, h('h3', {}, texts.kinds[kind] ?? kind), ...of.map((s) => symbolView(s, asked.records, this.open))));
    }
    const others = Object.entries(answer.files).filter(([name]) => !/\.svg$/i.test(name));
    if (others.length) {
      parts.push(h('h2', {}, texts.written), ...others.map(([name, text]) =>
        h('details', {}, h('summary', {}, name), h('pre', { tabindex: 0 }, text), h('button', { onclick: () => download(name, text) }, texts.download))));
    }
    this.element.replaceChildren(...parts.filter((p) => p !== null));
  }
}
