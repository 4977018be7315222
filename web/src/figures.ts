// Figures are drawn as images from the text of their SVG: an image runs no script and loads nothing.

import { download, h } from './dom';
import { texts } from './texts';

const ZOOMS = [0.5, 0.75, 1, 1.5, 2, 3, 4];

/** A picture that can be told to show another SVG, without a flicker. */
export class Figure {
  readonly element: HTMLElement;
  private image: HTMLImageElement;
  private url = '';
  private zoom = 2;

  constructor(readonly name: string, private svg: string) {
    this.image = h('img', { alt: texts.figureName(name) });
    const zoom = (by: number) => () => this.scale(by === 0 ? 2 : Math.min(ZOOMS.length - 1, Math.max(0, this.zoom + by)));
    const button = (label: string, f: () => void) => h('button', { onclick: f }, label);
    this.element = h('figure', {},
      h('div', { class: 'paper', tabindex: 0, role: 'group', 'aria-label': texts.figureName(name) }, this.image),
      h('figcaption', { class: 'bar' }, h('span', {}, name),
        h('div', { class: 'bar' }, button(texts.zoomOut, zoom(-1)), button(texts.zoomFit, zoom(0)), button(texts.zoomIn, zoom(1)),
          button(texts.svg, () => download(name, new Blob([this.svg], { type: 'image/svg+xml' }))),
          button(texts.png, () => this.png()))));
    this.show(svg);
  }

  show(svg: string): void {
    this.svg = svg;
    const old = this.url;
    this.url = URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' }));
    this.image.src = this.url;
    if (old) setTimeout(() => URL.revokeObjectURL(old), 1000);
  }

  private scale(zoom: number): void {
    this.zoom = zoom;
    this.image.style.width = `${ZOOMS[zoom]! * 100}%`;
    this.image.style.maxWidth = 'none';
  }

  private async png(): Promise<void> {
    await this.image.decode();
    const canvas = h('canvas', { width: 2 * this.image.naturalWidth, height: 2 * this.image.naturalHeight });
    const pen = canvas.getContext('2d')!;
    pen.fillStyle = 'white';
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(this.image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => blob && download(this.name.replace(/\.svg$/i, '') + '.png', blob));
  }
}

/** All figures of a run; one that is drawn again keeps its place and its zoom. */
export class Figures {
  readonly element = h('div', { class: 'figures' });
  private shown = new Map<string, Figure>();

  show(files: Record<string, string>): number {
    const svgs = Object.entries(files).filter(([name]) => /\.svg$/i.test(name));
    for (const name of [...this.shown.keys()]) {
      if (!svgs.some((s) => s[0] === name)) this.shown.delete(name);
    }
    const old = [...this.element.children];
    const now = svgs.map(([name, svg]) => {
      const figure = this.shown.get(name);
      if (figure) figure.show(svg);
      else this.shown.set(name, new Figure(name, svg));
      return this.shown.get(name)!.element;
    });
    const nodes: (Node | string)[] = now.length ? now : [h('p', { class: 'note' }, texts.noFigures)];
    if (nodes.length !== old.length || nodes.some((n, k) => n !== old[k])) this.element.replaceChildren(...nodes);
    return svgs.length;
  }
}
