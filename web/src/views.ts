// Tabs that ask bmod for another view of the model: its formulas, its dual, its optimality conditions, why it ended as it did.

import { h } from './dom';
import { copied } from './safe';
import { texts } from './texts';
import type { Engine } from './engine';
import { Stopped } from './engine';
import { messageView } from './answer';
import type { Answer, Diagnostic, Project, Settings } from './protocol';

export type Page = { html: string; text: string; remarks: string[]; model: string; diagnostics: Diagnostic[] };

export class View {
  readonly element = h('div', { class: 'formulas' });
  private seen = '';

  constructor(private kind: string, private engine: Engine, private request: () => Project & Settings, private say: (text: string) => void) {}

  show(): void {
    const request = this.request();
    const now = JSON.stringify(request);
    if (now === this.seen) return;
    this.seen = now;
    this.element.replaceChildren(h('p', { class: 'note' }, texts.running));
    void this.ask(request, now);
  }

  private async ask(request: Project & Settings, now: string): Promise<void> {
    try {
      const nodes = this.kind === 'why' ? await this.why(request) : await this.page(request);
      if (now === this.seen) this.element.replaceChildren(...nodes);
    } catch (error) {
      if (now !== this.seen) return; // another question is under way
      this.seen = '';
      const why = error instanceof Stopped ? texts.stopped : `${texts.broke} (${(error as Error).message})`;
      this.element.replaceChildren(h('p', { class: 'note' }, why));
    }
    this.say('');
  }

  private async why(request: Project & Settings): Promise<Node[]> {
    const { report } = await this.engine.call<Answer>({ do: 'run', ...request, explain: true });
    const nodes = report.diagnostics.map((d) => messageView(d, () => {}));
    if (report.solves.length === 0) return [...nodes, h('p', { class: 'note' }, texts.noSolves)];
    for (const s of report.solves) {
      const text = s.why?.text ?? [];
      nodes.push(h('section', {}, h('h2', {}, `${s.model} using ${s.using}: ${s.model_status.name}`),
        ...(text.length ? text.map((t) => h('pre', {}, t)) : [h('p', {}, texts.nothingWrong)])));
    }
    return nodes;
  }

  private async page(request: Project & Settings): Promise<Node[]> {
    const page = await this.engine.call<Page>({ do: 'view', view: this.kind, ...request });
    const nodes: Node[] = page.diagnostics.map((d) => messageView(d, () => {}));
    if (page.text) nodes.push(h('pre', { tabindex: 0 }, page.text));
    nodes.push(copied(page.html), ...page.remarks.map((r) => h('p', { class: 'note' }, r)));
    if (page.model) nodes.push(h('details', {}, h('summary', {}, texts.asModel), h('pre', { tabindex: 0 }, page.model)));
    return nodes;
  }
}
