// What bmod knows about the text, brought to the editor: errors with their fixes, completion, hover, definition, renaming,
// formatting, folding, colours. The answers have the shapes of the language server protocol: lines and UTF-16 units from 0.

import { autocompletion, type CompletionContext, type CompletionResult } from '@codemirror/autocomplete';
import { foldService } from '@codemirror/language';
import { setDiagnostics, type Diagnostic as Mark } from '@codemirror/lint';
import { StateEffect, StateField, type Extension, type Text } from '@codemirror/state';
import { Decoration, EditorView, hoverTooltip, keymap, type DecorationSet, type Command } from '@codemirror/view';
import { h } from './dom';
import { texts } from './texts';
import type { Engine } from './engine';

export type Position = { line: number; character: number };
export type Range = { start: Position; end: Position };
export type Location = { file: string; range: Range };
export type Change = { file: string; range: Range; newText: string };
type Found = {
  range: Range;
  severity: number;
  code: string;
  message: string;
  related: { location: Location; message: string }[];
  fixes: { title: string; edits: Change[] }[];
};
export type Look = {
  wrong: { file: string; diagnostics: Found[] }[];
  /** Line, first unit, length, kind. */
  tokens: [number, number, number, number][];
  kinds: string[];
  folds: { startLine: number; endLine: number }[];
};
type Completion = { label: string; kind: string; detail: string; documentation: string; range: Range };

export type Question =
  | { ask: 'look' | 'format' }
  | { ask: 'completion' | 'hover' | 'definition'; at: Position }
  | { ask: 'rename'; at: Position; name: string };

/** The line to the language service: it is told what has changed, and asked. */
export class Service {
  private told = new Map<string, string>();

  constructor(private engine: Engine, private project: () => { file: string; files: Record<string, string> }) {}

  async ask<T>(file: string, question: Question): Promise<T> {
    const { file: main, files } = this.project();
    const open = Object.fromEntries(Object.entries(files).filter(([name, text]) => this.told.get(name) !== text));
    const close = [...this.told.keys()].filter((name) => !Object.hasOwn(files, name));
    for (const name of close) this.told.delete(name);
    for (const [name, text] of Object.entries(open)) this.told.set(name, text);
    try {
      return await this.engine.call<T>({ do: 'edit', file, main, open, close, ...question });
    } catch (error) {
      this.told.clear(); // its worker has gone, with what it knew
      throw error;
    }
  }
}

/** Where a position lies in a text; what lies outside is moved inside. */
export function offset(text: Text, p: Position): number {
  if (p.line >= text.lines) return text.length;
  const line = text.line(p.line + 1);
  return Math.min(line.from + p.character, line.to);
}

function position(text: Text, at: number): Position {
  const line = text.lineAt(at);
  return { line: line.number - 1, character: at - line.from };
}

// ---- colours and folds: kept until the next look, moved by what is typed ----

const looked = StateEffect.define<Look>();

const colours = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, transaction) {
    marks = marks.map(transaction.changes);
    for (const e of transaction.effects) if (e.is(looked)) marks = colour(transaction.newDoc, e.value);
    return marks;
  },
  provide: (field) => EditorView.decorations.from(field),
});

function colour(text: Text, { tokens, kinds }: Look): DecorationSet {
  const marks = kinds.map((kind) => Decoration.mark({ class: `tok-${kind}` }));
  const ranges = tokens.map(([line, character, length, kind]) => {
    const from = offset(text, { line, character });
    return { from, to: Math.min(from + length, text.length), kind };
  });
  return Decoration.set(ranges.filter((r) => r.from < r.to).map((r) => marks[r.kind]!.range(r.from, r.to)), true);
}

const folds = StateField.define<Map<number, number>>({
  create: () => new Map(),
  update(now, transaction) {
    for (const e of transaction.effects) {
      if (e.is(looked)) now = new Map(e.value.folds.map((f) => [f.startLine + 1, f.endLine + 1]));
    }
    return now;
  },
});

const folding = foldService.of((state, from) => {
  const line = state.doc.lineAt(from);
  const last = state.field(folds, false)?.get(line.number);
  return last && last <= state.doc.lines ? { from: line.to, to: state.doc.line(last).to } : null;
});

// ---- errors ----

function message(text: string, code: string): HTMLElement {
  return h('div', { class: 'message' }, h('div', {}, text), h('div', { class: 'code' }, code));
}

function marks(text: Text, found: Found[]): Mark[] {
  return found.map((d) => {
    const [from, to] = [offset(text, d.range.start), offset(text, d.range.end)];
    const related = d.related.map((r) => `\n${r.location.file}, ${texts.line(r.location.range.start.line + 1)}: ${r.message}`);
    return {
      from,
      to: Math.max(to, Math.min(from + 1, text.length)),
      severity: d.severity === 1 ? 'error' : 'warning',
      message: d.message,
      renderMessage: () => message(d.message + related.join(''), d.code),
      actions: d.fixes.map((fix) => ({ name: fix.title, apply: (view: EditorView) => view.dispatch({ changes: changes(view.state.doc, fix.edits) }) })),
    };
  });
}

export function changes(text: Text, edits: Change[]) {
  return edits.map((e) => ({ from: offset(text, e.range.start), to: offset(text, e.range.end), insert: e.newText }));
}

/** Shows what a look at the text has found. */
export function show(view: EditorView, file: string, look: Look): void {
  const found = look.wrong.find((w) => w.file === file)?.diagnostics ?? [];
  view.dispatch({ effects: looked.of(look) });
  view.dispatch(setDiagnostics(view.state, marks(view.state.doc, found)));
}

// ---- Markdown of a hover: paragraphs, fenced code, `code`, **bold** ----

function inline(text: string): (Node | string)[] {
  return text.split(/(`[^`]+`|\*\*[^*]+\*\*)/).map((part) =>
    part.startsWith('`') && part.length > 2 ? h('code', {}, part.slice(1, -1)) : part.startsWith('**') && part.length > 4 ? h('b', {}, part.slice(2, -2)) : part);
}

function markdown(text: string): HTMLElement {
  const out = h('div', { class: 'hover' });
  text.split(/^```.*$/m).forEach((part, k) => {
    if (!part.trim()) return;
    if (k % 2 === 1) out.append(h('pre', {}, part.replace(/^\n|\n$/g, '')));
    else out.append(...part.trim().split(/\n\n+/).map((p) => h('p', {}, ...inline(p))));
  });
  return out;
}

// ---- what a person asks for ----

const TYPES: Record<string, string> = { set: 'type', parameter: 'constant', equation: 'method', model: 'class', label: 'enum', attribute: 'property', directive: 'keyword', option: 'property', other: 'text' };

export type Desk = {
  ask<T>(question: Question): Promise<T>;
  go(to: Location): void;
  /** Carries out changes in several files. */
  change(edits: Change[]): void;
  say(text: string): void;
};

export function serviceExtensions(desk: Desk): Extension {
  const quiet = async <T>(question: Question): Promise<T | null> => desk.ask<T>(question).catch(() => null);

  const complete = async (context: CompletionContext): Promise<CompletionResult | null> => {
    if (!context.explicit && !context.matchBefore(/[\w.$'"%]$/)) return null;
    const text = context.state.doc;
    const found = await quiet<Completion[]>({ ask: 'completion', at: position(text, context.pos) });
    if (!found?.length || context.aborted) return null;
    const from = offset(text, found[0]!.range.start);
    const options = found.map((c) => ({ label: c.label, type: TYPES[c.kind] ?? c.kind, detail: c.detail, info: c.documentation || undefined }));
    // A label may have signs in it.
    return { from, options, validFor: found.some((c) => c.kind === 'label') ? /^[\w+-]*$/ : /^\w*$/ };
  };

  const hover = hoverTooltip(async (view, pos) => {
    const text = view.state.doc;
    const found = await quiet<{ range: Range; contents: string }>({ ask: 'hover', at: position(text, pos) });
    if (!found) return null;
    return { pos: offset(text, found.range.start), end: offset(text, found.range.end), above: true, create: () => ({ dom: markdown(found.contents) }) };
  });

  const definition = (view: EditorView, at: number): boolean => {
    void quiet<Location[]>({ ask: 'definition', at: position(view.state.doc, at) }).then((found) => found?.[0] && desk.go(found[0]));
    return true;
  };
  const rename: Command = (view) => {
    const name = prompt(texts.newName)?.trim();
    if (!name) return true;
    desk.ask<Change[]>({ ask: 'rename', at: position(view.state.doc, view.state.selection.main.head), name })
      .then((edits) => desk.change(edits), (error) => desk.say((error as Error).message));
    return true;
  };
  const format: Command = () => {
    void quiet<Change[]>({ ask: 'format' }).then((edits) => edits && desk.change(edits));
    return true;
  };

  return [
    colours,
    folds,
    folding,
    autocompletion({ override: [complete] }),
    hover,
    keymap.of([
      { key: 'F12', run: (view) => definition(view, view.state.selection.main.head) },
      { key: 'F2', run: rename },
      { key: 'Shift-Alt-f', run: format },
    ]),
    EditorView.domEventHandlers({
      mousedown(event, view) {
        if (!(event.ctrlKey || event.metaKey) || event.button !== 0) return false;
        const at = view.posAtCoords({ x: event.clientX, y: event.clientY });
        return at !== null && definition(view, at);
      },
    }),
  ];
}
