// The tabs of the results. A tab that needs work does it when it is looked at.

import { h } from './dom';
import { texts } from './texts';

export type TabName = keyof typeof texts.tabs;
export type Tab = { element: HTMLElement; show?(element: HTMLElement): void };

export class Tabs {
  current: TabName;
  private buttons = new Map<TabName, HTMLButtonElement>();

  constructor(list: HTMLElement, private panel: HTMLElement, private tabs: Partial<Record<TabName, Tab>>) {
    const names = Object.keys(tabs) as TabName[];
    this.current = names[0]!;
    for (const name of names) {
      const button = h('button', { role: 'tab', id: `tab-${name}`, 'aria-controls': 'panel', onclick: () => this.show(name) }, texts.tabs[name]);
      this.buttons.set(name, button);
      list.append(button);
    }
    list.addEventListener('keydown', (e) => {
      const step = e.key === 'ArrowRight' ? 1 : e.key === 'ArrowLeft' ? -1 : 0;
      if (step === 0) return;
      const next = names[(names.indexOf(this.current) + step + names.length) % names.length]!;
      this.show(next);
      this.buttons.get(next)!.focus();
    });
    this.show(this.current);
  }

  has(name: string): name is TabName {
    return name in this.tabs;
  }

  show(name: TabName): void {
    this.current = name;
    for (const [n, b] of this.buttons) {
      b.setAttribute('aria-selected', String(n === name));
      b.tabIndex = n === name ? 0 : -1;
    }
    const tab = this.tabs[name]!;
    this.panel.setAttribute('aria-labelledby', `tab-${name}`);
    if (this.panel.firstChild !== tab.element) this.panel.replaceChildren(tab.element);
    tab.show?.(tab.element);
  }

  /** The answer or the text has changed. */
  changed(): void {
    this.tabs[this.current]?.show?.(this.tabs[this.current]!.element);
  }
}
