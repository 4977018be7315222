//! Data statements: elements of sets, numbers of parameters, attributes of variables.

use super::expansion::{Tuples, record_bytes, set_prefix, together};
use super::functions::{self, RecordAttribute};
use super::node::{SymbolId, TableId};
use super::symbols::{DomainPosition, Store, Symbol, SymbolKind, Symbols, attribute};
use super::{Checked, Compiler};
use crate::data::key_index::KeyIndex;
use crate::data::universe::Label;
use crate::data::value::{self, EPS};
use crate::diag::Diagnostic;
use crate::source::{Known, SourceMap, Span};
use crate::syntax::ast::Ident;
use crate::syntax::data::{
    DataKind, DataReader, KeyPart, Record, Tail, likely_labels, undf_refused, width,
};

/// Keys that came already: none may come twice. Keys in label order cost no index.
#[derive(Default)]
pub(super) struct Seen {
    dim: usize,
    keys: Vec<Label>,
    index: Option<KeyIndex>,
}

impl Seen {
    /// Whether a key came before; from now on it did.
    pub(super) fn again(&mut self, key: &[Label]) -> bool {
        if self.keys.is_empty() {
            self.dim = key.len();
        }
        // Keys of another length are refused elsewhere, and second values of a scalar.
        if self.dim != key.len() || key.is_empty() {
            return false;
        }
        let count = self.len();
        let last = &self.keys[self.keys.len().saturating_sub(self.dim)..];
        if self.index.is_some() || last >= key {
            let index = || KeyIndex::build(&self.keys, self.dim, |_| true);
            let index = self.index.get_or_insert_with(index);
            let before = index.find_or_insert(key, count as u32, &self.keys);
            if before.is_some() {
                return true;
            }
        }
        self.keys.extend_from_slice(key);
        false
    }

    /// How many.
    fn len(&self) -> usize {
        self.keys.len() / self.dim.max(1)
    }
}

/// The set that a data statement fills, and the order of what it has.
struct Elements {
    filling: Filling,
    symbol: Symbol,
    last: Option<Label>,
    /// Labels came in another order than that of the universe.
    unordered: bool,
}

/// A symbol that a data statement fills.
pub(super) struct Filling {
    symbol: SymbolId,
    table: TableId,
    /// Records of this statement, where the symbol had some before it: none may come twice.
    own: Option<Seen>,
    /// A value was given.
    begun: bool,
}

impl Filling {
    /// Whether the statement gave this record already; from now on it did.
    pub(super) fn repeats(&mut self, store: &mut Store, key: &[Label]) -> bool {
        match &mut self.own {
            None => {
                let t = &store.tables[self.table as usize];
                !t.is_after_last(key) && t.find(key).is_some()
            }
            Some(own) => own.again(key),
        }
    }
}

/// How many lines a text has if they are as long as the first ones, whose labels are mostly the shortest: what room to take.
pub(super) fn lines_about(text: &str) -> usize {
    let first = &text.as_bytes()[..text.len().min(1 << 16)];
    let lines = memchr::memchr_iter(b'\n', first).count();
    let all = lines.saturating_mul(text.len().div_ceil(first.len().max(1)));
    all.min(text.len() / 4)
}

/// `i1-i5`, `1 to 5`, `t1 - t5`: what it is meant to run from and to.
pub(super) fn meant_range<'a>(label: &'a str, text: &'a str) -> Option<(&'a str, &'a str)> {
    let (from, to) = match text.strip_prefix("to ").or_else(|| text.strip_prefix("- ")) {
        Some(to) => (label, to.trim()),
        None if text.is_empty() => label.split_once('-')?,
        None => return None,
    };
    let parts = |l: &str| {
        let prefix = l.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        Some((l[..prefix].to_lowercase(), l[prefix..].parse::<u32>().ok()?))
    };
    let ((p, lo), (q, hi)) = (parts(from)?, parts(to)?);
    (p == q && lo < hi).then_some((from, to))
}

/// What is hardly meant as one element, `a b c` without commas, where all words are alike, or `i1-i5`: the fix, and
/// how many words stand in its text.
fn looks_like_list(
    key: &[KeyPart<'_>],
    value: &Tail<'_>,
    map: &SourceMap,
) -> Option<(String, usize)> {
    let [KeyPart::Label { text: label, .. }] = key else {
        return None;
    };
    // `i1` is like `i2`, `a` like `b`.
    let kind = |w: &str| {
        let prefix = w.trim_end_matches(|c: char| c.is_ascii_digit());
        match w.len() {
            1 => Some(Ok(prefix.is_empty())),
            n => (prefix.len() < n).then(|| Err(prefix.to_lowercase())),
        }
    };
    let (text, at) = match value {
        Tail::Text(text, at) => (&**text, Some(*at)),
        _ => ("", None),
    };
    if let Some((from, to)) = meant_range(label, text) {
        return Some((format!("a range is written with `*`: `/ {from}*{to} /`"), 0));
    }
    if map.text(at?) != text {
        return None;
    }
    let like = kind(label)?;
    let words: Vec<&str> = text.split_whitespace().collect();
    let list = words.join(", ");
    let help = format!(
        "a blank begins the text of an element, a comma the next element: `/ {label}, {list} /`"
    );
    let alike = words.iter().all(|w| kind(w).as_ref() == Some(&like));
    alike.then_some((help, words.len()))
}

/// An error for data of a symbol that has some, or is assigned: data come before all assignments are carried out.
pub(super) fn second_data(name: &str, span: Span, declared: Span) -> Diagnostic {
    Diagnostic::error("E0340", span)
        .says(format!("`{name}` has data already"))
        .label("second data statement")
        .other(declared, "first declared here")
        .help("assign instead (`p(i) = …;`), or allow merging with `$onMulti`")
}

impl Compiler {
    /// The sets that data define, `p(i<)`, get theirs with them.
    pub(super) fn open_domains(&mut self, s: SymbolId, span: Span) -> Checked<()> {
        for position in 0..self.symbols.get(s).dim() {
            if let DomainPosition::Set(d) = self.symbols.get(s).domain[position]
                && self.defines(s, position)
            {
                self.open_data(self.symbols.root(d), span)?;
            }
        }
        Ok(())
    }

    /// An error if a symbol may get no data now; clears it for `$onMultiR`.
    pub(super) fn open_data(&mut self, s: SymbolId, span: Span) -> Checked<Filling> {
        self.symbols.get_mut(s).open = false;
        let symbol = self.symbols.get(s);
        let modes = self.modes.at(span);
        let (had, table) = (symbol.has_data || symbol.assigned, symbol.table);
        if had && !modes.multi {
            return second_data(&symbol.name, span, symbol.declared).fail(self);
        }
        if had && modes.multi_replace {
            self.store.table_mut(table).clear();
            self.store.texts.remove(&table);
        }
        self.symbols.get_mut(s).has_data = true;
        let old = self.store.table(table);
        Ok(Filling {
            symbol: s,
            table,
            own: (!old.is_empty()).then(Seen::default),
            begun: false,
        })
    }

    /// `$clear`, `$kill`: the data so far are forgotten while the text is read.
    pub(super) fn forget(&mut self, kill: bool, names: &[Ident]) -> Checked<()> {
        for name in names {
            let s = self.lookup(name)?;
            let root = self.symbols.root(s);
            self.store.clear(self.symbols.get(root), None);
            let symbol = self.symbols.get_mut(root);
            symbol.has_data &= !kill;
            symbol.assigned &= !kill;
        }
        Ok(())
    }

    /// A symbol declared without a domain has as many indices as its first record. A dot behind a
    /// blank begins a number there.
    fn shape_by_data(&mut self, s: SymbolId, text: &str, kind: DataKind) {
        let mut reader = DataReader::new(text, 0, kind, true)
            .with_arity(1)
            .with_constants(self);
        if let Some(Ok(r)) = reader.next()
            && (kind == DataKind::Set || !matches!(r.value, Tail::None))
        {
            let spelled_out = set_prefix(r.key);
            let key = spelled_out.as_deref().unwrap_or(r.key);
            let dim = width(key);
            self.set_dimension(s, dim);
        }
    }

    /// Takes the number of indices that data show.
    pub(super) fn set_dimension(&mut self, s: SymbolId, dim: usize) {
        if dim > 0 && dim <= 20 && dim != self.symbols.get(s).dim() {
            self.reshape(s, dim);
        }
    }

    /// Makes a symbol and the sets of its domain ready for data; a reader of these.
    fn open_reader<'m>(
        &mut self,
        s: SymbolId,
        body: Span,
        name: Span,
        kind: DataKind,
        map: &'m SourceMap,
    ) -> Checked<(Filling, DataReader<'m>)> {
        self.store.phantom.clone_from(&map.phantom);
        let open = self.symbols.get(s).open;
        let filling = self.open_data(s, name)?;
        self.open_domains(s, name)?;
        let text = map.text(body);
        if open {
            self.shape_by_data(s, text, kind);
        }
        let dim = self.symbols.get(s).dim();
        let undf = self.modes.at(body).undf;
        let reader = DataReader::new(text, body.lo, kind, undf).with_arity(dim);
        // Mostly a record stands on a line.
        let lines = lines_about(text);
        let table = self.symbols.get(s).table;
        self.store.table_mut(table).reserve(lines);
        let reader = match kind {
            DataKind::Set => {
                if dim == 1 {
                    self.store.universe.reserve(lines);
                }
                reader
            }
            DataKind::Values => reader.with_constants(self),
        };
        Ok((filling, reader))
    }

    pub(super) fn set_data(
        &mut self,
        s: SymbolId,
        body: Span,
        name: Span,
        map: &SourceMap,
    ) -> Checked<()> {
        let (filling, mut reader) = self.open_reader(s, body, name, DataKind::Set, map)?;
        let symbol = self.symbols.get(s).clone();
        let mut elements = Elements {
            last: self.last_label(symbol.table, symbol.dim()),
            unordered: symbol.unordered,
            filling,
            symbol,
        };
        let mut keys = Tuples::default();
        let mut familiar = Familiar::new(&self.symbols, s);
        let (mut lists, mut plain) = (Vec::new(), false);
        loop {
            loop {
                // Elements are mostly new labels.
                if let ([_], Some(text)) = (&*familiar.key, reader.ahead()) {
                    self.store.universe.warm(likely_labels(text));
                }
                let record = reader.plain(|p, text| familiar.find(&mut self.store, p, text));
                let Some((_, span)) = record else { break };
                let bytes = record_bytes(familiar.key.len());
                if self.take(1, bytes, span).is_err() {
                    break;
                }
                plain = true;
                self.put_element(&mut elements, &familiar.key, None, span);
            }
            let Some(record) = reader.next() else { break };
            let Ok(record) = record.map_err(|d| d.report(self)) else {
                // Which elements it has is not known.
                self.lost.elements.insert(s);
                continue;
            };
            let spelled_out = set_prefix(record.key);
            let parts = spelled_out.as_deref().unwrap_or(record.key);
            // The elements of a set that is not ordered come in another order.
            let unordered = |set| self.symbols.rooted(set).unordered;
            let all_of_unordered = parts.iter().any(|part| match part {
                KeyPart::AllOf { set, .. } => self.symbols.find(set).is_some_and(unordered),
                _ => false,
            });
            let text = match &record.value {
                Tail::None => None,
                Tail::Text(t, _) => Some(&**t),
                Tail::Number(_, span) => Some(map.text(*span)),
                Tail::Name(n, _) => Some(*n),
            };
            let span = record.span;
            match looks_like_list(record.key, &record.value, map) {
                Some((help, words)) if !plain => lists.push((span, help, words)),
                _ => plain = true,
            }
            if self.expand(s, record.key, span, &mut keys).is_err() {
                continue;
            }
            elements.unordered |= all_of_unordered && elements.symbol.dim() == 1 && keys.len() > 0;
            if text.is_none() && self.append_elements(&mut elements, &keys) {
                continue;
            }
            for row in keys.rows() {
                let both = together(row.text, text.unwrap_or_default());
                let said = text.is_some() || !both.is_empty();
                self.put_element(&mut elements, row.labels, said.then_some(&*both), span);
            }
        }
        self.store.table_mut(elements.symbol.table).tidy();
        self.symbols.get_mut(s).unordered = elements.unordered;
        let listed = !plain && (lists.len() == 1 || lists.iter().all(|l| l.2 > 1));
        if let Some((span, help, _)) = lists.into_iter().next().filter(|_| listed) {
            let (name, written) = (&self.symbols.get(s).name, map.text(span).trim_end());
            let message = format!("`{written}` is one element of the set `{name}`");
            let d = Diagnostic::warning("E0234", span).says(message).help(help);
            self.doubtful.push((s, d));
        }
        Ok(())
    }

    /// Stores many elements of a data statement at once, if they are new and in order and have no texts.
    fn append_elements(&mut self, to: &mut Elements, keys: &Tuples) -> bool {
        let many = keys.len() > 1 && !keys.have_texts() && to.filling.own.is_none();
        let singleton = matches!(to.symbol.kind, SymbolKind::Set { singleton: true });
        let ones = std::iter::repeat_n(1.0, keys.len());
        let table = self.store.table_mut(to.symbol.table);
        let done = many && !singleton && table.append_all(&keys.labels, ones);
        if done {
            to.last = keys.labels.last().copied();
        }
        done
    }

    /// Stores an element of a data statement; an error if the statement gave it already.
    fn put_element(&mut self, to: &mut Elements, key: &[Label], text: Option<&str>, span: Span) {
        let table = to.symbol.table;
        if to.filling.repeats(&mut self.store, key) {
            let label = self.key_text(key);
            let message = format!("the element {label} of `{}` appears twice", to.symbol.name);
            Diagnostic::error("E0341", span)
                .says(message)
                .label("second time")
                .help("take one of them out")
                .report(self);
            return;
        }
        if matches!(to.symbol.kind, SymbolKind::Set { singleton: true })
            && !self.store.table(table).is_empty()
        {
            let own = to.filling.own.as_ref();
            if own.is_none_or(|own| own.len() != 1) {
                if self.modes.at(span).loose_singleton {
                    return;
                }
                let message = format!("`{}` is a singleton: it has one element", to.symbol.name);
                Diagnostic::error("E0342", span)
                    .says(message)
                    .label("second element")
                    .report(self);
                return;
            }
            // `$onMulti`: the later element counts.
            self.store.clear(&to.symbol, None);
        }
        let own = &to.filling.own;
        if let [label] = *key
            && (own.is_none() || self.store.table(table).find(key).is_none())
        {
            to.unordered |= to.last.is_some_and(|l| l > label);
            to.last = Some(label);
        }
        self.store.tables[table as usize].set(key, 1.0);
        if let Some(t) = text {
            let texts = self.store.texts.entry(table).or_default();
            texts.insert(key.into(), t.into());
        }
    }

    fn last_label(&self, table: TableId, dim: usize) -> Option<Label> {
        let t = self.store.table(table);
        (dim == 1 && !t.is_empty()).then(|| t.key(t.len() as u32 - 1)[0])
    }

    /// `'a'.'x'`, for messages.
    pub(super) fn key_text(&self, key: &[Label]) -> String {
        let quoted = |&l: &Label| format!("'{}'", self.store.universe.name(l));
        key.iter().map(quoted).collect::<Vec<_>>().join(".")
    }

    pub(super) fn parameter_data(
        &mut self,
        s: SymbolId,
        body: Span,
        name: Span,
        map: &SourceMap,
    ) -> Checked<()> {
        let (mut filling, mut reader) = self.open_reader(s, body, name, DataKind::Values, map)?;
        let symbol = self.symbols.get(s).clone();
        let dim = symbol.dim();
        let mut keys = Tuples::default();
        let mut familiar = Familiar::new(&self.symbols, s);
        loop {
            if dim > 0 {
                while let Some((v, span)) =
                    reader.plain(|p, text| familiar.find(&mut self.store, p, text))
                {
                    if self.take(1, record_bytes(dim), span).is_err() {
                        break;
                    }
                    self.put_value(&mut filling, &familiar.key, v, span);
                }
            }
            let Some(record) = reader.next() else { break };
            let Ok(record) = record.map_err(|d| d.report(self)) else {
                continue;
            };
            let Ok(v) = self.number_of(&record, s, map) else {
                continue;
            };
            // `/ 5 /` of a scalar comes as a lone label.
            if let (0, Tail::None, [KeyPart::Label { span, .. }]) = (dim, &record.value, record.key)
            {
                self.put_value(&mut filling, &[], v, *span);
                continue;
            }
            let (span, key) = (record.span, record.key);
            if dim == 0 && !key.is_empty() {
                Diagnostic::error("E0345", span)
                    .says(format!("the scalar `{}` gets one number", symbol.name))
                    .help("write `/ 5 /`; no blank parts thousands")
                    .report(self);
                continue;
            }
            if self.expand(s, key, span, &mut keys).is_err() {
                if self.errors() >= super::MAX_ERRORS {
                    break;
                }
                continue;
            }
            if dim == 0 {
                self.put_value(&mut filling, &[], v, span);
                continue;
            }
            for row in keys.rows() {
                self.put_value(&mut filling, row.labels, scaled(v, row.factor), span);
            }
        }
        self.store.table_mut(filling.table).tidy();
        Ok(())
    }

    /// The number of a record of a parameter; that of a scalar may stand where a label would.
    fn number_of(&mut self, record: &Record<'_, '_>, s: SymbolId, map: &SourceMap) -> Checked<f64> {
        let dim = self.symbols.get(s).dim();
        let at = match (&record.value, record.key) {
            (Tail::Number(v, _), _) => return Ok(*v),
            (Tail::Name(n, at), key) if dim <= width(key) || self.symbols.find(n).is_some() => {
                return self.acronym(n, *at);
            }
            (Tail::None, [KeyPart::Label { text, span, .. }]) if dim == 0 => {
                return match number(text) {
                    Some(v) if value::is_undf(v) && !self.modes.at(*span).undf => {
                        undf_refused(*span).fail(self)
                    }
                    Some(v) => Ok(v),
                    None => self.acronym(text, *span),
                };
            }
            (Tail::Text(..), _) => "a text stands where a number is expected",
            (Tail::Name(..), _) => "dots stand between the labels of a record",
            _ => "no number follows the label",
        };
        let help = match (decimal_comma(map, record.span), dim) {
            (true, _) => "decimals stand behind a point: `1.5`".to_owned(),
            (false, 0) => "write `/ 5 /`".to_owned(),
            (false, _) => {
                let labels = match dim {
                    1 => "each label and ",
                    _ => "the labels of a record with dots between them, then ",
                };
                let example = self.example(s).join(".");
                format!(
                    "write {labels}its number, with no comma between them: `/ {example} 1, … /`"
                )
            }
        };
        let name = &self.symbols.get(s).name;
        Diagnostic::error("E0345", record.span)
            .says(format!(
                "the data of `{name}` need a number for each record"
            ))
            .label(at)
            .help(help)
            .fail(self)
    }

    /// The first label of each position, for messages.
    pub(super) fn example(&self, s: SymbolId) -> Vec<&str> {
        let first = |d: &DomainPosition| match d {
            DomainPosition::Set(d) => {
                let set = self.symbols.rooted(*d);
                let table = self.store.table(set.table);
                match table.is_empty() {
                    true => "a",
                    false => self.store.universe.name(table.key(0)[0]),
                }
            }
            _ => "a",
        };
        self.symbols.get(s).domain.iter().map(first).collect()
    }

    pub(super) fn acronym(&mut self, name: &str, span: Span) -> Checked<f64> {
        if let Some(s) = self.symbols.find(name)
            && let SymbolKind::Acronym(n) = self.symbols.get(s).kind
        {
            return Ok(value::acronym(n));
        }
        let help = match name.starts_with(['\u{2212}', '\u{2013}', '\u{2014}']) {
            true => "write the plain minus sign `-`",
            false => {
                "numbers are `1.5`, `-2e3`, `inf`, `eps`, `na`; a label with a blank stands in quotes, `'new york' 3`; other words are declared as acronyms"
            }
        };
        Diagnostic::error("E0345", span)
            .says(format!("`{name}` is not a number"))
            .label("a number is expected")
            .help(help)
            .fail(self)
    }

    /// What a number in data is stored as.
    pub(super) fn stored(&self, v: f64, span: Span) -> f64 {
        if v == 0.0 && self.modes.at(span).eps {
            EPS
        } else {
            v
        }
    }

    /// Stores a value of a data statement; an error if the statement gave the record already. As in
    /// GAMS a zero gives none.
    pub(super) fn put_value(&mut self, filling: &mut Filling, key: &[Label], v: f64, span: Span) {
        // `$onEps` leaves scalars alone.
        let v = match key {
            [] => v,
            _ => self.stored(v, span),
        };
        let again = key.is_empty() && filling.begun;
        filling.begun = true;
        if again || v != 0.0 && filling.repeats(&mut self.store, key) {
            let label = self.key_text(key);
            let name = &self.symbols.get(filling.symbol).name;
            let (what, help) = match key {
                [] => (
                    format!("`{name}` gets two values"),
                    "a scalar has one value; decimals stand behind a point, `1.5`, and no sign parts thousands",
                ),
                _ => (
                    format!("the record {label} of `{name}` appears twice"),
                    "take one of them out",
                ),
            };
            Diagnostic::error("E0341", span)
                .says(what)
                .label("second time")
                .help(help)
                .report(self);
            return;
        }
        self.store.tables[filling.table as usize].set(key, v);
    }

    /// `variable x(i) / a.lo 5 /`.
    pub(super) fn record_data(&mut self, s: SymbolId, body: Span, map: &SourceMap) -> Checked<()> {
        let (text, undf) = (map.text(body), self.modes.at(body).undf);
        let reader = DataReader::new(text, body.lo, DataKind::Values, undf);
        let mut reader = reader.with_constants(self);
        while let Some(record) = reader.next() {
            let Ok(record) = record.map_err(|d| d.report(self)) else {
                break;
            };
            let Tail::Number(v, _) = record.value else {
                Diagnostic::error("E0345", record.span)
                    .says("a number is expected behind the attribute")
                    .label("no number")
                    .report(self);
                continue;
            };
            let _ = self.attribute_data(s, record.key, v, record.span);
        }
        self.attributes_given(s);
        Ok(())
    }

    /// Data gave attributes of a variable or equation.
    pub(super) fn attributes_given(&mut self, s: SymbolId) {
        let symbol = self.symbols.get_mut(s);
        symbol.assigned = true;
        let table = symbol.table;
        for o in 0..attribute::COUNT {
            self.store.table_mut(table + o).tidy();
        }
    }

    /// One record, `a.lo 5`. The attribute stands last, perhaps in a group: `a.(lo 1, up 5)`.
    pub(super) fn attribute_data(
        &mut self,
        s: SymbolId,
        key: &[KeyPart],
        v: f64,
        span: Span,
    ) -> Checked<()> {
        let (text, at, key) = match key.split_last() {
            Some((KeyPart::Group(alternatives), before)) => {
                for alternative in alternatives {
                    let (last, factor) = match alternative.split_last() {
                        Some((KeyPart::Factor(x), key)) => (key, *x),
                        _ => (alternative.as_slice(), 1.0),
                    };
                    let key = [before, last].concat();
                    self.attribute_data(s, &key, scaled(v, factor), span)?;
                }
                return Ok(());
            }
            Some((KeyPart::Label { text, span, .. }, key)) => (*text, *span, key),
            _ => return Ok(()),
        };
        let symbol = self.symbols.get(s).clone();
        let mut keys = Tuples::default();
        if symbol.dim() > 0 {
            self.expand(s, key, span, &mut keys)?;
        }
        let offsets = match functions::record_attribute(text) {
            Some(RecordAttribute::Fix) => vec![attribute::L, attribute::LO, attribute::UP],
            Some(RecordAttribute::Stored(o)) if o != attribute::STAGE => vec![o],
            _ => {
                let attr = Ident {
                    name: text.into(),
                    span: at,
                };
                let known = "l, m, lo, up, fx, scale, prior";
                return self.unknown_attribute(&attr, &symbol.name, symbol.kind_name(), known);
            }
        };
        for o in offsets {
            let t = self.store.table_mut(symbol.table + o);
            if symbol.dim() == 0 {
                t.set(&[], v);
            }
            for row in keys.rows() {
                t.set(row.labels, scaled(v, row.factor));
            }
        }
        Ok(())
    }
}

/// Labels of the record before, by position: in data the next label is mostly the same one or the next one.
pub(super) struct Familiar {
    /// What was found, by position.
    pub(super) key: Vec<Label>,
    /// The set of each position; None: any label.
    sets: Vec<Option<TableId>>,
}

impl Familiar {
    pub(super) fn new(symbols: &Symbols, s: SymbolId) -> Self {
        let domain = &symbols.get(s).domain;
        let set = |p: &DomainPosition| match p {
            DomainPosition::Set(d) => Some(symbols.rooted(*d).table),
            _ => None,
        };
        Self {
            key: vec![Label::MAX; domain.len()],
            sets: domain.iter().map(set).collect(),
        }
    }

    /// Puts the label at its position; false if it is not allowed there.
    #[inline]
    pub(super) fn find(&mut self, store: &mut Store, position: usize, text: &str) -> bool {
        let before = self.key[position];
        let known = &store.universe;
        let spelled = |l: Label| (l as usize) < known.len() && known.name(l) == text;
        if spelled(before) {
            return true;
        }
        let next = before.wrapping_add(1);
        let label = match self.sets[position] {
            _ if spelled(next) => Some(next),
            None if store.is_phantom(text) => None,
            None => Some(store.universe.intern(text)),
            Some(_) => store.universe.get(text),
        };
        let member = |l: &Label| match self.sets[position] {
            Some(t) => store.table(t).find(&[*l]).is_some(),
            None => true,
        };
        let found = label.filter(member);
        self.key[position] = found.unwrap_or(Label::MAX);
        found.is_some()
    }
}

/// A value times the factor of a group, `a.(x 1, y 2)`; special values stay as they are.
fn scaled(v: f64, factor: f64) -> f64 {
    if factor == 1.0 {
        v
    } else if v == 1.0 {
        factor
    } else {
        v * factor
    }
}

/// Whether `5` of `1,5` is taken for a label.
fn decimal_comma(map: &SourceMap, label: Span) -> bool {
    let text = map.text(Span::new(label.lo.saturating_sub(2), label.hi));
    matches!(text.as_bytes(), [before, b',', first, ..] if before.is_ascii_digit() && first.is_ascii_digit())
}

/// A number as it may stand in data.
fn number(text: &str) -> Option<f64> {
    let t = text.to_lowercase();
    Some(match t.as_str() {
        "inf" | "+inf" => f64::INFINITY,
        "-inf" => f64::NEG_INFINITY,
        "eps" => EPS,
        "na" => value::NA,
        "undf" => value::UNDF,
        "yes" => 1.0,
        "no" => 0.0,
        _ => fast_float2::parse(t.strip_prefix('+').unwrap_or(&t)).ok()?,
    })
}
