// An exercise: hints one after the other, and whether the hidden checks hold; of an example of a page whether its claims `*=` do.

import { h } from './dom';
import { texts } from './texts';
import type { Open } from './project';

type Claims = { what: string; holds: boolean }[];
const given = new WeakMap<object, number>();

export function showExercise(bar: HTMLElement, open: Open, claims: Claims | undefined): void {
  const exercise = open.exercise;
  bar.hidden = !exercise && !claims?.length;
  if (bar.hidden) return;
  const wrong = (claims ?? []).filter((c) => !c.holds);
  const checks = claims?.length ?? 0;
  const right = checks > 0 && wrong.length === 0;
  const verdict = checks === 0 ? texts.checksUnseen : right ? `✓ ${texts.checksHold(checks)}` : texts.checksFail(wrong.length, checks, wrong[0]!.what);
  const status = h('span', { class: right ? 'right' : undefined, role: 'status' }, verdict);
  if (!exercise) return bar.replaceChildren(h('div', { class: 'bar' }, status));
  const hints = h('ol', {});
  const tell = () => hints.replaceChildren(...exercise.hints.slice(0, given.get(exercise) ?? 0).map((t) => h('li', {}, t)));
  const next = h('button', {
    onclick: () => {
      given.set(exercise, (given.get(exercise) ?? 0) + 1);
      next.disabled = given.get(exercise)! >= exercise.hints.length;
      tell();
    },
  }, texts.hint);
  next.disabled = (given.get(exercise) ?? 0) >= exercise.hints.length;
  tell();
  bar.replaceChildren(h('div', { class: 'bar' }, h('b', {}, texts.exercise), status, next), hints);
}
