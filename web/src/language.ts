// Colours of a text, line by line, without its meaning: what is a comment, a keyword, a text, a number.

import { HighlightStyle, LanguageSupport, StreamLanguage, syntaxHighlighting, type StringStream } from '@codemirror/language';
import { tags } from '@lezer/highlight';

const KEYWORDS = new Set(
  ('set sets singleton parameter parameters scalar scalars table equation equations model models variable variables free positive nonnegative negative ' +
    'binary integer semicont semiint sos1 sos2 acronym acronyms file files alias aliases option options loop while for repeat if do then endloop endwhile ' +
    'endfor endif elseif else until to downto by break continue display abort scenario solve using us minimizing minimising maximizing maximising figure draw ' +
    'put putclose puttl puthd putpage execute all yes no not and or xor eqv imp system').split(' '),
);
const FUNCTIONS = new Set(
  ('sum prod smin smax sand sor abs sqrt sqr exp log log10 log2 sin cos tan arcsin arccos arctan arctan2 sinh cosh tanh power rpower vcpower ceil floor ' +
    'round trunc frac mod min max sign fact gamma loggamma beta binomial errorf entropy edist dist poly uniform uniformint normal ord card sameas diag ' +
    'ifthen mapval jdate gdate jnow inf eps na undf pi').split(' '),
);

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
  const word = stream.match(/^[a-z_]\w*/i) as RegExpMatchArray | null;
  if (word) {
    const name = word[0].toLowerCase();
    return KEYWORDS.has(name) ? 'keyword' : FUNCTIONS.has(name) ? 'function' : 'variableName';
  }
  stream.next();
  return null;
}

const language = StreamLanguage.define<State>({
  name: 'bmod',
  startState: () => ({ block: null }),
  copyState: (s) => ({ ...s }),
  token,
  tokenTable: { function: tags.function(tags.variableName) },
  languageData: { commentTokens: { line: '*' }, closeBrackets: { brackets: ['(', '[', '{', "'", '"'] } },
});

const colours = HighlightStyle.define(
  [
    { tag: tags.comment, class: 'tok-comment' },
    { tag: tags.keyword, class: 'tok-keyword' },
    { tag: tags.string, class: 'tok-string' },
    { tag: tags.number, class: 'tok-number' },
    { tag: tags.operator, class: 'tok-operator' },
    { tag: tags.meta, class: 'tok-meta' },
    { tag: tags.function(tags.variableName), class: 'tok-function' },
  ],
  { all: 'tok-name' },
);

export const bmodLanguage = () => new LanguageSupport(language, syntaxHighlighting(colours));
