//! `put` and its kin: items are evaluated here; how they stand in the file is [`TextFile`]'s matter.
//!
//! A file is written whole when it is closed or when the run ends.
//!
//! [`TextFile`]: crate::report::textfile::TextFile

use super::{Frame, Machine};
use crate::check::calendar;
use crate::check::figure::is_text;
use crate::check::node::{DataFunction, Node, NodeKind, PutCode, SymbolId, Written};
use crate::check::symbols::SymbolKind;
use crate::data::value::{is_eps, special_text, truth};
use crate::diag::Diagnostic;
use crate::report::textfile::{Format, Item, Overflow, Part, WIDEST};
use crate::source::Span;

const MONTHS: [&str; 12] = [
    "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
];

/// Rows that are told from one another: all lie below a page.
const MAX_ROWS: usize = 1_000_000;

impl Machine<'_> {
    /// A statement.
    pub(super) fn put(&mut self, keyword: &str, items: &[PutCode], frame: &mut Frame, span: Span) {
        let part = match keyword {
            "puttl" => Part::Title,
            "puthd" => Part::Header,
            _ => Part::Body,
        };
        // `putclose f` alone closes f, which is the current file then; it does not open it.
        if let ("putclose", [PutCode::File(s)]) = (keyword, items) {
            self.close_put_file(*s, span);
            self.put.current = Some(*s);
            return;
        }
        if keyword.starts_with("put_util") {
            self.put_utility(items, frame, span);
            return;
        }
        if let Some(f) = self.put.current.and_then(|s| self.put.files.get_mut(&s)) {
            f.hold_cursor();
        }
        self.put_items(part, items, frame, span);
        match keyword {
            "putclose" => {
                if let Some(s) = self.put.current {
                    self.close_put_file(s, span);
                } else {
                    self.put_file(span);
                }
            }
            "putpage" => {
                if let Some(f) = self.put_file(span) {
                    f.text.end_page();
                }
            }
            _ => {}
        }
        self.put.files.values_mut().for_each(|f| f.cursor = None);
    }

    fn put_items(&mut self, part: Part, items: &[PutCode], frame: &mut Frame, span: Span) {
        for item in items {
            match item {
                PutCode::File(s) => self.open_put_file(*s),
                PutCode::NewLine => {
                    let Some(f) = self.put_file(span) else { return };
                    f.text.new_line(part);
                }
                PutCode::Column(n) => {
                    let column = self.eval(n, frame);
                    let column = self.whole(column, "the column behind `@`", [1, WIDEST], n.span);
                    let Some(f) = self.put_file(span) else { return };
                    if let Some(n) = column {
                        f.text.column(part, n);
                    }
                }
                PutCode::Row(n) => {
                    let row = self.eval(n, frame);
                    let row = self.whole(row, "the row behind `#`", [1, MAX_ROWS], n.span);
                    let Some(f) = self.put_file(span) else { return };
                    if let Some(row) = row {
                        let r = f.text.row(part, row);
                        self.put_trouble(r, n.span);
                    }
                }
                PutCode::Item(w) => {
                    let Some((item, format)) = self.put_formatted(w, frame) else {
                        continue;
                    };
                    let Some(f) = self.put_file(span) else { return };
                    let r = f.text.item(part, &item, format);
                    self.put_trouble(r, w.value.span);
                }
            }
        }
    }

    /// `x:<10:2`; None for what is hidden by a condition.
    pub(super) fn put_formatted(
        &self,
        w: &Written<Node>,
        frame: &mut Frame,
    ) -> Option<(Item, Format)> {
        let mut given = |n: &Option<Node>, what: &str| {
            let n = n.as_ref()?;
            let x = self.eval(n, frame);
            self.whole(x, what, [0, WIDEST], n.span)
        };
        let width = given(&w.width, "the width of an item");
        let decimals = given(&w.decimals, "the number of decimals");
        let format = Format {
            align: w.align,
            width,
            decimals,
        };
        Some((self.put_item(&w.value, frame)?, format))
    }

    /// Makes a file the current one; one that was closed begins again.
    pub(super) fn open_put_file(&mut self, s: SymbolId) {
        self.put.current = Some(s);
        let f = self.put.files.entry(s).or_default();
        if !f.open {
            f.appends = f.text.get("ap") != 0.0;
            f.text.reopen();
            f.open = true;
        }
        if f.cursor.is_none() {
            f.hold_cursor();
        }
    }

    /// The current file; a diagnostic if there is none.
    pub(super) fn put_file(&mut self, span: Span) -> Option<&mut super::options::PutFile> {
        let Some(s) = self.put.current else {
            Diagnostic::execution("E0472", span)
                .says("no file is open to write to")
                .label("which file?")
                .help("declare one, `file out / 'out.txt' /;`, and name it first: `put out 'text' /;`")
                .note(self);
            return None;
        };
        self.open_put_file(s);
        let f = self.put.files.get_mut(&s)?;
        f.span = span;
        Some(f)
    }

    fn put_trouble(&mut self, r: Result<(), Overflow>, span: Span) {
        let d = match r {
            Ok(()) => return,
            Err(Overflow::Number) => Diagnostic::warning("E0473", span)
                .says("the number is too wide for its place; asterisks were written")
                .help("give it a greater width, `x:12:2`, or width 0, `x:0:2`"),
            Err(Overflow::Line) => Diagnostic::warning("E0473", span)
                .says("the line is longer than the file's `.pw`; the rest of it was lost")
                .help("end the line with `/`, or assign a greater `.pw`"),
            Err(Overflow::Row) => Diagnostic::warning("E0473", span)
                .says("the row lies below the page; the last row was taken")
                .help("assign a greater `.ps`"),
        };
        d.note(self);
    }

    /// Writes a file, if anything was put into it, and forgets its cursor.
    pub(super) fn close_put_file(&mut self, s: SymbolId, span: Span) {
        let SymbolKind::File(name) = &self.symbols.get(s).kind else {
            return;
        };
        let declared = name.clone();
        let Some(f) = self.put.files.get_mut(&s).filter(|f| f.open) else {
            return;
        };
        let name = f.name.clone().unwrap_or_else(|| declared.into());
        f.open = false;
        if f.text.is_empty() {
            return;
        }
        let before = f.appends.then(|| self.map.written_text(&name)).flatten();
        let text = [before.unwrap_or_default(), f.text.finish()].concat();
        f.text.reopen();
        if name.trim().is_empty() {
            // `file log / '' /` is the log.
            if !self.options.quiet {
                self.print(&text);
            }
            return;
        }
        self.write_file(&name, text.as_bytes(), span);
        self.map.remember(&name, text.into_bytes(), span);
    }

    /// Writes what is still open, in the order of declaration.
    pub(super) fn close_put_files(&mut self) {
        let open = self.put.files.iter().filter(|(_, f)| f.open);
        let mut open: Vec<(SymbolId, Span)> = open.map(|(&s, f)| (s, f.span)).collect();
        open.sort_unstable_by_key(|(s, _)| *s);
        for (s, span) in open {
            self.close_put_file(s, span);
        }
    }

    /// What an expression is to `put`; None for what a condition hides.
    pub(super) fn put_item(&self, n: &Node, frame: &mut Frame) -> Option<Item> {
        Some(match &n.kind {
            NodeKind::Text(t) => match t.strip_prefix("%system.").and_then(|t| t.strip_suffix('%'))
            {
                Some(what) => self.system_value(what),
                None => Item::Text(t.to_string()),
            },
            NodeKind::LabelText(p) => {
                let l = self.part(p, frame);
                Item::Label(l.map_or_else(String::new, |l| self.store.universe.name(l).to_string()))
            }
            NodeKind::ElementText(t, key) => {
                let mut k = [0; 20];
                if !self.key(key, frame, &mut k) {
                    return Some(Item::Text(String::new()));
                }
                let k = &k[..key.parts.len()];
                let file = self.put.current.and_then(|s| self.put.files.get(&s));
                // `.tf`: the labels stand for a text that is missing (1, 2) or for any (3, 4: in quotes).
                let fill = file.map_or(2.0, |f| f.text.get("tf"));
                match self.store.element_text(*t, k) {
                    Some(text) if fill < 3.0 => Item::Text(text.to_string()),
                    None if fill == 0.0 => Item::Text(String::new()),
                    _ => {
                        let names = k.iter().map(|&l| self.store.universe.name(l));
                        let names: Vec<&str> = names.collect();
                        Item::Text(match fill >= 4.0 {
                            true => format!("\"{}\"", names.join("\",\"")),
                            false => names.join("."),
                        })
                    }
                }
            }
            NodeKind::SymbolText(s) => Item::Text(self.symbols.get(*s).text.to_string()),
            NodeKind::RecordName(s, key) => {
                let labels = key.parts.iter().map(|p| {
                    // A lag beyond the end: `x("")`.
                    let name = self.part(p, frame).map(|l| self.store.universe.name(l));
                    let name = name.unwrap_or_default();
                    let plain = !name.is_empty() && !name.contains('\'');
                    let quote = if plain { '\'' } else { '"' };
                    format!("{quote}{name}{quote}")
                });
                let labels: Vec<String> = labels.collect();
                let symbol = &self.symbols.get(*s).name;
                Item::Text(match labels.as_slice() {
                    [] => symbol.to_string(),
                    l => format!("{symbol}({})", l.join(",")),
                })
            }
            NodeKind::ObjectAttribute(s, a @ ("tmodstat" | "tsolstat")) => {
                Item::Text(self.status_text(*s, a))
            }
            NodeKind::SameAs(..) | NodeKind::Const(_) if n.member => {
                Item::Member(truth(self.eval(n, frame)))
            }
            NodeKind::Data(t, _)
                if self
                    .table_symbol(*t)
                    .is_some_and(|s| self.symbols.get(s).is_set()) =>
            {
                Item::Member(truth(self.eval(n, frame)))
            }
            NodeKind::Dollar(a, c) if says_text(a) => {
                if !truth(self.eval(c, frame)) {
                    return None;
                }
                self.put_item(a, frame)?
            }
            _ => {
                let v = self.eval(n, frame);
                match special_text(v, &self.store.acronyms) {
                    _ if is_eps(v) => Item::Eps,
                    Some(name) => Item::Special(name.to_string()),
                    None => Item::Number(v),
                }
            }
        })
    }

    /// `system.date` and the like.
    fn system_value(&self, what: &str) -> Item {
        let now = self.now();
        let part = |f| calendar::part(f, now).unwrap_or(0.0);
        use DataFunction::{GDay, GHour, GMinute, GMonth, GSecond, GYear};
        let [year, month, day] = [GYear, GMonth, GDay].map(part);
        let source = || self.map.files().first().map_or("", |f| f.name.as_str());
        let path = std::path::Path::new(source());
        let name = |p: Option<&std::ffi::OsStr>| {
            p.map_or_else(String::new, |s| s.to_string_lossy().into_owned())
        };
        Item::Text(match what {
            "date" => format!("{month:02}/{day:02}/{:02}", year % 100.0),
            "date1" => {
                let month = MONTHS[(month.max(1.0) as usize - 1).min(11)];
                format!("{month} {day:02}, {year}")
            }
            "time" => {
                let [h, m, s] = [GHour, GMinute, GSecond].map(part);
                format!("{h:02}:{m:02}:{s:02}")
            }
            "title" => self.map.title.clone().unwrap_or_else(|| "bmod".into()),
            "version" => "GAMS Rev 546".into(),
            "verid" => "LEX546-546".into(),
            "buildcode" => "LEG".into(),
            "platform" => "LEX".into(),
            "gamsversion" => return Item::Number(546.0),
            "gamsrelease" => return Item::Number(54.6),
            "gamsreleasemaint" => "54.6.1".into(),
            "page" => return Item::Page,
            "ifile" | "sfile" | "incname" => source().to_string(),
            "fn" => name(path.file_stem()),
            "fe" => path
                .extension()
                .map_or_else(String::new, |e| format!(".{}", e.to_string_lossy())),
            "fp" => path
                .parent()
                .map_or_else(String::new, |p| format!("{}/", p.display())),
            "tab" => "\t".into(),
            "dirsep" => "/".into(),
            "filesys" => "UNIX".into(),
            "elapsed" => format!("{:.3}", self.elapsed()),
            "line" | "incline" | "iline" => self.map.line(self.options.at.get()).to_string(),
            "errorlevel" => "0".into(),
            _ => String::new(),
        })
    }
}

/// Whether an item is written as a text.
fn says_text(n: &Node) -> bool {
    is_text(n)
        || matches!(
            n.kind,
            NodeKind::ObjectAttribute(_, "tmodstat" | "tsolstat")
        )
}
