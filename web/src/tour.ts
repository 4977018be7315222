// A tour of six steps. Each does something on the page and says what one sees.

import { byId, h } from './dom';
import { texts } from './texts';
import type { TabName } from './tabs';

export type Stage = { choose(id: string): Promise<void>; tab(name: TabName): void; run(): Promise<void> };

type Step = { at: string; text: string; do?(stage: Stage): void | Promise<void> };

const steps: Step[] = [
  {
    at: 'text',
    text: 'A model is a text: what there is (sets), what is known (parameters), what is decided (variables), what must hold (equations). This one carries water from wells to villages.',
    do: (s) => s.choose('teaching/transport.blk'),
  },
  {
    at: 'run',
    text: 'Run it: here, or with Ctrl+Enter in the text. Everything happens on your machine; nothing is sent anywhere. A run that takes too long is stopped by the button beside it.',
    do: (s) => s.run(),
  },
  {
    at: 'results',
    text: 'The answer: how each solve ended, in words, the best value, and below it every variable and equation as a table that can be sorted, searched and copied.',
    do: (s) => s.tab('answer'),
  },
  {
    at: 'text',
    text: 'Change something: give the village oak a need of 60 and run again. A mistake is underlined while you type; hold the pointer over it to see its cause and what to try.',
  },
  {
    at: 'sliders',
    text: 'Some models have sliders. Move the friction of this wall and watch the load factor and the picture follow. A line that begins with * @slider makes one of any number (its page says how).',
    do: async (s) => {
      await s.choose('wall.blk');
      s.tab('figures');
    },
  },
  {
    at: 'share',
    text: 'Share puts the whole project into a link. The examples and the pages about the language are beside it. That is all: go on with a model of your own.',
  },
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
      h('p', { id: 'tip-text' }, step.text),
      h('div', { class: 'bar' }, k > 0 && h('button', { onclick: () => void show(k - 1) }, texts.tourBack), next,
        k + 1 < steps.length && h('button', { onclick: end }, texts.tourEnd)));
    tip.hidden = false;
    tip.setAttribute('aria-labelledby', 'tip-text');
    light(step.at);
    next.focus();
    await step.do?.(stage);
    next.focus();
  };
  tip.onkeydown = (e) => e.key === 'Escape' && end();
  void show(0);
}
