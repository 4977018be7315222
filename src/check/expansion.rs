//! Keys in data that stand for many: ranges, and products of sets.

use super::node::SymbolId;
use super::symbols::{DomainPosition, UNIVERSE};
use super::{Checked, Compiler};
use crate::data::table::Table;
use crate::data::universe::{AT_ONCE, Label};
use crate::diag::{Diagnostic, Severity};
use crate::source::Span;
use crate::syntax::ast::Ident;
use crate::syntax::data::KeyPart;
use std::borrow::Cow;
use std::rc::Rc;

/// What a label takes, about: its name twice, its place in the universe.
const LABEL_BYTES: usize = 128;

/// What a record takes, about.
pub(super) fn record_bytes(dim: usize) -> usize {
    24 + 8 * dim
}

/// A range or a product of sets in data may not make more records than this.
pub(crate) const MAX_EXPANSION: usize = 50_000_000;

/// A set without elements, in data: `set s / system.empty /`.
const NO_ELEMENTS: &str = "system.empty";

/// Tuples of labels, one behind the other.
#[derive(Default)]
pub(crate) struct Tuples {
    /// Labels a tuple.
    pub width: usize,
    /// All of them.
    pub labels: Vec<Label>,
    /// What data say of each besides: factors of its value. Empty where all are 1.
    factors: Vec<f64>,
    /// And texts. Empty where there is none.
    texts: Vec<Rc<str>>,
}

/// A tuple, and what data say of it besides.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    /// Its labels.
    pub labels: &'a [Label],
    /// Factor of its value.
    pub factor: f64,
    /// Its text; may be empty.
    pub text: &'a str,
}

/// Two texts of an element as one.
pub(super) fn together<'a>(first: &'a str, second: &'a str) -> Cow<'a, str> {
    match (first.is_empty(), second.is_empty()) {
        (true, _) => second.into(),
        (_, true) => first.into(),
        _ => format!("{first} {second}").into(),
    }
}

impl Tuples {
    /// One label a tuple.
    pub(crate) fn single(labels: Vec<Label>) -> Self {
        Self {
            width: 1,
            labels,
            ..Self::default()
        }
    }

    /// The keys of a table.
    pub(crate) fn of(table: &Table) -> Self {
        Self {
            width: table.dim(),
            labels: table.iter().flat_map(|(k, _)| k.iter().copied()).collect(),
            ..Self::default()
        }
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.labels.len() / self.width.max(1)
    }

    /// Whether data say more of them than that they are there.
    pub(crate) fn have_texts(&self) -> bool {
        !self.texts.is_empty()
    }

    /// The tuples.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        let keys = self.labels.chunks_exact(self.width.max(1)).enumerate();
        keys.map(|(n, labels)| Row {
            labels,
            factor: self.factors.get(n).copied().unwrap_or(1.0),
            text: self.texts.get(n).map_or("", |t| t),
        })
    }

    /// Tuples of each pair put together, and their texts.
    fn joined<'a>(width: usize, pairs: impl Iterator<Item = (Row<'a>, Row<'a>)>) -> Self {
        let mut out = Self {
            width,
            ..Self::default()
        };
        for (a, b) in pairs {
            out.said(a.factor * b.factor, &together(a.text, b.text));
            out.labels.extend_from_slice(a.labels);
            out.labels.extend_from_slice(b.labels);
        }
        out
    }

    /// Keeps what is said of the tuple that comes next.
    fn said(&mut self, factor: f64, text: &str) {
        let before = self.len();
        if factor != 1.0 || !self.factors.is_empty() {
            self.factors.resize(before, 1.0);
            self.factors.push(factor);
        }
        if !text.is_empty() || !self.texts.is_empty() {
            self.texts.resize(before, "".into());
            self.texts.push(text.into());
        }
    }

    /// Appends the tuples of another.
    fn append(&mut self, other: &Self) {
        for row in other.rows() {
            self.said(row.factor, row.text);
            self.labels.extend_from_slice(row.labels);
        }
    }

    /// Every tuple with every one of the other.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let pairs = self.rows().flat_map(|a| other.rows().map(move |b| (a, b)));
        Self::joined(self.width + other.width, pairs)
    }

    /// The first with the first, the second with the second, until one side ends.
    pub(crate) fn beside(&self, other: &Self) -> Self {
        Self::joined(self.width + other.width, self.rows().zip(other.rows()))
    }

    /// Multiplies the values.
    fn scale(&mut self, factor: f64) {
        self.factors.resize(self.len(), 1.0);
        self.factors.iter_mut().for_each(|f| *f *= factor);
    }
}

/// Why two labels span no range.
#[derive(Debug, PartialEq)]
pub(crate) enum NoRange {
    /// They do not differ in one number.
    Unlike,
    /// So many labels.
    TooLong(u64),
}

/// Appends a label, by its number from 0, to a text.
type Speller<'a> = Box<dyn Fn(usize, &mut String) + 'a>;

/// The labels of a range: there may be millions.
pub(crate) struct Labels<'a> {
    /// How many.
    count: usize,
    spell: Speller<'a>,
}

impl Labels<'_> {
    /// One after the other.
    pub(super) fn iter(&self) -> impl Iterator<Item = String> {
        (0..self.count).map(|n| {
            let mut label = String::new();
            (self.spell)(n, &mut label);
            label
        })
    }
}

/// Appends a number with zeros before it up to so many digits.
fn push_number(text: &mut String, mut number: u64, width: usize) {
    let mut digits = [b'0'; 20];
    let mut at = digits.len();
    while number > 0 || at == digits.len() {
        at -= 1;
        digits[at] += (number % 10) as u8;
        number /= 10;
    }
    let zeros = width.saturating_sub(digits.len() - at);
    text.extend(std::iter::repeat_n('0', zeros));
    text.push_str(std::str::from_utf8(&digits[at..]).unwrap_or_default());
}

/// `i1*i10`: labels that differ in one number, up or down, so many at most; leading zeros are kept.
pub(crate) fn range<'a>(from: &'a str, to: &str, most: usize) -> Result<Labels<'a>, NoRange> {
    let (a, b) = (from.as_bytes(), to.as_bytes());
    if from.eq_ignore_ascii_case(to) {
        return Ok(Labels {
            count: 1,
            spell: Box::new(|_, text| text.push_str(from)),
        });
    }
    let alike = |(x, y): &(&u8, &u8)| x.eq_ignore_ascii_case(y);
    let mut prefix = a.iter().zip(b).take_while(alike).count();
    while prefix > 0 && a[prefix - 1].is_ascii_digit() {
        prefix -= 1;
    }
    let digits = |s: &[u8]| {
        let digits = s[prefix..].iter();
        digits.take_while(|c| c.is_ascii_digit()).count()
    };
    if a.iter().chain(b).all(u8::is_ascii_alphabetic) {
        return letters(from, to).ok_or(NoRange::Unlike);
    }
    let (da, db) = (digits(a), digits(b));
    if da == 0 || db == 0 || !a[prefix + da..].eq_ignore_ascii_case(&b[prefix + db..]) {
        return Err(NoRange::Unlike);
    }
    let (na, nb) = (&from[prefix..prefix + da], &to[prefix..prefix + db]);
    let (Ok(lo), Ok(hi)) = (na.parse::<u64>(), nb.parse::<u64>()) else {
        return Err(NoRange::Unlike);
    };
    // `x01*x9`, `x1*x010`: how many digits have the labels between?
    if nb.starts_with('0') && da != db || na.starts_with('0') && da > db {
        return Err(NoRange::Unlike);
    }
    if lo.abs_diff(hi) >= most as u64 {
        return Err(NoRange::TooLong(lo.abs_diff(hi).saturating_add(1)));
    }
    // A leading zero, or equal lengths, fixes the width.
    let fixed = na.starts_with('0') || da == db;
    let width = if fixed { da } else { 0 };
    let (head, tail) = (&from[..prefix], &from[prefix + da..]);
    let number = move |n: usize| match lo <= hi {
        true => lo + n as u64,
        false => lo - n as u64,
    };
    Ok(Labels {
        count: lo.abs_diff(hi) as usize + 1,
        spell: Box::new(move |n, text| {
            text.push_str(head);
            push_number(text, number(n), width);
            text.push_str(tail);
        }),
    })
}

/// `a*e`, `x*ab`: labels of letters count like the columns of a spreadsheet.
fn letters<'a>(from: &str, to: &str) -> Option<Labels<'a>> {
    let value = |s: &str| {
        s.bytes().try_fold(0u64, |v, c| {
            v.checked_mul(26)?
                .checked_add(u64::from(c.to_ascii_lowercase() - b'a') + 1)
        })
    };
    let (lo, hi) = (value(from)?, value(to)?);
    if lo > hi || hi - lo > 1_000_000 {
        return None;
    }
    let first = match from.as_bytes().first()? {
        c if c.is_ascii_uppercase() => b'A',
        _ => b'a',
    };
    Some(Labels {
        count: (hi - lo) as usize + 1,
        spell: Box::new(move |n, text| {
            let from = text.len();
            let mut k = lo + n as u64;
            while k > 0 {
                text.insert(from, char::from(first + ((k - 1) % 26) as u8));
                k = (k - 1) / 26;
            }
        }),
    })
}

impl Compiler {
    /// Whether data of a symbol define the set of a position: `p(i<)`.
    pub(super) fn defines(&self, s: SymbolId, position: usize) -> bool {
        let defines = self.defining.get(&s);
        defines.is_some_and(|d| d.get(position) == Some(&true))
    }

    /// All keys a record of data stands for.
    pub(super) fn expand(
        &mut self,
        s: SymbolId,
        parts: &[KeyPart],
        span: Span,
        out: &mut Tuples,
    ) -> Checked<()> {
        out.width = self.symbols.get(s).dim();
        out.labels.clear();
        out.factors.clear();
        out.texts.clear();
        let dim = out.width;
        // `set.i` stands for all elements of i.
        let spelled_out = set_prefix(parts);
        let parts = spelled_out.as_deref().unwrap_or(parts);
        // One label per position is what data mostly are.
        let store = &self.store;
        let is_label =
            |p: &KeyPart| matches!(p, KeyPart::Label { text, .. } if !store.is_phantom(text));
        if parts.iter().all(is_label) {
            if parts.len() != dim {
                return self.wrong_record(s, span, parts.len());
            }
            self.take(1, record_bytes(dim), span)?;
            for (p, part) in parts.iter().enumerate() {
                let KeyPart::Label { text, span, .. } = part else {
                    unreachable!("tested above")
                };
                let label = self.data_label(s, p, text, *span)?;
                out.labels.push(label);
            }
            return Ok(());
        }
        let rows = self.products(s, 0, parts, span)?;
        self.take(rows.len(), record_bytes(dim), span)?;
        if rows.len() > 0 && rows.width != dim {
            return self.wrong_record(s, span, rows.width);
        }
        *out = Tuples { width: dim, ..rows };
        Ok(())
    }

    fn wrong_record(&mut self, s: SymbolId, span: Span, given: usize) -> Checked<()> {
        let at = self.diagnostics.len();
        let failed = self.wrong_dimension(s, span, given);
        let example = self.example(s).join(".");
        let d = self.diagnostics.get_mut(at);
        if let Some(d) = d.filter(|_| example.contains('.')) {
            let help = format!("dots stand between the labels of a record: `/ {example} /`");
            d.help = Some(help);
        }
        failed
    }

    /// All combinations of the parts of a key that begins at a position.
    pub(super) fn products(
        &mut self,
        s: SymbolId,
        position: usize,
        parts: &[KeyPart],
        span: Span,
    ) -> Checked<Tuples> {
        let spelled_out = set_prefix(parts);
        let parts = spelled_out.as_deref().unwrap_or(parts);
        let mut rows: Option<Tuples> = None;
        for part in parts {
            if let (KeyPart::Factor(x), Some(rows)) = (part, &mut rows) {
                rows.scale(*x);
                continue;
            }
            let at = position + rows.as_ref().map_or(0, |r| r.width);
            let choices = self.choices(s, at, part, span)?;
            let before = rows.as_ref().map_or(1, Tuples::len);
            if before.saturating_mul(choices.len()) > MAX_EXPANSION {
                return Diagnostic::error("E0343", span)
                    .says(format!("this stands for more than {MAX_EXPANSION} records"))
                    .label("too many")
                    .help("make the set by an assignment with a condition")
                    .fail(self);
            }
            let labels = choices.width + rows.as_ref().map_or(0, |r| r.width);
            self.take(before * choices.len(), 4 * labels, span)?;
            rows = Some(match rows {
                Some(before) => before.times(&choices),
                None => choices,
            });
        }
        Ok(rows.unwrap_or_default())
    }

    /// The tuples one part of a key stands for.
    fn choices(
        &mut self,
        s: SymbolId,
        position: usize,
        part: &KeyPart,
        whole: Span,
    ) -> Checked<Tuples> {
        match part {
            KeyPart::Label { text, .. } if self.store.is_phantom(text) => {
                Ok(Tuples::single(Vec::new()))
            }
            KeyPart::Label { text, span, .. } => {
                let label = self.data_label(s, position, text, *span)?;
                Ok(Tuples::single(vec![label]))
            }
            KeyPart::Range { from, to, span } => {
                let room = match self.max_memory {
                    Some(limit) => limit.saturating_sub(self.taken) / LABEL_BYTES,
                    None => MAX_EXPANSION,
                };
                let labels = match range(from, to, room.min(MAX_EXPANSION)) {
                    Ok(labels) => labels,
                    Err(NoRange::TooLong(n)) => {
                        if n <= MAX_EXPANSION as u64 {
                            self.take(n as usize, LABEL_BYTES, *span)?;
                        }
                        let d = Diagnostic::error("E0343", *span)
                            .says(format!("this range has {n} labels"))
                            .label("too many")
                            .help(format!("{MAX_EXPANSION} are the most"));
                        return d.fail(self);
                    }
                    Err(NoRange::Unlike) => {
                        let known = self.symbols.find(to).map(|s| self.symbols.get(s));
                        let help = match known.is_some_and(|s| !s.is_set()) {
                            true => format!("labels are fixed when the text is read: `$set {to} 10` above, and `{from}*%{to}%` here"),
                            false => "for instance `i1*i10` or `1990*2000`; other labels are listed, with commas between them; a comment has its `*` in the first column".into(),
                        };
                        return Diagnostic::error("E0344", *span)
                            .says(format!("`{from}*{to}` is not a range"))
                            .label("the labels must differ in one number")
                            .help(help)
                            .fail(self);
                    }
                };
                self.take(labels.count, LABEL_BYTES, *span)?;
                self.range_of_words(from, to, s, position, *span)?;
                self.store.universe.reserve(labels.count);
                let mut found = Vec::with_capacity(labels.count);
                let (mut text, mut ends) = (String::new(), Vec::new());
                while found.len() < labels.count {
                    let next = found.len()..labels.count.min(found.len() + AT_ONCE);
                    text.clear();
                    ends.clear();
                    ends.push(0);
                    for n in next {
                        (labels.spell)(n, &mut text);
                        ends.push(text.len());
                    }
                    let spelled = || ends.windows(2).map(|e| &text[e[0]..e[1]]);
                    self.store.universe.warm(spelled());
                    for label in spelled() {
                        found.push(self.data_label(s, position, label, *span)?);
                    }
                }
                Ok(Tuples::single(found))
            }
            KeyPart::AllOf { set, .. } if *set == NO_ELEMENTS => Ok(Tuples::single(Vec::new())),
            KeyPart::AllOf { set, span } => {
                let id = self.lookup_set(&Ident {
                    name: (*set).into(),
                    span: *span,
                })?;
                let t = self.symbols.get(id).table;
                if id == UNIVERSE {
                    self.store.refresh_universe();
                }
                let mut all = Tuples::of(self.store.table(t));
                let texts = self.store.texts.get(&t);
                // The elements of a set bring their texts into another.
                if let Some(texts) = texts.filter(|_| self.symbols.get(s).is_set()) {
                    let keys = all.labels.chunks_exact(all.width.max(1));
                    all.texts = keys
                        .map(|k| texts.get(k).map_or_else(|| "".into(), |t| (&**t).into()))
                        .collect();
                }
                Ok(all)
            }
            KeyPart::Universe(_) => {
                self.store.refresh_universe();
                let t = match self.symbols.get(s).domain.get(position) {
                    Some(DomainPosition::Set(d)) => self.symbols.get(*d).table,
                    _ => UNIVERSE,
                };
                Ok(Tuples::of(self.store.table(t)))
            }
            KeyPart::Group(alternatives) => {
                let mut out = Tuples::default();
                for alternative in alternatives {
                    let more = self.products(s, position, alternative, whole)?;
                    if out.len() > 0 && more.len() > 0 && out.width != more.width {
                        return self.wrong_dimension(s, whole, position + more.width);
                    }
                    if more.len() > 0 {
                        out.width = more.width;
                    }
                    out.append(&more);
                }
                Ok(out)
            }
            KeyPart::Factor(_) => Ok(Tuples::default()),
            KeyPart::Matched(first, other) => {
                let rows = self.products(s, position, first, whole)?;
                let behind = self.products(s, position + rows.width, other, whole)?;
                if rows.len() != behind.len() {
                    Diagnostic::warning("E0347", whole)
                        .says(format!("`:` matches one by one, but there are {} on the left and {} on the right", rows.len(), behind.len()))
                        .label("what is left over on one side is dropped")
                        .help("a dot instead of the colon makes all combinations")
                        .report(self);
                }
                Ok(rows.beside(&behind))
            }
        }
    }

    /// `jan*mar` counts letters, `jan`, `jao` …, as in GAMS; hardly anybody means it.
    fn range_of_words(
        &mut self,
        from: &str,
        to: &str,
        s: SymbolId,
        position: usize,
        span: Span,
    ) -> Checked<()> {
        let is_word = |l: &str| l.len() > 2 && l.bytes().all(|b| b.is_ascii_alphabetic());
        let head = |l: &str| l[..l.len() - 1].to_ascii_lowercase();
        if !is_word(from) || !is_word(to) || head(from) == head(to) {
            return Ok(());
        }
        let Some(labels) = letters(from, to) else {
            return Ok(());
        };
        let (count, second) = (labels.count, labels.iter().nth(1).unwrap_or_default());
        let mut d = Diagnostic::warning("E0344", span)
            .says(format!(
                "`{from}*{to}` counts letters: it stands for {count} labels"
            ))
            .label(format!("`{from}`, `{second}`, …"))
            .help("list the labels, with commas between them");
        if let Some(DomainPosition::Set(set)) = self.symbols.get(s).domain.get(position)
            && !self.defines(s, position)
            && !self.modes.at(span).warnings
        {
            let table = self.symbols.rooted(*set).table;
            let known = self.store.universe.get(&second);
            if known.is_none_or(|l| self.store.table(table).find(&[l]).is_none()) {
                d.severity = Severity::Error;
                return d.fail(self);
            }
        }
        d.report(self);
        Ok(())
    }

    /// A label in data at a position of a symbol; checked against the domain.
    fn data_label(
        &mut self,
        s: SymbolId,
        position: usize,
        text: &str,
        span: Span,
    ) -> Checked<Label> {
        let symbol = self.symbols.get(s);
        let Some(DomainPosition::Set(d)) = symbol.domain.get(position) else {
            return Ok(self.store.universe.intern(text));
        };
        let set_id = self.symbols.root(*d);
        let set = self.symbols.get(set_id);
        let table = set.table;
        if let Some(l) = self.store.universe.get(text)
            && self.store.table(table).find(&[l]).is_some()
        {
            return Ok(l);
        }
        if self.defines(s, position) {
            let l = self.store.universe.intern(text);
            self.store.table_mut(table).set(&[l], 1.0);
            return Ok(l);
        }
        self.not_a_member(text, "", s, position, span)
    }
}

/// Replaces `set` and the name behind it by all elements of that set, and `system.empty` by those of none.
pub(super) fn set_prefix<'a>(parts: &[KeyPart<'a>]) -> Option<Vec<KeyPart<'a>>> {
    let is = |p: &KeyPart, word: &str| matches!(p, KeyPart::Label { text, quoted: false, .. } if text.eq_ignore_ascii_case(word));
    let is_set = |p: &KeyPart| is(p, "set");
    if let [system, empty] = parts
        && is(system, "system")
        && is(empty, "empty")
    {
        let (set, span) = (NO_ELEMENTS, Span::default());
        return Some(vec![KeyPart::AllOf { set, span }]);
    }
    if !parts.iter().any(is_set) {
        return None;
    }
    let mut out = Vec::with_capacity(parts.len());
    let mut rest = parts.iter();
    while let Some(p) = rest.next() {
        match (is_set(p), rest.clone().next()) {
            (
                true,
                Some(&KeyPart::Label {
                    text: set, span, ..
                }),
            ) => {
                out.push(KeyPart::AllOf { set, span });
                rest.next();
            }
            _ => out.push(p.clone()),
        }
    }
    Some(out)
}
