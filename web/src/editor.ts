// The editor: CodeMirror in a shadow root, where its styles need no permission of the page.

import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, indentWithTab, toggleLineComment } from '@codemirror/commands';
import { bracketMatching, foldGutter, foldKeymap, indentUnit } from '@codemirror/language';
import { lintGutter, lintKeymap, setDiagnostics, type Diagnostic as Mark } from '@codemirror/lint';
import { highlightSelectionMatches, searchKeymap } from '@codemirror/search';
import { Compartment, EditorState, type Extension, type Text } from '@codemirror/state';
import { drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers } from '@codemirror/view';
import { bmodLanguage } from './language';
import { texts } from './texts';
import type { Diagnostic, Place } from './protocol';
import { h } from './dom';
import look from './editor.css?inline';

/** Where a place begins or ends in a text: columns count characters, CodeMirror counts UTF-16 units. */
function offset(text: Text, line: number, column: number): number {
  if (line < 1) return 0;
  if (line > text.lines) return text.length;
  const l = text.line(line);
  const before = [...l.text].slice(0, Math.max(0, column - 1)).join('');
  return l.from + Math.min(before.length, l.length);
}

export function range(text: Text, p: Place): [number, number] {
  const from = offset(text, p.line, p.column);
  const to = offset(text, p.end_line, p.end_column);
  return [from, Math.max(to, Math.min(from + 1, text.length))];
}

function mark(text: Text, d: Diagnostic): Mark {
  const [from, to] = d.line ? range(text, d as Place) : [0, 0];
  return {
    from,
    to,
    severity: d.severity === 'warning' ? 'warning' : 'error',
    message: d.message,
    renderMessage: () =>
      h('div', { class: 'message' },
        h('div', {}, d.message),
        d.label && h('div', { class: 'label' }, d.label),
        ...(d.labels ?? []).map((l) => h('div', { class: 'label' }, l.line ? `${texts.line(l.line)}: ${l.text}` : l.text)),
        d.help && h('div', { class: 'help' }, `${texts.fix}: ${d.help}`),
        h('div', { class: 'code' }, d.code)),
  };
}

export type EditorOptions = {
  readOnly: boolean;
  changed(text: string): void;
  run(): void;
  stop(): void;
  extensions?: Extension;
};

export class Editor {
  readonly view: EditorView;
  private writable = new Compartment();
  private states = new Map<string, EditorState>();
  private name = '';

  constructor(host: HTMLElement, private options: EditorOptions) {
    const root = host.attachShadow({ mode: 'open' });
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(look);
    this.view = new EditorView({ root, parent: root as unknown as Element });
    root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
  }

  private fresh(text: string): EditorState {
    const run = () => (this.options.run(), true);
    return EditorState.create({
      doc: text,
      extensions: [
        lineNumbers(),
        foldGutter(),
        lintGutter(),
        history(),
        drawSelection(),
        indentUnit.of('   '),
        bracketMatching(),
        closeBrackets(),
        autocompletion(),
        highlightActiveLine(),
        highlightActiveLineGutter(),
        highlightSelectionMatches(),
        bmodLanguage(),
        this.options.extensions ?? [],
        EditorView.contentAttributes.of({ 'aria-label': texts.editor, spellcheck: 'false', autocapitalize: 'off' }),
        this.writable.of(EditorState.readOnly.of(this.options.readOnly)),
        keymap.of([
          { key: 'Mod-Enter', run },
          { key: 'F5', run },
          { key: 'Mod-/', run: toggleLineComment },
          { key: 'Mod-.', run: () => (this.options.stop(), true) },
          ...closeBracketsKeymap,
          ...defaultKeymap,
          ...searchKeymap,
          ...historyKeymap,
          ...foldKeymap,
          ...completionKeymap,
          ...lintKeymap,
          indentWithTab,
        ]),
        EditorView.updateListener.of((u) => {
          if (u.docChanged) this.options.changed(u.state.doc.toString());
        }),
      ],
    });
  }

  /** Shows a file; what was undone in it before can be undone again. */
  show(name: string, text: string): void {
    if (this.name) this.states.set(this.name, this.view.state);
    this.name = name;
    const known = this.states.get(name);
    this.view.setState(known && known.doc.toString() === text ? known : this.fresh(text));
  }

  /** Forgets the files shown so far. */
  reset(): void {
    this.states.clear();
    this.name = '';
  }

  mark(diagnostics: Diagnostic[]): void {
    const { state } = this.view;
    this.view.dispatch(setDiagnostics(state, diagnostics.map((d) => mark(state.doc, d))));
  }

  go(place: Place): void {
    const [from, to] = range(this.view.state.doc, place);
    this.view.dispatch({ selection: { anchor: from, head: to }, effects: EditorView.scrollIntoView(from, { y: 'center' }) });
    this.view.focus();
  }
}
