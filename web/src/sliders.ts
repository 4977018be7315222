// Sliders for what the text marks with `* @slider NAME LOW HIGH STEP 'text'`.

import { h } from './dom';
import { sliders, written, type Open, type Slider } from './project';
import { texts } from './texts';
import type { Settings } from './protocol';

export class Sliders {
  private found: Slider[] = [];
  private open: Open | undefined;
  private drawn = '';

  constructor(private element: HTMLElement, private moved: () => void) {}

  reset(open: Open): void {
    this.drawn = '';
    this.show(open);
  }

  /** Draws the sliders of the text that is run; the others stay as they are. */
  show(open: Open): void {
    this.open = open;
    this.found = sliders(open.files[open.file] ?? '');
    const now = JSON.stringify(this.found);
    if (now === this.drawn) return;
    this.drawn = now;
    this.element.hidden = this.found.length === 0;
    this.element.replaceChildren(...this.found.flatMap((s) => this.row(s)));
  }

  private row(s: Slider): HTMLElement[] {
    const values = this.open!.values;
    const start = written(s, this.open!.files) ?? s.low;
    // The text may have narrowed the range since it was moved.
    if (values[s.name] !== undefined) values[s.name] = Math.min(Math.max(values[s.name]!, s.low), s.high);
    const limits = { min: s.low, max: s.high, step: s.step, 'aria-label': s.text || s.name, value: values[s.name] ?? start };
    const range = h('input', { type: 'range', ...limits });
    const number = h('input', { type: 'number', ...limits });
    const set = (text: string) => {
      const value = Number(text);
      if (text === '' || !Number.isFinite(value)) return;
      values[s.name] = value;
      range.value = number.value = text;
      this.moved();
    };
    range.addEventListener('input', () => set(range.value));
    number.addEventListener('change', () => set(number.value));
    const back = h('button', {
      title: texts.sliderBack, 'aria-label': `${s.name}: ${texts.sliderBack}`,
      onclick: () => {
        delete values[s.name];
        range.value = number.value = String(start);
        this.moved();
      },
    }, '↺');
    return [h('label', {}, s.text || s.name), range, number, back];
  }

  /** What the sliders say to a run. */
  settings(): Settings {
    const values = this.open?.values ?? {};
    const moved = this.found.filter((s) => values[s.name] !== undefined);
    return {
      scalars: moved.filter((s) => !s.define).map((s) => [s.name, values[s.name]!]),
      defines: moved.filter((s) => s.define).map((s) => [s.name, String(values[s.name])]),
    };
  }
}
