/// <reference types="tree-sitter-cli/dsl" />
// bmod for editors that colour by tree-sitter: Zed, Helix, Neovim.
//
// The grammar knows statements, declarations, definitions, data, calls and brackets; inside of them it reads one word after the
// other and refuses nothing, because a text that is half typed has colours too. What a word means (a function, an operator, a
// kind of variable) stands in queries/highlights.scm. What depends on columns and lines is found by src/scanner.c.

const words = require('./words.json');

/** One of these words, whatever its case. */
const oneOf = (list) => new RegExp(list.join('|'), 'i');

module.exports = grammar({
  name: 'bmod',

  externals: ($) => [
    $.comment, // `* …` in the first column, `// …`, `$ontext … $offtext`, and what `$eolCom`, `$inlineCom` begin
    $.directive_word, // `$include` in the first column
    $.directive_text, // the rest of its line, or all up to `$offecho`
    $.text, // the text without quotes behind a declared name
  ],

  extras: ($) => [/[\s\x1a\ufeff]/, $.comment, $.directive],

  rules: {
    source_file: ($) => repeat(choice($.declaration, $.table, $.definition, $.statement, ';')),

    directive: ($) => seq($.directive_word, $.directive_text),

    // `Set i 'plants' / seattle, san-diego /, j;`
    declaration: ($) => prec.right(seq($.type, repeat(choice($.declared, $.group, $.string, $.data, ',')))),
    declared: ($) => prec.right(seq(field('name', $.name), repeat(choice($.group, $.text, $.string, $.percent, $.data)))),
    data: ($) => seq('/', repeat($._datum), '/'),

    // The lines of a table go on to the next `;`.
    table: ($) => prec.right(seq(optional($.type), $.table_word, $.declared, repeat(choice($._datum, '/')))),
    _datum: ($) => choice($.number, $.label, $.string, $.percent, $.group, $.operator, ',', '.'),

    // `cost..  z =e= sum(i, c(i)*x(i));`
    definition: ($) => prec.right(seq(repeat1($._item), '..', repeat($._item))),
    // An assignment, `solve`, `loop` …: a keyword, perhaps, and what follows.
    statement: ($) => prec.right(choice(repeat1($._item), seq($.keyword, repeat($._item)))),

    _item: ($) => choice($.call, $.name, $.attribute, $.number, $.string, $.percent, $.group, $.relation, $.operator, ',', '.', '/', $.digits),
    call: ($) => prec(1, seq(field('function', $.name), field('arguments', $.group))),
    attribute: ($) => prec(1, seq('.', field('name', $.name))),
    group: ($) => choice(seq('(', repeat($._inside), ')'), seq('[', repeat($._inside), ']'), seq('{', repeat($._inside), '}')),
    // Statements stand between the brackets of `loop`, `if`, `figure`.
    _inside: ($) => choice($._item, $.keyword, $.type, ';', '..'),

    type: (_) => oneOf([...words.types, `(${words.kinds.join('|')})\\s+variables?`, 'singleton\\s+sets?']),
    table_word: (_) => oneOf(words.tables),
    keyword: (_) => oneOf(words.keywords),
    // Of two words of one length the first counts: in a table a word is a label.
    number: (_) => /(\d+(\.\d+)?|\.\d+)([eE][-+]?\d+)?/,
    label: (_) => /[\w\u0080-\uffff][\w\u0080-\uffff+\-]*/,
    name: (_) => /[A-Za-z_]\w*/,
    digits: (_) => /\d+[A-Za-z_]\w*/, // a label without quotes where none may stand
    string: (_) => choice(/'[^'\n]*'/, /"[^"\n]*"/),
    percent: (_) => /%[A-Za-z_][\w.]*%/,
    relation: (_) => /=[A-Za-z]=/,
    operator: (_) => /:=|\$=|<=>|<=|>=|<>|->|\*\*|[-+*=<>$:@#|&!?~^\\%'"`]|[^\x00-\x7f]/,
  },
});
