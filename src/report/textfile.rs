//! A file that `put` writes: pages with a title, a header and a body, a cursor in each, and the forms in
//! which items are separated (`.pc`). Knows nothing of symbols.
//!
//! A page begins when something is written to its body; title and header are what they are then. Where
//! there is neither, pages cannot be seen. Source: GAMS 54.6, observed.

use super::number::{Form, number};
use rustc_hash::FxHashMap;

/// Stands for the number of the page in a title or header.
pub const PAGE_NUMBER: char = '\u{1}';

/// Widths, decimals and attributes beyond are cut to it.
pub const WIDEST: usize = 32_767;

/// Attributes and their values before anything is assigned.
const DEFAULTS: &[(&str, f64)] = &[
    ("pw", WIDEST as f64),
    ("ps", 58.0),
    ("pc", 2.0),
    ("nd", 2.0),
    ("nw", 12.0),
    ("nr", 1.0),
    ("nz", 1e-10),
    ("nj", 1.0),
    ("lj", 2.0),
    ("lw", 12.0),
    ("sj", 1.0),
    ("sw", 12.0),
    ("tj", 2.0),
    ("tf", 2.0),
];

/// What an item is; each kind has its width and alignment.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A number, to be formatted.
    Number(f64),
    /// `eps`: a zero, but by name where `.nz` is 0.
    Eps,
    /// A special value or an acronym, by name.
    Special(String),
    /// A label of a set.
    Label(String),
    /// A quoted text, an explanatory text.
    Text(String),
    /// Membership: YES or NO.
    Member(bool),
    /// Number of the page.
    Page,
}

/// Width, decimals and alignment of an item, where they are given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Format {
    /// `<` left, `>` right, `=` centred.
    pub align: Option<char>,
    /// Width; 0: what the item needs.
    pub width: Option<usize>,
    /// Decimals.
    pub decimals: Option<usize>,
}

/// Parts of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// `puttl`
    Title,
    /// `puthd`
    Header,
    /// `put`
    Body,
}

/// What did not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// A number wider than its width.
    Number,
    /// A line longer than `.pw`.
    Line,
    /// A row beyond `.ps`.
    Row,
}

/// Lines with a cursor.
#[derive(Clone, Debug, Default)]
struct Block {
    lines: Vec<String>,
    /// Characters of each line.
    widths: Vec<usize>,
    row: usize,
    /// Column of the next character, from 0.
    column: usize,
    /// The line is full; what comes is lost until the next one.
    full: bool,
}

/// A file while it is written.
#[derive(Clone, Debug, Default)]
pub struct TextFile {
    /// Pages that are finished.
    done: String,
    title: Block,
    header: Block,
    body: Block,
    /// Title and header of the page that has begun.
    begun: Option<Vec<String>>,
    /// Pages begun so far.
    pages: usize,
    attributes: FxHashMap<&'static str, f64>,
}

impl Block {
    fn reach(&mut self, row: usize) {
        while self.lines.len() <= row {
            self.lines.push(String::new());
            self.widths.push(0);
        }
    }

    /// Writes at the cursor; what stands there is overwritten.
    fn write(&mut self, text: &str) {
        self.reach(self.row);
        let (line, width) = (&mut self.lines[self.row], &mut self.widths[self.row]);
        let n = text.chars().count();
        if self.column >= *width {
            line.extend(std::iter::repeat_n(' ', self.column - *width));
            line.push_str(text);
            *width = self.column + n;
        } else {
            let mut chars: Vec<char> = line.chars().collect();
            for (k, c) in text.chars().enumerate() {
                match chars.get_mut(self.column + k) {
                    Some(place) => *place = c,
                    None => chars.push(c),
                }
            }
            *width = chars.len();
            *line = chars.into_iter().collect();
        }
        self.column += n;
    }

    fn new_line(&mut self) {
        self.reach(self.row);
        self.row += 1;
        self.column = 0;
        self.full = false;
    }
}

impl TextFile {
    /// An attribute, lower case.
    pub fn get(&self, name: &str) -> f64 {
        let count = |n: usize| n as f64;
        match name {
            "cc" => count(self.body.column + 1),
            "cr" => count(self.body.row + 1),
            "ll" => count(self.body.lines.len()),
            "hdcc" => count(self.header.column + 1),
            "hdcr" => count(self.header.row + 1),
            "hdll" => count(self.header.lines.len()),
            "tlcc" => count(self.title.column + 1),
            "tlcr" => count(self.title.row + 1),
            "tlll" => count(self.title.lines.len()),
            "lp" => count(self.pages - usize::from(self.begun.is_some())),
            "ws" => count(self.capacity()),
            _ => match self.attributes.get(name) {
                Some(&v) => v,
                None => DEFAULTS.iter().find(|d| d.0 == name).map_or(0.0, |d| d.1),
            },
        }
    }

    /// Assigns an attribute; those of the cursor move it, those of the last line cut what is below.
    pub fn set(&mut self, name: &'static str, value: f64) {
        let place = value.clamp(1.0, 1e6) as usize - 1;
        let lines = value.clamp(0.0, 1e6) as usize;
        let cut = |b: &mut Block| {
            b.lines.truncate(lines);
            b.widths.truncate(lines);
            if b.row >= lines {
                (b.row, b.column) = (lines, 0);
            }
        };
        match name {
            "cc" => self.body.column = place,
            "cr" => self.body.row = place,
            "hdcc" => self.header.column = place,
            "hdcr" => self.header.row = place,
            "tlcc" => self.title.column = place,
            "tlcr" => self.title.row = place,
            "ll" => cut(&mut self.body),
            "hdll" => cut(&mut self.header),
            "tlll" => cut(&mut self.title),
            "nd" => {
                self.attributes.insert(name, value.clamp(0.0, 20.0));
            }
            _ => {
                self.attributes.insert(name, value);
            }
        }
    }

    fn integer(&self, name: &str) -> i64 {
        self.get(name).clamp(-1.0, WIDEST as f64) as i64
    }

    /// A width or a number of lines.
    fn natural(&self, name: &str) -> usize {
        self.integer(name).max(0) as usize
    }

    fn block(&mut self, part: Part) -> &mut Block {
        match part {
            Part::Title => &mut self.title,
            Part::Header => &mut self.header,
            Part::Body => &mut self.body,
        }
    }

    /// Rows of a page's body.
    fn capacity(&self) -> usize {
        let above = match &self.begun {
            Some(lines) => lines.len(),
            None => self.title.lines.len() + self.header.lines.len(),
        };
        self.natural("ps").saturating_sub(above).max(1)
    }

    /// Whether anything was written.
    pub fn is_empty(&self) -> bool {
        self.begun.is_none() && self.done.is_empty()
    }

    /// Forgets text and pages, keeps the attributes (a file that is opened again).
    pub fn reopen(&mut self) {
        *self = Self {
            attributes: std::mem::take(&mut self.attributes),
            ..Self::default()
        };
    }

    fn begin(&mut self, part: Part) {
        if part != Part::Body || self.begun.is_some() {
            return;
        }
        self.pages += 1;
        let number = self.pages.to_string();
        let lines = self.title.lines.iter().chain(&self.header.lines);
        self.begun = Some(lines.map(|l| l.replace(PAGE_NUMBER, &number)).collect());
    }

    /// `/`
    pub fn new_line(&mut self, part: Part) {
        self.begin(part);
        self.block(part).new_line();
        if part == Part::Body && self.body.row >= self.capacity() {
            self.finish_page();
        }
    }

    /// `@n`, from 1. Ignored where items are separated by quotes and delimiters.
    pub fn column(&mut self, part: Part, n: usize) {
        if !matches!(self.integer("pc"), 4..=6) {
            let b = self.block(part);
            b.column = n.saturating_sub(1);
            b.full = false;
        }
    }

    /// `#n`, from 1.
    pub fn row(&mut self, part: Part, n: usize) -> Result<(), Overflow> {
        self.begin(part);
        let most = if part == Part::Body {
            self.capacity()
        } else {
            self.natural("ps").max(1)
        };
        let b = self.block(part);
        b.row = n.clamp(1, most) - 1;
        b.full = false;
        if n > most { Err(Overflow::Row) } else { Ok(()) }
    }

    /// Writes an item.
    pub fn item(&mut self, part: Part, item: &Item, format: Format) -> Result<(), Overflow> {
        self.begin(part);
        let pc = self.integer("pc");
        let mut trouble = Ok(());
        let eps;
        let item = match item {
            Item::Eps => {
                eps = match self.get("nz") == 0.0 {
                    true => Item::Special("EPS".into()),
                    false => Item::Number(0.0),
                };
                &eps
            }
            item => item,
        };
        let mut text = match item {
            Item::Eps => String::new(),
            Item::Number(x) => {
                let width = match format.width {
                    _ if pc == 8 => 0,
                    Some(w) => w,
                    None => self.natural("nw"),
                };
                let decimals = format
                    .decimals
                    .unwrap_or_else(|| self.natural("nd"))
                    .min(99);
                let x = if x.abs() < self.get("nz") { 0.0 } else { *x };
                let t = number(x, width, decimals, Form::new(self.get("nr")));
                if t.starts_with('*') {
                    trouble = Err(Overflow::Number);
                }
                t
            }
            Item::Special(s) | Item::Label(s) | Item::Text(s) => s.clone(),
            Item::Member(yes) => if *yes { "YES" } else { "NO" }.into(),
            Item::Page => PAGE_NUMBER.to_string(),
        };
        // Labels have an attribute of their own, which counts the other way.
        let case = match item {
            Item::Label(_) => -self.integer("lcase"),
            _ => self.integer("case"),
        };
        match case {
            1 | -2 => text = text.to_uppercase(),
            2 | -1 => text = text.to_lowercase(),
            _ => {}
        }
        if *item == Item::Page && part == Part::Body {
            text = self.pages.to_string();
        }
        if (4..=6).contains(&pc) || pc == 8 {
            text = self.separated(part, item, text, format);
        } else {
            let (wide, fits) = self.justified(item, &text, format);
            (text, trouble) = (wide, trouble.and(fits));
        }
        self.write(part, &text)?;
        trouble
    }

    /// An item between the marks of `.pc` 4, 5, 6 and 8.
    fn separated(&mut self, part: Part, item: &Item, mut text: String, format: Format) -> String {
        let pc = self.integer("pc");
        let quoted = !matches!(item, Item::Number(_) | Item::Page);
        if pc != 8 && !quoted {
            // Scientific numbers keep the place of the sign.
            let number = text.trim();
            let place = self.get("nr") == 2.0 && !number.starts_with(['-', '*']);
            text = format!("{}{number}", if place { " " } else { "" });
        }
        let width = format.width.unwrap_or_else(|| self.natural("nw"));
        if matches!(item, Item::Special(_)) && pc != 8 && width > 0 && text.len() > width {
            text = "*".repeat(width);
        }
        if quoted {
            text = text.replace('"', "\"\"");
            if pc != 8 {
                text = format!("\"{text}\"");
            }
        }
        let delimiter = match pc {
            5 => ",",
            6 => "\t",
            _ => " ",
        };
        if self.block(part).column > 0 {
            let wraps =
                pc == 8 && self.block(part).column + 1 + text.chars().count() > self.natural("pw");
            if wraps {
                self.new_line(part);
                self.begin(part);
            } else {
                text.insert_str(0, delimiter);
            }
        }
        text
    }

    /// An item in its width.
    fn justified(&self, item: &Item, text: &str, format: Format) -> (String, Result<(), Overflow>) {
        let (width, align) = match item {
            Item::Number(_) | Item::Special(_) | Item::Eps => ("nw", "nj"),
            Item::Label(_) => ("lw", "lj"),
            Item::Member(_) => ("sw", "sj"),
            Item::Text(_) | Item::Page => ("tw", "tj"),
        };
        let width = format.width.unwrap_or_else(|| self.natural(width));
        let align = match format.align {
            Some('<') => 2,
            Some('>') => 1,
            Some(_) => 3,
            None => self.integer(align),
        };
        let fits = text.chars().count() <= width;
        if !fits && matches!(item, Item::Special(_)) && width > 0 {
            return (
                aligned(&"*".repeat(width), width, align),
                Err(Overflow::Number),
            );
        }
        (aligned(text, width, align), Ok(()))
    }

    fn write(&mut self, part: Part, text: &str) -> Result<(), Overflow> {
        let page_width = self.natural("pw").max(4);
        let b = self.block(part);
        if b.full {
            return Ok(());
        }
        let n = text.chars().count();
        if b.column + n > page_width {
            let room = (page_width - 4).saturating_sub(b.column);
            let kept: String = text.chars().take(room).collect();
            b.write(&kept);
            b.column = page_width - 4;
            b.write("****");
            b.full = true;
            return Err(Overflow::Line);
        }
        b.write(text);
        Ok(())
    }

    /// `putpage`: the line that is open ends, and the page, if one has begun.
    pub fn end_page(&mut self) {
        if self.begun.is_some() {
            self.body.reach(self.body.row);
            self.finish_page();
        }
    }

    /// Text from elsewhere, between pages.
    pub fn insert(&mut self, text: &str) {
        self.end_page();
        self.done.push_str(text);
    }

    fn finish_page(&mut self) {
        let Some(above) = self.begun.take() else {
            return;
        };
        let body = std::mem::take(&mut self.body);
        let (pc, width) = (self.integer("pc"), self.natural("pw"));
        let top = self.natural("tm");
        let margin = self.natural("lm");
        let mut lines = 0;
        let mut emit = |out: &mut String, line: &str| {
            match (pc, lines) {
                (1, 0) => out.push('1'),
                (1, _) => out.push(' '),
                (3, 0) if !out.is_empty() => out.push('\u{c}'),
                _ => {}
            }
            let line = line.trim_end_matches(' ');
            if !line.is_empty() {
                out.extend(std::iter::repeat_n(' ', margin));
            }
            out.push_str(line);
            if pc == 7 && !line.is_empty() {
                let n = line.chars().count();
                out.extend(std::iter::repeat_n(' ', width.saturating_sub(n)));
            }
            out.push('\n');
            lines += 1;
        };
        for _ in 0..top {
            emit(&mut self.done, "");
        }
        for line in above.iter().chain(&body.lines) {
            emit(&mut self.done, line);
        }
        if pc == 0 {
            let whole = top as i64 + self.integer("ps") + self.integer("bm").max(0);
            for _ in lines as i64..whole {
                self.done.push('\n');
            }
        }
    }

    /// The whole text; the page that has begun ends.
    pub fn finish(&mut self) -> &str {
        self.finish_page();
        &self.done
    }
}

/// A text in a width (0: its own): cut on the right, or padded. 1 right, 2 left, 3 centred.
fn aligned(text: &str, width: usize, align: i64) -> String {
    let n = text.chars().count();
    if width == 0 {
        return text.to_string();
    }
    if n > width {
        return text.chars().take(width).collect();
    }
    let blanks = width - n;
    let left = match align {
        1 => blanks,
        3 => blanks / 2,
        _ => 0,
    };
    format!("{:left$}{text}{:right$}", "", "", right = blanks - left)
}
