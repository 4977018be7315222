//! Marks of comments and directives, and the comments of a line.

use super::directives::word_len;

/// Marks of comments and directives, which directives change.
#[derive(Clone, Debug)]
pub(crate) struct Marks {
    /// First byte of a directive line.
    pub(crate) dollar: u8,
    /// First byte of a comment line.
    pub(crate) comment: u8,
    /// `$escape c`: `%c` is `%` and nothing to be replaced.
    pub(crate) escape: Option<u8>,
    pub(crate) eol: Vec<u8>,
    pub(crate) eol_on: bool,
    pub(crate) inline: (Vec<u8>, Vec<u8>),
    pub(crate) inline_on: bool,
    /// `$onNestCom`: inline comments may stand inside each other.
    pub(crate) nested: bool,
    pub(crate) slashes: bool,
    /// `$onDelim`: lines of data are lists with commas; each is marked by [`DELIMITED`].
    pub(crate) delimited: bool,
    /// First and last column that count, from 1.
    pub(crate) columns: (usize, usize),
}

/// The comments of a line.
pub(crate) struct Comments {
    /// Those between marks; the last may go on in the next line.
    pub(crate) pieces: Vec<(usize, usize)>,
    /// Where the line ends, or a comment to its end begins.
    pub(crate) end: usize,
    /// Where one was opened that goes on.
    pub(crate) opened: Option<usize>,
}

impl Marks {
    /// Those at the beginning of a text; `slashes`: `//` begins a comment.
    pub(crate) fn new(slashes: bool) -> Self {
        Self {
            dollar: b'$',
            comment: b'*',
            escape: None,
            eol: b"!!".to_vec(),
            eol_on: false,
            inline: (b"/*".to_vec(), b"*/".to_vec()),
            inline_on: false,
            nested: false,
            slashes,
            delimited: false,
            columns: (1, usize::MAX),
        }
    }

    /// If a line is a directive, where its name begins: behind `$` in the first column, or behind `$$`
    /// after blanks; blanks may follow either.
    pub(crate) fn directive(&self, line: &str) -> Option<usize> {
        let bytes = line.as_bytes();
        let blank = |b: &u8| matches!(b, b' ' | b'\t');
        let first = bytes.iter().position(|b| !blank(b))?;
        let doubled = bytes[first] == self.dollar && bytes.get(first + 1) == Some(&self.dollar);
        let start = match doubled {
            true => first + 2,
            false if bytes[0] == self.dollar => 1,
            false => return None,
        };
        Some(start + bytes[start..].iter().take_while(|b| blank(b)).count())
    }

    /// If a line is a directive, its name and where that ends.
    pub(crate) fn directive_name<'a>(&self, line: &'a str) -> Option<(&'a str, usize)> {
        let start = self.directive(line)?;
        let end = start + word_len(&line[start..]);
        Some((&line[start..end], end))
    }

    /// `$onEolCom` and its kin, by the name behind `on` or `off`. True if it was one.
    pub(crate) fn switch(&mut self, what: &str, on: bool) -> bool {
        let mark = match what {
            "eolcom" => &mut self.eol_on,
            "inline" => &mut self.inline_on,
            "nestcom" => &mut self.nested,
            "delim" => &mut self.delimited,
            _ => return false,
        };
        *mark = on;
        true
    }

    /// `$eolCom //` and its kin; gives what stands behind the marks, None where they are missing.
    pub(crate) fn set<'t>(&mut self, directive: &str, rest: &'t str) -> Option<&'t str> {
        let mark = |text: &'t str| {
            let t = text.trim_start();
            t.split_at(t.find([' ', '\t']).unwrap_or(t.len()))
        };
        let (first, behind) = mark(rest);
        let single = match first.as_bytes() {
            [b] => Some(*b),
            _ => None,
        };
        match directive {
            "inlinecom" => {
                let (second, behind) = mark(behind);
                let pair = (!second.is_empty()).then(|| (first.into(), second.into()));
                (self.inline, self.inline_on) = (pair?, true);
                return Some(behind);
            }
            "eolcom" if !first.is_empty() => (self.eol, self.eol_on) = (first.into(), true),
            "comment" => self.comment = single?,
            "dollar" => self.dollar = single.filter(|b| !b.is_ascii_alphanumeric())?,
            _ => return None,
        }
        Some(behind)
    }

    /// The comments of a line from a byte on; `depth`: how many inline ones are open.
    pub(crate) fn comments(
        &self,
        bytes: &[u8],
        from: usize,
        directive: bool,
        depth: &mut usize,
    ) -> Comments {
        let mut found = Comments {
            pieces: Vec::new(),
            end: bytes.len(),
            opened: None,
        };
        let (mut start, mut i) = (from, from);
        while i < bytes.len() {
            if *depth > 0 {
                let find = |mark: &[u8]| memchr::memmem::find(&bytes[i..], mark);
                let close = find(&self.inline.1);
                let inner = find(&self.inline.0);
                let inner = inner.filter(|n| self.nested && close.is_none_or(|c| *n < c));
                match (inner, close) {
                    (Some(n), _) => {
                        *depth += 1;
                        i += n + self.inline.0.len();
                    }
                    (None, Some(n)) => {
                        *depth -= 1;
                        i += n + self.inline.1.len();
                    }
                    (None, None) => i = bytes.len(),
                }
                if *depth == 0 {
                    found.pieces.push((start, i));
                    found.opened = None;
                }
                continue;
            }
            let rest = &bytes[i..];
            if self.eol_on && rest.starts_with(&self.eol) || self.slashes && rest.starts_with(b"//")
            {
                found.end = i;
                return found;
            }
            if self.inline_on && rest.starts_with(&self.inline.0) {
                (start, found.opened, *depth) = (i, Some(i), 1);
                i += self.inline.0.len();
                continue;
            }
            i = past_text(bytes, i, directive);
        }
        if *depth > 0 {
            found.pieces.push((start, bytes.len()));
        }
        found
    }
}

/// Where to look for comments next. In quoted texts they are text, also directly behind a word (`i.tl'//'`, but not
/// `don't`); on lines of directives every quote begins a text, and one without its partner reaches to the end.
fn past_text(bytes: &[u8], i: usize, directive: bool) -> usize {
    let q = bytes[i];
    if q != b'\'' && q != b'"' {
        return i + 1;
    }
    let word = |at: Option<usize>| {
        let byte = at.and_then(|at| bytes.get(at));
        byte.is_some_and(u8::is_ascii_alphanumeric)
    };
    if !directive && word(i.checked_sub(1)) && word(Some(i + 1)) {
        return i + 1;
    }
    match memchr::memchr2(q, b'\n', &bytes[i + 1..]) {
        Some(n) if bytes[i + 1 + n] == q => i + n + 2,
        None if directive => bytes.len(),
        _ => i + 1,
    }
}
