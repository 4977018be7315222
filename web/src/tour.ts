// A tour of six steps. Each does something on the page and says what one sees.

import { byId, h } from './dom';
import { texts } from './texts';
import type { TabName } from './tabs';

export type Stage = { choose(id: string): Promise<void>; tab(name: TabName): void; run(): Promise<void> };

type Step = { at: string; do?(stage: Stage): void | Promise<void> };

/** Their texts are `texts.tourSteps`. */
const steps: Step[] = [
  {
    at: 'text',
    do: (s) => {
      s.tab('answer');
      return s.choose('teaching/transport.blk');
    },
  },
  { at: 'run', do: (s) => s.run() },
  { at: 'results', do: (s) => s.tab('answer') },
  { at: 'text' },
  {
    at: 'sliders',
    do: async (s) => {
      await s.choose('wall.blk');
      s.tab('figures');
    },
  },
  { at: 'share' },
];

export function takeTour(stage: Stage): void {
  const tip = byId('tip');
  const light = (id?: string) => {
    document.querySelectorAll('.lit').forEach((e) => e.classList.remove('lit'));
    if (id) byId(id).classList.add('lit');
  };
  const end = () => {
    tip.hidden = true;
    light();
    byId('tour').focus();
  };
  const show = async (k: number) => {
    const step = steps[k]!;
    const next = h('button', { class: 'primary', onclick: () => (k + 1 < steps.length ? void show(k + 1) : end()) }, k + 1 < steps.length ? texts.tourNext : texts.tourEnd);
    tip.replaceChildren(
      h('p', { class: 'note' }, texts.tourStep(k + 1, steps.length)),
      h('p', { id: 'tip-text' }, texts.tourSteps[k]),
      h('div', { class: 'bar' }, k > 0 && h('button', { onclick: () => void show(k - 1) }, texts.tourBack), next,
        k + 1 < steps.length && h('button', { onclick: end }, texts.tourEnd)));
    tip.hidden = false;
    tip.setAttribute('aria-labelledby', 'tip-text');
    light(step.at);
    next.focus();
    await step.do?.(stage);
    byId(step.at).scrollIntoView(); // on a phone it may lie below
    next.focus({ preventScroll: true });
  };
  tip.onkeydown = (e) => e.key === 'Escape' && end();
  void show(0);
}
