// HTML that bmod makes of a model (formulas in MathML) contains a stranger's words. Only known elements are copied, without
// attributes that could do anything; texts go in as texts.

const MATHML = 'http://www.w3.org/1998/Math/MathML';
const HTML = new Set('div span p h1 h2 h3 h4 table thead tbody tr th td dl dt dd ul ol li b i em strong code pre br section figure figcaption'.split(' '));
const MATH = new Set('math mrow mi mn mo mtext mspace msub msup msubsup munder mover munderover mfrac msqrt mroot mtable mtr mtd mstyle mpadded mphantom'.split(' '));
const ATTRIBUTES = new Set(['class', 'display', 'mathvariant', 'stretchy', 'fence', 'separator', 'form', 'width', 'lspace', 'rspace', 'columnalign', 'displaystyle', 'scope', 'colspan']);
/** Their content is no text to read. */
const SILENT = new Set(['script', 'style', 'template', 'iframe', 'object', 'svg', 'title', 'head']);

export function copied(html: string): DocumentFragment {
  const out = document.createDocumentFragment();
  copyChildren(new DOMParser().parseFromString(html, 'text/html').body, out);
  return out;
}

function copyChildren(from: Node, to: Node): void {
  for (const node of from.childNodes) {
    if (node instanceof Text) {
      to.appendChild(document.createTextNode(node.data));
    } else if (node instanceof Element) {
      const name = node.localName;
      if (SILENT.has(name)) continue;
      const made = MATH.has(name) ? document.createElementNS(MATHML, name) : HTML.has(name) ? document.createElement(name) : null;
      for (const a of made ? node.attributes : []) if (ATTRIBUTES.has(a.name)) made!.setAttribute(a.name, a.value);
      copyChildren(node, made ? to.appendChild(made) : to);
    }
  }
}
