//! Reading: the index at once, the records of a symbol when they are asked for.

use super::stream::Input;
use super::{
    ACRONYM_UNIT, Domain, Error, INDEX_MARK, Kind, MAX_DIMENSION, Records, Result, Symbol, Value,
    fail,
};

/// Index positions that versions before 7 reserve in the code of a record.
const OLD_DIMENSION: usize = 10;

/// A GDX file that was opened: its index.
#[derive(Debug, Default)]
pub struct File<'a> {
    bytes: &'a [u8],
    /// Version of the format.
    pub version: i32,
    /// The library that wrote it.
    pub library: String,
    /// The program that wrote it.
    pub producer: String,
    /// Whether records are packed.
    pub packed: bool,
    /// All labels.
    pub labels: Vec<String>,
    /// All texts of elements; the first is empty.
    pub texts: Vec<String>,
    /// Names of acronyms, and the number that values are coded by.
    acronyms: Vec<(String, i32)>,
    /// The symbols, in the order of the file.
    pub symbols: Vec<Symbol>,
    places: Vec<Place>,
}

/// Where the records of a symbol are.
#[derive(Debug)]
struct Place {
    at: i64,
    count: i32,
    packed: bool,
}

impl<'a> File<'a> {
    /// Reads the index.
    pub fn open(bytes: &'a [u8]) -> Result<Self> {
        let mut head = Input::new(bytes, 0, false)?;
        let order: [u8; 17] = head.array()?;
        if order[..3] != [2, 0x34, 0x12] || order[3..8] != [4, 0x78, 0x56, 0x34, 0x12] {
            return fail(match order {
                [2, 0x12, 0x34, ..] => "it was written by a machine of the other byte order",
                _ => "it is not a GDX file",
            });
        }
        if head.byte()? != 123 || head.text()? != "GAMSGDX" {
            return fail("it is not a GDX file");
        }
        let version = head.i32()?;
        if !(5..=7).contains(&version) {
            return fail(format!(
                "it has version {version} of the format; 5 to 7 are known"
            ));
        }
        let packed = version > 5 && head.i32()? > 0;
        let (library, producer) = (head.text()?, head.text()?);
        if head.i32()? != INDEX_MARK {
            return fail("the index is missing: the file was not finished");
        }
        let mut place = || match version {
            5 => head.i32().map(i64::from),
            _ => head.i64(),
        };
        let (symbols, labels, texts) = (place()?, place()?, place()?);
        let (acronyms, _next, domains) = match version {
            7 => (place()?, place()?, place()?),
            _ => (0, 0, 0),
        };
        let mut file = Self {
            bytes,
            version,
            library,
            producer,
            packed,
            ..Self::default()
        };
        file.labels = file.list(labels, "_UEL_", "labels", Input::text)?;
        file.texts = file.list(texts, "_SETT_", "texts", Input::text)?;
        if version == 7 {
            file.acronyms = file.list(acronyms, "_ACRO_", "acronyms", |i| {
                let (name, _text) = (i.text()?, i.text()?);
                Ok((name, i.i32()?))
            })?;
        }
        let listed = file.list(symbols, "_SYMB_", "symbols", |i| symbol(i, version))?;
        for (symbol, place) in listed {
            file.symbols.push(symbol);
            file.places.push(place);
        }
        if domains != 0 {
            file.relaxed_domains(domains)?;
        }
        file.check()?;
        Ok(file)
    }

    /// A list between two marks.
    fn list<T>(
        &self,
        at: i64,
        mark: &str,
        what: &str,
        mut read: impl FnMut(&mut Input<'a>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let mut input = Input::new(self.bytes, at, self.packed)?;
        input.mark(mark)?;
        let count = input.count(what)?;
        let mut out = Vec::new();
        for _ in 0..count {
            out.push(read(&mut input)?);
        }
        input.mark(mark)?;
        Ok(out)
    }

    /// Names of sets that are domains in words only.
    fn relaxed_domains(&mut self, at: i64) -> Result<()> {
        let mut input = Input::new(self.bytes, at, self.packed)?;
        input.mark("_DOMS_")?;
        let mut names = Vec::new();
        for _ in 0..input.count("domains")? {
            names.push(input.text()?);
        }
        input.mark("_DOMS_")?;
        while let number @ 1.. = input.i32()? {
            let Some(symbol) = self.symbols.get_mut(number as usize - 1) else {
                return fail(format!("symbol {number} has a domain but does not exist"));
            };
            for d in &mut symbol.domain {
                // 0 stands for `*`. Sets of the file are known already.
                let n = input.i32()?;
                if *d == Domain::Universe && n > 0 {
                    match names.get(n as usize - 1) {
                        Some(name) => *d = Domain::Relaxed(name.clone()),
                        None => return fail(format!("domain {n} is not in the list of names")),
                    }
                }
            }
        }
        input.mark("_DOMS_")
    }

    /// What the index refers to exists.
    fn check(&self) -> Result<()> {
        let is_set = |n: usize| {
            let kind = self.symbols.get(n).map(|s| s.kind);
            matches!(kind, Some(Kind::Set { .. } | Kind::Alias(_)))
        };
        for s in &self.symbols {
            let wrong = |what: &str| fail(format!("the {what} of `{}` is no set", s.name));
            match s.kind {
                Kind::Alias(Some(n)) if !is_set(n) => return wrong("alias"),
                _ => {}
            }
            let mut sets = s.domain.iter().filter_map(|d| match d {
                Domain::Set(n) => Some(*n),
                _ => None,
            });
            if sets.any(|n| !is_set(n)) {
                return wrong("domain");
            }
        }
        Ok(())
    }

    /// The symbol of a name, in any case of letters.
    pub fn find(&self, name: &str) -> Option<usize> {
        let same = |s: &Symbol| s.name.eq_ignore_ascii_case(name);
        self.symbols.iter().position(same)
    }

    /// Names of acronyms, in the order that values refer to.
    pub fn acronyms(&self) -> impl Iterator<Item = &str> {
        self.acronyms.iter().map(|a| a.0.as_str())
    }

    /// The set behind an alias; none for the set of all labels.
    pub fn root(&self, symbol: usize) -> Result<Option<usize>> {
        let mut at = symbol;
        // A chain of aliases that is longer than the list goes round.
        for _ in 0..=self.symbols.len() {
            match self.symbols[at].kind {
                Kind::Alias(Some(n)) => at = n,
                Kind::Alias(None) => return Ok(None),
                _ => return Ok(Some(at)),
            }
        }
        fail(format!(
            "`{}` is an alias of itself",
            self.symbols[symbol].name
        ))
    }

    /// How many records a symbol has.
    pub fn count(&self, symbol: usize) -> Result<usize> {
        Ok(match self.root(symbol)? {
            None => self.labels.len(),
            Some(s) => usize::try_from(self.places[s].count).unwrap_or(0),
        })
    }

    /// The records of a symbol, of the set behind an alias. A scalar has one always.
    pub fn records(&self, symbol: usize) -> Result<Records> {
        let of = |e: Error| format!("`{}`: {e}", self.symbols[symbol].name);
        match self.root(symbol)? {
            None => Ok(self.universe()),
            Some(s) => self.decode(s).map_err(of),
        }
    }

    /// All labels as the elements of a set.
    pub fn universe(&self) -> Records {
        let len = self.labels.len();
        Records {
            len,
            keys: (0..len as u32).collect(),
            values: Vec::new(),
            texts: vec![0; len],
        }
    }

    fn decode(&self, symbol: usize) -> Result<Records> {
        let (s, place) = (&self.symbols[symbol], &self.places[symbol]);
        let dim = s.domain.len();
        let width = s.kind.width();
        let mut out = Records::default();
        if dim == 0 && place.count == 0 && width > 0 {
            out.len = 1;
            out.values.extend_from_slice(s.kind.defaults());
            return Ok(out);
        }
        let mut input = Input::new(self.bytes, place.at, place.packed)?;
        input.mark("_DATA_")?;
        if usize::from(input.byte()?) != dim {
            return fail("the number of its index positions is not the same everywhere");
        }
        input.i32()?;
        let mut least = [0i32; MAX_DIMENSION];
        let mut size = [0u8; MAX_DIMENSION];
        for d in 0..dim {
            let (low, high) = (input.i32()?, input.i32()?);
            least[d] = low;
            size[d] = match i64::from(high) - i64::from(low) + 1 {
                1..=255 => 1,
                256..=65535 => 2,
                _ => 4,
            };
        }
        let reserved = if self.version < 7 { OLD_DIMENSION } else { dim };
        let mut key = [0i32; MAX_DIMENSION];
        loop {
            let code = usize::from(input.byte()?);
            match code {
                255 => break,
                _ if code > reserved => {
                    // The last label is that many further.
                    if dim > 0 {
                        key[dim - 1] = key[dim - 1].saturating_add((code - reserved) as i32);
                    }
                }
                _ => {
                    for d in code.saturating_sub(1)..dim {
                        let step = match size[d] {
                            1 => i32::from(input.byte()?),
                            2 => i32::from(input.u16()?),
                            _ => input.i32()?,
                        };
                        key[d] = least[d].saturating_add(step);
                    }
                }
            }
            if out.len as i64 == i64::from(place.count) {
                return fail(format!(
                    "it has more than the {} records announced",
                    out.len
                ));
            }
            out.len += 1;
            for &k in &key[..dim] {
                if k < 1 || k as usize > self.labels.len() {
                    return fail(format!(
                        "record {} refers to label {k} of {}",
                        out.len,
                        self.labels.len()
                    ));
                }
                out.keys.push(k as u32 - 1);
            }
            if width == 0 {
                out.texts.push(self.text(&mut input)?);
            }
            for _ in 0..width {
                out.values.push(self.value(&mut input)?);
            }
        }
        if out.len as i64 != i64::from(place.count) {
            return fail(format!(
                "it has {} records; {} are announced",
                out.len, place.count
            ));
        }
        Ok(out)
    }

    /// The number of an element's text, coded as a value.
    fn text(&self, input: &mut Input<'_>) -> Result<u32> {
        match self.value(input)? {
            Value::Number(0.0) => Ok(0),
            Value::Number(n) if n >= 0.0 && n < self.texts.len() as f64 && n.fract() == 0.0 => {
                Ok(n as u32)
            }
            _ => fail("an element refers to a text that is not in the file"),
        }
    }

    fn value(&self, input: &mut Input<'_>) -> Result<Value> {
        Ok(match input.byte()? {
            0 => Value::Undefined,
            1 => Value::NotAvailable,
            2 => Value::Number(f64::INFINITY),
            3 => Value::Number(f64::NEG_INFINITY),
            4 => Value::Eps,
            5 => Value::Number(0.0),
            6 => Value::Number(1.0),
            7 => Value::Number(-1.0),
            8 => Value::Number(0.5),
            9 => Value::Number(2.0),
            10 => match input.f64()? {
                x if x.is_nan() => Value::NotAvailable,
                x if x.is_finite() && x >= ACRONYM_UNIT => {
                    let code = (x / ACRONYM_UNIT).round() as i32;
                    match self.acronyms.iter().position(|a| a.1 == code) {
                        Some(n) => Value::Acronym(n as u32),
                        None => return fail(format!("acronym {code} has no name")),
                    }
                }
                x => Value::Number(x),
            },
            code => return fail(format!("a value has the unknown code {code}")),
        })
    }
}

/// An entry of the list of symbols.
fn symbol(input: &mut Input<'_>, version: i32) -> Result<(Symbol, Place)> {
    let name = input.text()?;
    let at = match version {
        5 => i64::from(input.i32()?),
        _ => input.i64()?,
    };
    let dim = input.i32()?;
    let Some(dim) = usize::try_from(dim).ok().filter(|d| *d <= MAX_DIMENSION) else {
        return fail(format!("`{name}` has {dim} index positions"));
    };
    let (kind, detail) = (input.byte()?, input.i32()?);
    let kind = match kind {
        0 => Kind::Set {
            singleton: detail == 1,
        },
        1 => Kind::Parameter,
        2 => Kind::Variable(detail),
        3 => Kind::Equation(detail),
        4 => Kind::Alias(usize::try_from(detail).unwrap_or(0).checked_sub(1)),
        _ => return fail(format!("`{name}` is of the unknown kind {kind}")),
    };
    let count = input.i32()?;
    // Errors that its producer counted, and whether there are texts.
    let (_, _) = (input.i32()?, input.byte()?);
    let text = input.text()?;
    let packed = version > 5 && input.byte()? != 0;
    let mut domain = vec![Domain::Universe; dim];
    if version == 7 {
        if input.byte()? != 0 {
            for d in &mut domain {
                if let n @ 1.. = input.i32()? {
                    *d = Domain::Set(n as usize - 1);
                }
            }
        }
        for _ in 0..input.count("comments")? {
            input.text()?;
        }
    }
    let symbol = Symbol {
        name,
        text,
        kind,
        domain,
    };
    Ok((symbol, Place { at, count, packed }))
}
