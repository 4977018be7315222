// <bmod-model src="wall.blk"></bmod-model>: a model in any page, with one script tag.
//
//   <script type="module" src="https://SITE/bmod-model.js"></script>
//   <bmod-model src="lecture3.blk" tab="figures" readonly height="420"></bmod-model>
//   <bmod-model model="teaching/transport.blk"></bmod-model>
//   <bmod-model><pre>Scalar x; x = 1; display x;</pre></bmod-model>
//
// The model lives in a frame of the playground's own site: the page's styles do not reach it, nor it the page.
// `src` is read by the page itself, so it needs no permission from anybody.

const site = new URL('./', import.meta.url);

class BmodModel extends HTMLElement {
  static observedAttributes = ['src', 'model', 'tab', 'readonly', 'theme', 'height'];

  connectedCallback() {
    const inner = this.querySelector('pre, script, template');
    // What is in a template is no part of the page.
    this.text ??= (inner?.content ?? inner)?.textContent ?? this.textContent.trim();
    this.draw();
  }

  attributeChangedCallback() {
    // Attributes of the page come before the text inside is read.
    if (this.text !== undefined) this.draw();
  }

  async draw() {
    const turn = (this.turn = (this.turn ?? 0) + 1);
    const hash = new URLSearchParams();
    const src = this.getAttribute('src');
    if (this.hasAttribute('model')) {
      hash.set('model', this.getAttribute('model'));
    } else if (src !== null) {
      const response = await fetch(src).catch((error) => ({ ok: false, statusText: String(error) }));
      const text = response.ok ? await response.text() : `* ${src} could not be loaded: ${response.statusText}`;
      // A model that includes others is read by the playground, from beside it.
      if (response.ok && /^\$\s*include/im.test(text)) hash.set('url', new URL(src, document.baseURI).href);
      else hash.set('text', text);
    } else {
      hash.set('text', this.text);
    }
    if (turn !== this.turn) return;
    if (this.hasAttribute('tab')) hash.set('tab', this.getAttribute('tab'));
    const options = new URLSearchParams({ embed: '', run: '' });
    if (this.hasAttribute('readonly')) options.set('readonly', '');
    if (this.hasAttribute('theme')) options.set('theme', this.getAttribute('theme'));
    const frame = document.createElement('iframe');
    frame.src = new URL(`index.html?${options}#${hash}`, site).href;
    frame.title = src ?? this.getAttribute('model') ?? 'bmod';
    frame.allow = 'clipboard-write';
    frame.style.cssText = `width:100%;height:${Number(this.getAttribute('height')) || 480}px;border:1px solid #8888;border-radius:6px`;
    this.replaceChildren(frame);
  }
}

customElements.define('bmod-model', BmodModel);
