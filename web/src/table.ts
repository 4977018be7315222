// A table of records: sorts by a click on its head, searches, copies.

import { copy, h } from './dom';
import { texts } from './texts';
import type { Num, Table } from './protocol';

/** Rows drawn at once. */
const MOST = 500;

const SPECIAL: Record<string, number> = { '+INF': Infinity, '-INF': -Infinity, EPS: 0 };

export function shownNumber(x: Num): string {
  if (typeof x === 'string') return x === '+INF' ? '∞' : x === '-INF' ? '−∞' : x;
  return String(Number(x.toPrecision(10))).replace('-', '−');
}

/** Numbers by size, texts by themselves, numbers first. */
function compare(a: Num, b: Num): number {
  const [x, y] = [a, b].map((v) => (typeof v === 'number' ? v : SPECIAL[v]));
  if (x !== undefined && y !== undefined) return x === y ? 0 : x - y;
  if (x !== undefined || y !== undefined) return x !== undefined ? -1 : 1;
  return String(a).localeCompare(String(b), 'en', { numeric: true });
}

export function tableView(table: Table): HTMLElement {
  const numeric = table.head.map((_, c) => table.rows.length > 0 && table.rows.every((r) => typeof r[c] === 'number' || (r[c] as string) in SPECIAL));
  let order: { column: number; down: boolean } | undefined;
  let wanted = '';
  const body = h('tbody');
  const note = h('p', { class: 'note', hidden: true });
  const heads = table.head.map((name, c) =>
    h('th', { scope: 'col', class: numeric[c] ? 'number' : undefined },
      h('button', { onclick: () => sort(c) }, name === '*' ? texts.anyLabel : name)));

  const chosen = () => {
    const rows = wanted ? table.rows.filter((r) => r.some((v) => String(v).toLowerCase().includes(wanted))) : [...table.rows];
    if (order) {
      const { column, down } = order;
      rows.sort((a, b) => compare(a[column]!, b[column]!) * (down ? -1 : 1));
    }
    return rows;
  };
  const draw = () => {
    const rows = chosen();
    body.replaceChildren(...rows.slice(0, MOST).map((r) =>
      h('tr', {}, ...r.map((v, c) => h('td', { class: numeric[c] ? 'number' : undefined }, numeric[c] ? shownNumber(v) : String(v))))));
    note.hidden = rows.length <= MOST;
    note.textContent = texts.more(MOST, rows.length);
    heads.forEach((th, c) => th.setAttribute('aria-sort', order?.column === c ? (order.down ? 'descending' : 'ascending') : 'none'));
  };
  const sort = (column: number) => {
    order = { column, down: order?.column === column && !order.down };
    draw();
  };
  const search = h('input', {
    type: 'search', placeholder: texts.search, 'aria-label': texts.search,
    oninput: (e: Event) => {
      wanted = (e.target as HTMLInputElement).value.toLowerCase();
      draw();
    },
  });
  const copyButton = h('button', {
    onclick: async () => {
      const lines = [table.head, ...chosen()].map((r) => r.join('\t'));
      copyButton.textContent = (await copy(lines.join('\n'))) ? texts.copied : texts.copyFailed;
    },
  }, texts.copyTable);
  draw();
  return h('div', { class: 'table' },
    h('div', { class: 'bar' }, table.rows.length > 8 && search, copyButton),
    h('div', { class: 'scroll' }, h('table', {}, h('thead', {}, h('tr', {}, ...heads)), body)),
    note);
}
