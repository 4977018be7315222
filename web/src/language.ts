// Colours of a text, line by line, without its meaning: comments, texts, numbers, directives. bmod itself knows the rest
// (service.ts); this is what is seen before it has looked.

import { HighlightStyle, LanguageSupport, StreamLanguage, syntaxHighlighting, type StringStream } from '@codemirror/language';
import { tags } from '@lezer/highlight';

type State = { block: string | null };

function token(stream: StringStream, state: State): string | null {
  if (state.block) {
    if (stream.sol() && stream.match(new RegExp(`^\\$off${state.block}`, 'i'))) state.block = null;
    stream.skipToEnd();
    return 'comment';
  }
  if (stream.sol()) {
    if (stream.peek() === '*') {
      stream.skipToEnd();
      return 'comment';
    }
    if (stream.peek() === '$') {
      const opens = stream.match(/^\$on(text|embeddedcode|put)\b/i) as RegExpMatchArray | null;
      if (opens) {
        state.block = opens[1]!;
        stream.skipToEnd();
        return 'comment';
      }
      stream.match(/^\$\w*/);
      return 'meta';
    }
  }
  if (stream.eatSpace()) return null;
  const quote = stream.match(/^(['"])/) as RegExpMatchArray | null;
  if (quote) {
    while (!stream.eol() && stream.next() !== quote[1]);
    return 'string';
  }
  if (stream.match(/^\/\/.*/)) return 'comment';
  if (stream.match(/^%[\w.]+%/)) return 'meta';
  if (stream.match(/^(\d+\.?\d*|\.\d+)([ed][+-]?\d+)?/i)) return 'number';
  if (stream.match(/^=[elgxncb]=/i) || stream.match(/^\.\.(?!\.)/) || stream.match(/^[-+*\/=<>$]/)) return 'operator';
  if (!stream.match(/^\w+/)) stream.next();
  return null;
}

const language = StreamLanguage.define<State>({
  name: 'bmod',
  startState: () => ({ block: null }),
  copyState: (s) => ({ ...s }),
  token,
  languageData: { commentTokens: { line: '*' }, closeBrackets: { brackets: ['(', '[', '{', "'", '"'] } },
});

const colours = HighlightStyle.define([
  { tag: tags.comment, class: 'tok-comment' },
  { tag: tags.string, class: 'tok-string' },
  { tag: tags.number, class: 'tok-number' },
  { tag: tags.operator, class: 'tok-operator' },
  { tag: tags.meta, class: 'tok-macro' },
]);

export const bmodLanguage = () => new LanguageSupport(language, syntaxHighlighting(colours));
