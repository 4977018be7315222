//! `display`: which records of which symbols, as text for the user and as records for the report.

use super::Machine;
use super::eval::derived_value;
use crate::check::functions::stored_attribute;
use crate::check::node::{Derived, Shown, SymbolId};
use crate::check::symbols::{SymbolKind, attribute};
use crate::data::table::Table;
use crate::report::display::{self, Cells, Layout, Numbers, Sheet};
use crate::report::json::{Display, Number};
use crate::source::Span;
use std::borrow::Cow;
use std::fmt::Write;

/// The text of a statement while it grows.
struct Page {
    text: String,
    line: usize,
    /// The last block takes further scalars and texts.
    open: bool,
}

impl Page {
    /// A line among scalars and texts: they stand under one another.
    fn line(&mut self, line: &str) {
        if self.open {
            // The blank line that ended the block goes after this one.
            self.text.pop();
            let _ = writeln!(self.text, "{:12}{}\n", "", line);
        } else {
            let _ = writeln!(self.text, "----{:7} {}\n", self.line, line);
        }
        self.open = true;
    }

    /// The header of a block of its own.
    fn header(&mut self, header: &str) {
        let _ = writeln!(self.text, "----{:7} {}", self.line, header.trim_end());
        self.open = false;
    }
}

impl Machine<'_> {
    /// Shows symbols and texts.
    pub(super) fn display(&mut self, items: &[Shown], span: Span) {
        let line = self.map.listing_line(span);
        let mut page = Page {
            text: String::new(),
            line,
            open: false,
        };
        for item in items {
            match item {
                Shown::Text(t) => {
                    page.line(t.trim_end());
                    if self.options.collect {
                        self.report().displays.push(Display::Text {
                            line,
                            text: t.to_string(),
                        });
                    }
                }
                Shown::Symbol(s, attr) => self.show(*s, *attr, &mut page),
            }
        }
        if !self.options.quiet {
            self.print(&page.text);
        }
        self.look_soon();
    }

    fn show(&mut self, s: SymbolId, attr: Option<&'static str>, page: &mut Page) {
        let kind = &self.symbols.get(s).kind;
        if matches!(kind, SymbolKind::Model(_) | SymbolKind::File(_)) {
            return self.show_object(s, attr.unwrap_or("modelstat"), page);
        }
        let root = self.symbols.root(s);
        if root == crate::check::symbols::UNIVERSE {
            self.store.refresh_universe();
        }
        self.tidy_shown(s, attr);
        let Some(table) = self.shown_table(s, attr) else {
            return;
        };
        let symbol = self.symbols.get(s);
        let kind = match symbol.kind {
            SymbolKind::Set { .. } | SymbolKind::Alias(_) => "SET",
            SymbolKind::Parameter { .. } => "PARAMETER",
            SymbolKind::Variable(_) => "VARIABLE",
            _ => "EQUATION",
        };
        let named = |a: &str| format!("{}.{a}", symbol.name);
        let shown_name = attr.map_or_else(|| symbol.name.to_string(), named);
        let short = attr.map_or_else(|| symbol.name.to_string(), |a| named(&a.to_lowercase()));
        let numbers = self.numbers(s);
        if table.dim() == 0 {
            let value = table.get(&[]);
            page.line(&numbers.scalar(kind, &shown_name, value, &symbol.text));
            drop(table);
            self.collect_scalar(page.line, short, value);
            return;
        }
        if !self.options.quiet {
            self.show_table(s, &table, &format!("{kind} {shown_name}"), page);
        }
        let collected = (self.options.collect).then(|| {
            let domain = self.symbols.domain_names(self.symbols.get(root));
            (domain, self.records(&table))
        });
        drop(table);
        if let Some((domain, records)) = collected {
            let display = Display::Indexed {
                line: page.line,
                symbol: short,
                domain,
                records,
            };
            self.report().displays.push(display);
        }
    }

    /// A table that is not a single number on the page, under its name.
    fn show_table(&self, s: SymbolId, table: &Table, name: &str, page: &mut Page) {
        let (symbol, root) = (self.symbols.get(s), self.symbols.root(s));
        let numbers = self.numbers(s);
        let default = table.default_value();
        if root != s {
            let of = &self.symbols.get(root).name;
            page.header(&format!("{name}  Aliased with {of}"));
        } else if default == 0.0 {
            page.header(&format!("{name}  {}", symbol.text));
            page.text.push('\n');
        } else {
            let default = if default.is_finite() {
                default.to_string()
            } else {
                numbers.text(default)
            };
            page.header(&format!("{name} ({default}) {}", symbol.text));
            page.text.push('\n');
        }
        if table.is_empty() {
            if symbol.is_set() {
                page.text.push_str(&display::empty_set());
            } else {
                page.text.push_str(&numbers.all_default(default));
            }
            page.text.push('\n');
        } else {
            let set = self.symbols.get(root).table;
            let cells = if symbol.is_set() {
                Cells::Members(self.store.texts.get(&set))
            } else {
                Cells::Numbers
            };
            let layout = match self.formats.get(&s).map(Vec::as_slice) {
                Some([_, rows, columns, ..]) => Some(Layout {
                    rows: (*rows).max(0) as usize,
                    columns: (*columns).max(1) as usize,
                }),
                _ => None,
            };
            let sheet = Sheet {
                table,
                universe: &self.store.universe,
                cells,
                numbers,
                layout,
                page: self.options.line.unwrap_or(display::PAGE),
            };
            sheet.write(&mut page.text);
        }
        page.text.push('\n');
    }

    /// Labels and values of a table's records.
    fn records(&self, table: &Table) -> Vec<(Vec<String>, Number)> {
        let labels = |k: &[u32]| {
            let names = k.iter().map(|&l| self.store.universe.name(l).to_string());
            names.collect()
        };
        table.iter().map(|(k, v)| (labels(k), Number(v))).collect()
    }

    /// An attribute of a model or a file.
    fn show_object(&mut self, s: SymbolId, attr: &'static str, page: &mut Page) {
        let value = self.object_attribute(s, attr);
        let symbol = self.symbols.get(s);
        let kind = if matches!(symbol.kind, SymbolKind::Model(_)) {
            "MODEL"
        } else {
            "FILE"
        };
        let name = format!("{}.{}", symbol.name, spelled(attr));
        page.line(&self.numbers(s).scalar(kind, &name, value, &symbol.text));
        self.collect_scalar(page.line, format!("{}.{attr}", symbol.name), value);
    }

    fn collect_scalar(&mut self, line: usize, symbol: String, value: f64) {
        if self.options.collect {
            self.report().displays.push(Display::Scalar {
                line,
                symbol,
                value: Number(value),
            });
        }
    }

    /// How the numbers of a symbol look: with its own decimals, or the option's.
    fn numbers(&self, s: SymbolId) -> Numbers<'_> {
        let usual = Numbers::usual(&self.store.acronyms);
        let own = self.formats.get(&s).and_then(|f| f.first());
        let decimals = own.map(|&d| d as f64);
        let decimals = decimals.or_else(|| self.options.number("decimals"));
        let wide = self.options.number("dispwidth").map(|w| w as usize);
        Numbers {
            decimals: decimals.map_or(usual.decimals, |d| d.clamp(0.0, 8.0) as usize),
            // Other widths are passed over, as in GAMS.
            heading: wide
                .filter(|w| (10..=31).contains(w))
                .unwrap_or(usual.heading),
            ..usual
        }
    }

    /// Makes the tables tidy that a display of a symbol reads.
    fn tidy_shown(&mut self, s: SymbolId, attr: Option<&str>) {
        let symbol = self.symbols.get(s);
        let table = symbol.table;
        let offsets: Vec<u32> = match (&symbol.kind, attr.map(stored_attribute)) {
            (SymbolKind::Acronym(_) | SymbolKind::Figure(_), _) => vec![],
            (_, None) => vec![0],
            (_, Some(Some(o))) => vec![o],
            (_, Some(None)) => vec![attribute::L, attribute::LO, attribute::UP],
        };
        for o in offsets {
            self.store.table_mut(table + o).tidy();
        }
    }

    /// The records that a display of a symbol shows; those of computed attributes are made here.
    fn shown_table(&self, s: SymbolId, attr: Option<&str>) -> Option<Cow<'_, Table>> {
        let symbol = self.symbols.get(s);
        let table = symbol.table;
        if matches!(symbol.kind, SymbolKind::Acronym(_) | SymbolKind::Figure(_)) {
            return None;
        }
        let Some(attr) = attr else {
            return Some(Cow::Borrowed(self.store.table(table)));
        };
        if let Some(o) = stored_attribute(attr) {
            return Some(Cow::Borrowed(self.store.table(table + o)));
        }
        let which = Derived::named(attr)?;
        if let Some(t) = self.ranges.get(&(s, which)) {
            return Some(Cow::Borrowed(t));
        }
        let is_equation = matches!(symbol.kind, SymbolKind::Equation(_));
        let [l, lo, up] =
            [attribute::L, attribute::LO, attribute::UP].map(|o| self.store.table(table + o));
        let value = |l: f64, lo: f64, up: f64| derived_value(which, is_equation, l, lo, up);
        let mut keys: Vec<&[u32]> = Vec::new();
        for t in [l, lo, up] {
            keys.extend(t.iter().map(|(k, _)| k));
        }
        keys.sort_unstable();
        keys.dedup();
        let values = keys
            .iter()
            .map(|k| value(l.get(k), lo.get(k), up.get(k)))
            .collect();
        let default = value(l.default_value(), lo.default_value(), up.default_value());
        Some(Cow::Owned(Table::from_records(
            l.dim(),
            default,
            keys.concat(),
            values,
        )))
    }
}

/// A model's or file's attribute as GAMS spells it.
fn spelled(attr: &str) -> Cow<'static, str> {
    #[rustfmt::skip]
    const KNOWN: &[&str] = &[
        "ModelStat", "SolveStat", "ObjVal", "ObjEst", "IterUsd", "ResUsd", "NumEqu", "NumVar", "NumNZ",
        "NumNLNZ", "NumNLIns", "NumInfes", "SumInfes", "MaxInfes", "MeanInfes", "NumDepnd", "NumDVar",
        "NumNOpt", "NumRedef", "DomUsd", "Line", "Number", "Marginals", "LimRow", "LimCol", "OptFile",
        "HoldFixed", "IterLim", "ResLim", "SCALEOPT", "OptCR", "OptCA", "TolInfeas", "TolInfRep", "LinkUsed",
        "DomLim", "BRatio", "NodLim", "WorkSpace", "WorkFactor", "Cheat", "Cutoff", "TryInt", "PriorOpt",
        "SysOut", "SolPrint", "SolveOpt", "SolveLink", "SavePoint", "Threads", "DictFile", "ETSolve",
        "ETSolver", "ETAlg", "ResGen", "ResIn", "ResDeriv", "ResOut", "RngBndMax", "RngBndMin", "RngMatMax",
        "RngMatMin", "RngRhsMax", "RngRhsMin", "NodUsd", "ProcUsed", "TolProj", "DefPoint", "Handle",
        "MCPRHoldfx", "FDOpt", "FDDelta", "JustScrDir", "TryLinear", "Reform", "RequestMarginals",
        "NumVarProj", "ResCalc", "RObj", "SysIdent", "SysVer", "Case",
    ];
    match KNOWN.iter().find(|k| k.eq_ignore_ascii_case(attr)) {
        Some(k) => Cow::Borrowed(k),
        None => Cow::Owned(attr.to_uppercase()),
    }
}
