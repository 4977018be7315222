// What tree-sitter's own lexer cannot find, because it does not know columns: comments and directives that begin in the first
// column, the marks of comments that directives set, texts that go on to the end of their line.

#include "tree_sitter/alloc.h"
#include "tree_sitter/parser.h"

enum Token { COMMENT, DIRECTIVE_WORD, DIRECTIVE_TEXT, TEXT };

// The directives that the scanner has to know.
enum Directive { OTHER, EOLCOM, ON_EOLCOM, OFF_EOLCOM, INLINECOM, ON_INLINE, OFF_INLINE, ECHO };

#define WORD 20

// All of it is kept between the tokens, as bytes.
typedef struct {
  char eol[2];       // mark of a comment to the end of its line, `$eolCom !!`
  char open[2];      // marks of a comment inside of a line, `$inlineCom /* */`
  char close[2];
  bool eol_on, inline_on;
  char directive;    // the directive whose text comes next
  char end[WORD];    // for ECHO: the directive that ends its lines
} Scanner;

static void *copy(void *to, const void *from, unsigned n) {
  for (unsigned i = 0; i < n; i++) ((char *)to)[i] = ((const char *)from)[i];
  return to;
}

void *tree_sitter_bmod_external_scanner_create(void) {
  Scanner *s = ts_calloc(1, sizeof(Scanner));
  s->eol[0] = s->eol[1] = '!';
  s->open[0] = s->close[1] = '/';
  s->open[1] = s->close[0] = '*';
  return s;
}

void tree_sitter_bmod_external_scanner_destroy(void *s) { ts_free(s); }

unsigned tree_sitter_bmod_external_scanner_serialize(void *s, char *buffer) {
  copy(buffer, s, sizeof(Scanner));
  return sizeof(Scanner);
}

void tree_sitter_bmod_external_scanner_deserialize(void *s, const char *buffer, unsigned length) {
  if (length == sizeof(Scanner)) {
    copy(s, buffer, length);
    return;
  }
  Scanner *fresh = tree_sitter_bmod_external_scanner_create();
  copy(s, fresh, sizeof(Scanner));
  ts_free(fresh);
}

static bool blank(int32_t c) { return c == ' ' || c == '\t' || c == '\r' || c == 0x1a || c == 0xfeff; }
static bool letter(int32_t c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
static bool line_ends(TSLexer *l) { return l->lookahead == '\n' || l->eof(l); }
static void advance(TSLexer *l) { l->advance(l, false); }

// Says whether the line ends with a `\`.
static bool to_line_end(TSLexer *l) {
  int32_t last = 0;
  for (; !line_ends(l); advance(l)) {
    if (!blank(l->lookahead)) last = l->lookahead;
  }
  return last == '\\';
}

static bool same(const char *a, const char *b) {
  while (*a && *a == *b) a++, b++;
  return *a == *b;
}

// The word of a directive behind its `$`, in small letters.
static void word(TSLexer *l, char into[WORD]) {
  int n = 0;
  while (l->lookahead == '$') advance(l);
  while (blank(l->lookahead)) advance(l);
  while (letter(l->lookahead)) {
    if (n < WORD - 1) into[n++] = (char)(l->lookahead | 0x20);
    advance(l);
  }
  into[n] = 0;
}

// Goes on to the line that begins with `$end`, and stops before it, or behind it.
static void to_directive(TSLexer *l, const char *end, bool behind) {
  char found[WORD];
  for (;;) {
    to_line_end(l);
    l->mark_end(l);
    if (l->eof(l)) return;
    advance(l);
    if (l->lookahead != '$') continue;
    word(l, found);
    if (same(found, end)) break;
  }
  if (!behind) return;
  to_line_end(l);
  l->mark_end(l);
}

static bool directive_word(Scanner *s, TSLexer *l) {
  static const struct { const char *word, *end; enum Directive is; } known[] = {
    {"eolcom", "", EOLCOM}, {"oneolcom", "", ON_EOLCOM}, {"offeolcom", "", OFF_EOLCOM},
    {"inlinecom", "", INLINECOM}, {"oninline", "", ON_INLINE}, {"offinline", "", OFF_INLINE},
    {"onecho", "offecho", ECHO}, {"onechos", "offecho", ECHO}, {"onechov", "offecho", ECHO},
    {"onput", "offput", ECHO}, {"onputs", "offput", ECHO}, {"onputv", "offput", ECHO},
    {"onembeddedcode", "offembeddedcode", ECHO},
  };
  char found[WORD];
  word(l, found);
  if (same(found, "ontext")) {
    to_directive(l, "offtext", true);
    l->result_symbol = COMMENT;
    return true;
  }
  s->directive = OTHER;
  for (unsigned i = 0; i < sizeof known / sizeof *known; i++) {
    if (!same(found, known[i].word)) continue;
    s->directive = (char)known[i].is;
    for (unsigned k = 0; k < WORD; k++) if (!(s->end[k] = known[i].end[k])) break;
  }
  l->mark_end(l);
  l->result_symbol = DIRECTIVE_WORD;
  return true;
}

// A mark of one sign or two.
static void mark(TSLexer *l, char into[2]) {
  while (blank(l->lookahead)) advance(l);
  into[0] = into[1] = 0;
  for (int i = 0; !line_ends(l) && !blank(l->lookahead); i++) {
    if (i < 2) into[i] = (char)l->lookahead;
    advance(l);
  }
}

static bool directive_text(Scanner *s, TSLexer *l) {
  switch (s->directive) {
    case EOLCOM: mark(l, s->eol); s->eol_on = s->eol[0]; break;
    case INLINECOM: mark(l, s->open); mark(l, s->close); s->inline_on = s->open[0] && s->close[0]; break;
    case ON_EOLCOM: case OFF_EOLCOM: s->eol_on = s->directive == ON_EOLCOM; break;
    case ON_INLINE: case OFF_INLINE: s->inline_on = s->directive == ON_INLINE; break;
    default: break;
  }
  if (s->directive == ECHO) {
    to_directive(l, s->end, false);
  } else {
    // A macro goes on behind a `\`.
    while (to_line_end(l) && !l->eof(l)) advance(l);
    l->mark_end(l);
  }
  s->directive = OTHER;
  l->result_symbol = DIRECTIVE_TEXT;
  return true;
}

// Whether a mark whose first sign has been read is here.
static bool second(TSLexer *l, const char mark[2]) {
  if (!mark[1]) return true;
  if (l->lookahead != (unsigned char)mark[1]) return false;
  advance(l);
  return true;
}

// A comment that does not begin a line. What is read in vain is given back when the scanner finds nothing.
static bool comment(Scanner *s, TSLexer *l) {
  int32_t first = l->lookahead;
  bool eol = s->eol_on && first == (unsigned char)s->eol[0];
  bool inside = s->inline_on && first == (unsigned char)s->open[0];
  if (!eol && !inside && first != '/') return false;
  l->result_symbol = COMMENT;
  advance(l);
  // Two slashes begin a comment in every `.blk`.
  if ((eol && second(l, s->eol)) || (first == '/' && l->lookahead == '/')) {
    to_line_end(l);
    l->mark_end(l);
    return true;
  }
  if (!inside || !second(l, s->open)) return false;
  while (!l->eof(l)) {
    bool ends = l->lookahead == (unsigned char)s->close[0];
    advance(l);
    if (ends && second(l, s->close)) break;
  }
  l->mark_end(l);
  return true;
}

// `canning plants` up to what ends it.
static bool text(Scanner *s, TSLexer *l) {
  while (!line_ends(l) && l->lookahead != '/' && l->lookahead != ',' && l->lookahead != ';') {
    bool gap = blank(l->lookahead);
    bool eol = s->eol_on && l->lookahead == (unsigned char)s->eol[0];
    advance(l);
    if (eol && second(l, s->eol)) break;
    if (!gap) l->mark_end(l);
  }
  l->result_symbol = TEXT;
  return true;
}

bool tree_sitter_bmod_external_scanner_scan(void *payload, TSLexer *l, const bool *valid) {
  Scanner *s = payload;
  // After an error everything is valid.
  bool lost = valid[DIRECTIVE_TEXT] && valid[TEXT];
  if (valid[DIRECTIVE_TEXT] && !lost) return directive_text(s, l);

  bool new_line = false;
  while (blank(l->lookahead) || l->lookahead == '\n') {
    new_line |= l->lookahead == '\n';
    l->advance(l, true);
  }
  if (l->eof(l)) return false;
  bool column = (l->lookahead == '*' || l->lookahead == '$') && l->get_column(l) == 0;
  if (column && l->lookahead == '*') {
    to_line_end(l);
    l->mark_end(l);
    l->result_symbol = COMMENT;
    return true;
  }
  if (column && valid[DIRECTIVE_WORD]) return directive_word(s, l);
  bool begins_text = letter(l->lookahead) || l->lookahead >= 0x80;
  if (valid[TEXT] && !lost && !new_line && begins_text) return text(s, l);
  return valid[COMMENT] && comment(s, l);
}
