//! The layout of a text: indentation, blanks between words, capitals of keywords.
//!
//! Lines stay lines. Comments, directives, the lines of tables and whatever is not read as statements stay as they are. What
//! stood under one another with room before it still does, whatever happens to its left. No word is joined, split or
//! moved to another line, and the result is taken apart again and compared word by word before it is given out: should
//! anything differ, the text comes back as it was.

mod spacing;

use super::lines::LineKind;
use super::scan::{Role, Scan, Token};
use crate::syntax::words::Class;
use rustc_hash::{FxHashMap, FxHashSet};

/// Columns by which what is inside of a statement stands to its right.
const STEP: usize = 3;

/// A word in a line of the result.
struct Cell {
    text: String,
    /// Column in the text as it was; tabs count to the next eighth.
    old: usize,
    /// Where the text as it was ends.
    old_end: usize,
    /// Blanks before it unless it stands under another.
    gap: usize,
    new: usize,
    token: usize,
}

/// Where a cell stood. In the order of these fields cells are placed.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Placed {
    old: usize,
    /// What is compared.
    kind: String,
    /// Number of the line among those with cells.
    line: usize,
    row: usize,
    cell: usize,
}

/// The kind of the first word of a line: it comes behind all others of its column, which it may stand under.
const FIRST: &str = "~";

/// Lines that may stand between two words of a column.
const BRIDGED: usize = 2;

impl Placed {
    fn under(&self, above: &Self) -> bool {
        self.old == above.old && self.kind == above.kind && self.line <= above.line + 1 + BRIDGED
    }
}

/// What becomes of a line.
enum Row {
    /// It stays.
    Kept(String),
    Blank,
    Cells(Vec<Cell>),
}

/// Lays out a text; `slashes`: `//` begins a comment, as in a `.blk`.
pub fn format(text: &str, slashes: bool) -> String {
    let normal = match text.contains('\r') {
        true => text.replace("\r\n", "\n").replace('\r', "\n"),
        false => text.to_owned(),
    };
    lay_out(&normal, slashes).unwrap_or(normal)
}

/// The same; None if the result would not be the same words.
pub(super) fn lay_out(text: &str, slashes: bool) -> Option<String> {
    let scan = Scan::of(text, slashes);
    let out = Layout::new(text, &scan).render();
    same_words(text, &scan, &out, slashes).then_some(out)
}

/// Whether two texts are the same words on the same lines.
fn same_words(text: &str, scan: &Scan, out: &str, slashes: bool) -> bool {
    let again = Scan::of(out, slashes);
    let line = |s: &Scan, t: &Token| s.lines.kinds[s.lines.line_of(t.lo)];
    // `.5` where no number is expected, `==`, which is no relation, and `2a`, which is no name, stay together.
    let pairs = |s: &Scan, t: &str| {
        let touching = s.tokens.windows(2).filter(|w| w[0].hi == w[1].lo);
        let one = |w: &&[Token]| {
            let (a, b) = (&t[w[0].lo..w[0].hi], &t[w[1].lo..w[1].hi]);
            let twice = w[0].role == Role::Operator && a == b;
            a == "."
                || twice
                || a.ends_with(char::is_alphanumeric) && b.starts_with(char::is_alphanumeric)
        };
        touching.filter(one).count()
    };
    if pairs(scan, text) != pairs(&again, out) {
        return false;
    }
    scan.tokens.len() == again.tokens.len()
        && scan.tokens.iter().zip(&again.tokens).all(|(a, b)| {
            let (x, y) = (&text[a.lo..a.hi], &out[b.lo..b.hi]);
            a.role == b.role
                && line(scan, a) == line(&again, b)
                && match a.role {
                    Role::Keyword | Role::Operator => x.eq_ignore_ascii_case(y),
                    Role::Comment => x.trim_end() == y.trim_end(),
                    _ => x == y,
                }
        })
}

struct Layout<'a> {
    text: &'a str,
    scan: &'a Scan,
    /// By token: what encloses it directly.
    inside: Vec<Inside>,
    /// By token: the statement that begins with it.
    begins: FxHashMap<usize, usize>,
    /// By token: the statement around it.
    around: Vec<usize>,
    /// By token that opens: the one that closes it, and back.
    partner: FxHashMap<usize, usize>,
    /// Names that the text declares, lower case.
    declared: FxHashSet<String>,
}

/// What a token stands in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    /// No parentheses.
    Nothing,
    /// Indices: no blanks.
    Indices,
    /// Arguments of a function, if they are short: blanks as they are.
    Arguments,
    /// Operands, the parts of a sum or a loop.
    Parts,
}

impl<'a> Layout<'a> {
    fn new(text: &'a str, scan: &'a Scan) -> Self {
        let mut layout = Self {
            text,
            scan,
            inside: Vec::with_capacity(scan.tokens.len()),
            begins: FxHashMap::default(),
            around: vec![usize::MAX; scan.tokens.len()],
            partner: FxHashMap::default(),
            declared: FxHashSet::default(),
        };
        let names = scan.tokens.iter().filter(|t| t.role == Role::Declared);
        layout.declared = names
            .map(|t| text[t.lo..t.hi].to_ascii_lowercase())
            .collect();
        for (n, s) in scan.statements.iter().enumerate() {
            layout.begins.insert(s.first, n);
            for t in s.first..s.end.min(scan.tokens.len()) {
                layout.around[t] = n;
            }
        }
        let mut open: Vec<(usize, Inside)> = Vec::new();
        for (n, t) in scan.tokens.iter().enumerate() {
            if t.role == Role::Close
                && let Some((o, _)) = open.pop()
            {
                layout.partner.insert(n, o);
                layout.partner.insert(o, n);
            }
            let within = open.last().map_or(Inside::Nothing, |o| o.1);
            layout.inside.push(within);
            if t.role == Role::Open {
                open.push((n, layout.opens(n, within)));
            }
            if layout.begins.contains_key(&n) && scan.statements[layout.begins[&n]].depth == 0 {
                open.clear();
            }
        }
        layout
    }

    fn word(&self, token: usize) -> &'a str {
        self.scan.text_of(token, self.text)
    }

    /// Column of a byte in its line, tabs to the next eighth.
    fn column(&self, at: usize) -> usize {
        let line = self.scan.lines.starts[self.scan.lines.line_of(at)];
        self.text[line..at].chars().fold(0, |n, c| match c {
            '\t' => (n / 8 + 1) * 8,
            _ => n + 1,
        })
    }

    fn render(&self) -> String {
        let lines = &self.scan.lines;
        let mut rows = Vec::with_capacity(lines.kinds.len());
        let mut next = 0;
        for line in 0..lines.kinds.len() {
            let range = lines.range(line, self.text);
            let body = &self.text[range.lo..range.hi];
            let from = next;
            let end = range.hi.max(range.lo + 1);
            let here = self.scan.tokens[from..].iter().take_while(|t| t.lo < end);
            next += here.count();
            let tokens = from..next;
            let table = self.scan.tokens[tokens.clone()].iter().any(|t| t.table);
            rows.push(match lines.kinds[line] {
                LineKind::Raw | LineKind::Directive | LineKind::Fixed => Row::Kept(body.to_owned()),
                LineKind::Comment => Row::Kept(body.trim_end().to_owned()),
                LineKind::Code if tokens.is_empty() && body.trim().is_empty() => Row::Blank,
                LineKind::Code if table || tokens.is_empty() => {
                    Row::Kept(body.trim_end().to_owned())
                }
                LineKind::Code => Row::Cells(tokens.map(|t| self.cell(t, range.lo)).collect()),
            });
        }
        self.place(&mut rows);
        write(&rows)
    }

    fn cell(&self, token: usize, line: usize) -> Cell {
        let t = &self.scan.tokens[token];
        let old = self.column(t.lo);
        let word = self.word(token);
        let first = token == 0 || self.scan.tokens[token - 1].hi <= line;
        Cell {
            text: self.spelled(token, word),
            old,
            old_end: old + word.chars().count(),
            gap: if first { 0 } else { self.gap(token - 1, token) },
            new: 0,
            token,
        }
    }

    /// A word as it is written: keywords in small letters, those of declarations with a capital.
    fn spelled(&self, token: usize, word: &str) -> String {
        match self.scan.tokens[token].role {
            Role::Keyword => {
                let small = word.to_ascii_lowercase();
                let declares = self.begins.get(&token).map(|s| {
                    self.scan.statements[*s].class.declares()
                        || self.scan.statements[*s].class == Class::Alias
                });
                match declares {
                    Some(true) if small.starts_with("sos") => small.to_ascii_uppercase(),
                    Some(true) => small[..1].to_ascii_uppercase() + &small[1..],
                    _ => small,
                }
            }
            Role::Operator if word.len() == 3 && word.starts_with('=') => word.to_ascii_lowercase(),
            Role::Comment | Role::Text => word.trim_end_matches([' ', '\t', '\r']).to_owned(),
            _ => word.to_owned(),
        }
    }

    /// Gives every cell its column, from left to right.
    fn place(&self, rows: &mut [Row]) {
        let mut at: Vec<Placed> = Vec::new();
        let mut line = 0;
        for (row, cells) in rows.iter().enumerate() {
            let Row::Cells(cells) = cells else { continue };
            at.extend(cells.iter().enumerate().map(|(cell, c)| Placed {
                old: c.old,
                kind: match cell {
                    0 => FIRST.into(),
                    // What touches the word before it stays there.
                    _ if c.gap == 0 && !self.is_signed(c.token) => format!("{row} {cell}"),
                    _ => self.column_kind(c.token),
                },
                line,
                row,
                cell,
            }));
            line += 1;
        }
        at.sort();
        let mut from = 0;
        while from < at.len() {
            let mut to = from + 1;
            while to < at.len() && at[to].under(&at[to - 1]) {
                to += 1;
            }
            self.column_of(rows, &at[from..to]);
            from = to;
        }
    }

    /// Words stand under one another if they are of one kind: both `=`, both texts, both behind `..`.
    fn column_kind(&self, token: usize) -> String {
        let role = |t: usize| self.scan.tokens[t].role;
        match role(token) {
            // The first argument of a figure's element.
            _ if self.in_figure(token)
                && !matches!(role(token - 1), Role::Comma | Role::Operator | Role::Open) =>
            {
                "part".into()
            }
            Role::Quoted | Role::Text | Role::Slash => "part".into(),
            Role::Comment => "comment".into(),
            Role::Operator if self.spaced(token) => "operator".into(),
            _ => {
                let before = token - 1 - usize::from(self.is_signed(token) && token > 1);
                match role(before) {
                    Role::Operator => format!("behind {}", self.word(before)),
                    other => format!("behind {other:?}"),
                }
            }
        }
    }

    fn in_figure(&self, token: usize) -> bool {
        let statement = self.scan.statements.get(self.around[token]);
        let block = statement.and_then(|s| s.block);
        block.is_some_and(|open| self.word(open) == "{" && open > 1)
    }

    /// Places cells that stood under one another: there they stay, if there was room before one of them.
    fn column_of(&self, rows: &mut [Row], group: &[Placed]) {
        if group[0].cell == 0 {
            for p in group {
                let indent = self.indent(rows, p.row);
                if let Row::Cells(cells) = &mut rows[p.row] {
                    cells[0].new = indent;
                }
            }
            return;
        }
        // Where the word before ends, the blanks behind it, and those beyond what would be there anyway.
        let seen: Vec<(usize, usize, usize)> = group
            .iter()
            .filter_map(|p| {
                let Row::Cells(cells) = &rows[p.row] else {
                    return None;
                };
                let (before, cell) = (&cells[p.cell - 1], &cells[p.cell]);
                let end = before.new + before.text.chars().count();
                // The first name of a declaration stands beside its keyword.
                let roles = [before, cell].map(|c| self.scan.tokens[c.token].role);
                let room = match roles == [Role::Keyword, Role::Declared] {
                    true => 0,
                    false => cell.old.saturating_sub(before.old_end + cell.gap),
                };
                Some((end, cell.gap, room))
            })
            .collect();
        let together = group.len() > 1 && seen.iter().any(|s| s.2 > 0);
        let least = seen.iter().map(|s| s.2).min().unwrap_or(0);
        let column = seen.iter().map(|s| s.0 + s.1).max().unwrap_or(0) + least;
        for (p, s) in group.iter().zip(&seen) {
            if let Row::Cells(cells) = &mut rows[p.row] {
                cells[p.cell].new = if together { column } else { s.0 + s.1 };
            }
        }
    }

    /// Columns before the first word of a line.
    fn indent(&self, rows: &[Row], r: usize) -> usize {
        let Row::Cells(cells) = &rows[r] else {
            return 0;
        };
        let first = &cells[0];
        let role = self.scan.tokens[first.token].role;
        let row_of = |token: usize| {
            (0..=r).rev().find(|n| match &rows[*n] {
                Row::Cells(c) => c[0].token <= token,
                _ => false,
            })
        };
        let start_of = |n: Option<usize>| match n.map(|n| &rows[n]) {
            Some(Row::Cells(c)) => (c[0].new, c[0].old),
            _ => (0, 0),
        };
        // A statement: by the blocks around it.
        if let Some(&s) = self.begins.get(&first.token) {
            let statement = &self.scan.statements[s];
            return match statement.block {
                Some(open) => start_of(row_of(open)).0 + STEP,
                None => 0,
            };
        }
        let around = self.scan.statements.get(self.around[first.token]);
        let Some(statement) = around else {
            return if role == Role::Comment {
                first.old.max(1)
            } else {
                first.old
            };
        };
        // What closes or divides a block stands under the statement that has it.
        let word = self.word(first.token).to_ascii_lowercase();
        let divides = role == Role::Keyword
            && matches!(
                word.as_str(),
                "else" | "elseif" | "until" | "endif" | "endloop" | "endwhile" | "endfor"
            );
        let closes_block = role == Role::Close
            && self
                .partner
                .get(&first.token)
                .is_some_and(|o| self.scan.statements.iter().any(|s| s.block == Some(*o)));
        if divides || closes_block {
            let open = self
                .partner
                .get(&first.token)
                .copied()
                .unwrap_or(statement.first);
            let at = row_of(open);
            return start_of(at).0;
        }
        // A name of a declaration: under the first name, or one step to the right.
        let start = row_of(statement.first);
        let Some(Row::Cells(head)) = start.map(|n| &rows[n]) else {
            return first.old;
        };
        let base = head[0].new;
        if role == Role::Declared && statement.class.declares() {
            let keyword_line: Vec<_> = head.iter().filter(|c| c.token >= statement.first).collect();
            let named = keyword_line
                .iter()
                .find(|c| self.scan.tokens[c.token].role == Role::Declared);
            return match named {
                Some(c) => {
                    let before = keyword_line.iter().take_while(|k| k.token < c.token);
                    base + before.map(|k| k.text.chars().count() + 1).sum::<usize>()
                }
                None => base + STEP,
            };
        }
        // Under what it stood under, or as far from the statement's beginning as it was.
        let from = start.unwrap_or(r);
        for n in (from..r).rev() {
            if let Row::Cells(cells) = &rows[n]
                && let Some(c) = cells
                    .iter()
                    .skip(1)
                    .find(|c| c.old == first.old && c.token >= statement.first)
            {
                return c.new.max(1);
            }
        }
        let begin = head
            .iter()
            .find(|c| c.token == statement.first)
            .unwrap_or(&head[0]);
        match first.old.checked_sub(begin.old) {
            Some(right) if right > 0 => (begin.new + right).max(base + 1),
            _ => base + STEP,
        }
    }
}

/// The lines as a text: no blanks at line ends, never two empty lines, one line end at the end.
fn write(rows: &[Row]) -> String {
    let mut out = String::new();
    let mut blank = true;
    for row in rows {
        match row {
            Row::Blank => {
                if !blank {
                    out.push('\n');
                }
                blank = true;
                continue;
            }
            Row::Kept(line) => out.push_str(line),
            Row::Cells(cells) => {
                let mut column = 0;
                for c in cells {
                    for _ in column..c.new {
                        out.push(' ');
                    }
                    out.push_str(&c.text);
                    column = c.new.max(column) + c.text.chars().count();
                }
            }
        }
        out.push('\n');
        blank = false;
    }
    while out.ends_with("\n\n") {
        out.pop();
    }
    out
}
