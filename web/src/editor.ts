// The editor: CodeMirror in a shadow root, where its styles need no permission of the page.

import { closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, indentWithTab, toggleLineComment } from '@codemirror/commands';
import { bracketMatching, foldGutter, foldKeymap, indentUnit } from '@codemirror/language';
import { lintGutter, lintKeymap } from '@codemirror/lint';
import { highlightSelectionMatches, searchKeymap } from '@codemirror/search';
import { Compartment, EditorState, type Extension } from '@codemirror/state';
import { drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers } from '@codemirror/view';
import { bmodLanguage } from './language';
import { texts } from './texts';
import { changes, offset, show, type Change, type Look, type Range } from './service';
import look from './editor.css?inline';

export type EditorOptions = {
  readOnly: boolean;
  changed(text: string): void;
  run(): void;
  stop(): void;
  extensions: Extension;
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
        highlightActiveLine(),
        highlightActiveLineGutter(),
        highlightSelectionMatches(),
        bmodLanguage(),
        this.options.extensions,
        EditorView.contentAttributes.of({ 'aria-label': texts.editor, spellcheck: 'false', tabindex: '0', autocapitalize: 'off' }),
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

  /** Shows what is known about the text, if it is still the one that is shown. */
  look(name: string, look: Look): void {
    if (name === this.name) show(this.view, name, look);
  }

  change(edits: Change[]): void {
    this.view.dispatch({ changes: changes(this.view.state.doc, edits) });
  }

  go(range: Range): void {
    const text = this.view.state.doc;
    const [anchor, head] = [offset(text, range.start), offset(text, range.end)];
    this.view.dispatch({ selection: { anchor, head }, effects: EditorView.scrollIntoView(anchor, { y: 'center' }) });
    this.view.focus();
  }
}
