//! Declarations: names, domains, texts, data between slashes, lists of models, the lines of tables.

use super::{Class, Phase, Role, Scanner, quoted_end, words};

/// What separates; other blanks of Unicode are part of a text.
const BLANKS: [char; 3] = [' ', '\t', '\r'];

impl Scanner<'_> {
    pub(super) fn declaration(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        if self.new_line && matches!(self.phase, Phase::AfterName) {
            self.phase = Phase::AfterText;
        }
        if self.phase == Phase::Domain {
            return self.domain(i);
        }
        match b {
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                self.end(true);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                self.phase = Phase::Name;
                i + 1
            }
            b'/' if self.class != Class::Acronym => {
                self.push(i, i + 1, Role::Slash);
                self.phase = Phase::Body;
                self.record = true;
                self.depth = 0;
                i + 1
            }
            b'(' | b'[' | b'{' if self.phase != Phase::Name => {
                self.push(i, i + 1, Role::Open);
                self.phase = Phase::Domain;
                i + 1
            }
            b'\'' | b'"' => match memchr::memchr2(b, b'\n', &bytes[i + 1..]) {
                Some(n) if bytes[i + 1 + n] == b => {
                    let end = i + n + 2;
                    self.push(i, end, Role::Quoted);
                    self.phase = Phase::AfterText;
                    end
                }
                _ => {
                    self.push(i, hi, Role::Text);
                    hi
                }
            },
            _ if self.phase == Phase::AfterName
                && !matches!(b, b'=' | b'$' | b':' | b'.' | b'<') =>
            {
                let data = if self.class == Class::Table {
                    b','
                } else {
                    b'/'
                };
                let end = memchr::memchr3(b',', data, b';', &bytes[i..hi]).map_or(hi, |n| i + n);
                let end = i + self.code[i..end].trim_end_matches(BLANKS).len();
                self.push(i, end.max(i + 1), Role::Text);
                self.phase = Phase::AfterText;
                end.max(i + 1)
            }
            _ if words::is_letter(b) || self.begins_with_percent(i) => {
                let end = self.wordlike(i);
                if words::statement_word(self.code, i, end).is_some() {
                    self.end(true);
                    return i;
                }
                // `e..` or `x = 5` where a `;` is missing: the next statement.
                let rest = self.code[end..hi].trim_start();
                if self.new_line
                    && self.names > 0
                    && (rest.starts_with("..") || rest.starts_with('='))
                {
                    self.end(false);
                    return i;
                }
                let role = match self.class {
                    Class::Alias => Role::Name,
                    _ => Role::Declared,
                };
                self.push(i, end, role);
                self.names += 1;
                self.phase = Phase::AfterName;
                end
            }
            _ => {
                let end = i + self.code[i..].chars().next().map_or(1, char::len_utf8);
                let role = match b {
                    b')' | b']' | b'}' => Role::Close,
                    _ => Role::Operator,
                };
                self.push(i, end, role);
                end
            }
        }
    }

    pub(super) fn domain(&mut self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        match bytes[i] {
            b')' | b']' | b'}' => {
                self.push(i, i + 1, Role::Close);
                self.phase = Phase::AfterName;
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                i + 1
            }
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                self.end(false);
                i + 1
            }
            _ => self.plain(i, Role::Name),
        }
    }

    /// Inside `/ … /`.
    pub(super) fn body(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        let set = self.class == Class::Set;
        if self.class == Class::Model {
            return self.model_list(i);
        }
        match b {
            b'/' => {
                let na = i > 0
                    && bytes[i - 1].eq_ignore_ascii_case(&b'n')
                    && bytes
                        .get(i + 1)
                        .is_some_and(|b| b.eq_ignore_ascii_case(&b'a'));
                let role = if na { Role::Operator } else { Role::Slash };
                let n = self.push(i, i + 1, role);
                if !na {
                    self.scan.tokens[n].data = false;
                    self.phase = Phase::AfterText;
                }
                i + 1
            }
            b';' if !set
                || self.code[i + 1..].trim_start().get(..3).is_none_or(|_| {
                    let rest = self.code[i + 1..].trim_start();
                    let at = self.code.len() - rest.len();
                    words::statement_word(self.code, at, words::word_end(bytes, at)).is_some()
                }) =>
            {
                // The slash was forgotten.
                self.push(i, i + 1, Role::Semicolon);
                self.end(false);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                self.record |= self.depth == 0;
                i + 1
            }
            b'(' => {
                self.depth += 1;
                self.push(i, i + 1, Role::Open);
                i + 1
            }
            b')' => {
                self.depth = self.depth.saturating_sub(1);
                self.push(i, i + 1, Role::Close);
                i + 1
            }
            b'.' if self.record => {
                self.push(i, i + 1, Role::Dot);
                i + 1
            }
            b'*' | b':' | b'=' => {
                self.push(i, i + 1, Role::Operator);
                i + 1
            }
            b'[' | b'{' if !set => {
                let end = memchr::memchr2(b']', b'}', &bytes[i..hi]).map_or(hi, |n| i + n + 1);
                self.push(i, end, Role::Number);
                end
            }
            _ => self.datum(i, hi),
        }
    }

    /// A label, a number or a text in data.
    pub(super) fn datum(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        if let Some(end) = quoted_end(bytes, i) {
            self.push(i, end, Role::Quoted);
            self.record = self.record && self.joins(end);
            return end;
        }
        if self.class == Class::File {
            let end = memchr::memchr(b'/', &bytes[i..hi]).map_or(hi, |n| i + n);
            let end = i + self.code[i..end].trim_end_matches(BLANKS).len().max(1);
            self.push(i, end, Role::Text);
            return end;
        }
        if self.class == Class::Set && !self.record {
            // An element's text runs to the comma.
            let end = memchr::memchr3(b',', b'/', b';', &bytes[i..hi]).map_or(hi, |n| i + n);
            let end = i + self.code[i..end].trim_end_matches(BLANKS).len().max(1);
            self.push(i, end, Role::Text);
            return end;
        }
        let mut end = i;
        while end < hi
            && !words::is_blank(bytes[end])
            && !matches!(bytes[end], b',' | b'/' | b';' | b'(' | b')' | b':' | b'=')
        {
            let b = bytes[end];
            if end > i && b == b'*'
                || b == b'.'
                    && self.record
                    && !self.code[i..end].bytes().all(|b| b.is_ascii_digit())
            {
                break;
            }
            end += self.code[end..].chars().next().map_or(1, char::len_utf8);
        }
        let end = end.max(i + 1);
        let number = !self.record && self.class.has_values();
        self.push(i, end, if number { Role::Number } else { Role::Label });
        self.record = self.record && (self.depth > 0 || self.joins(end));
        end
    }

    /// Whether a label goes on behind `at`: `a.b`, `a*b`, `a:b`.
    pub(super) fn joins(&self, at: usize) -> bool {
        matches!(
            self.code[at..]
                .trim_start_matches([' ', '\t'])
                .as_bytes()
                .first(),
            Some(b'.' | b'*' | b':')
        )
    }

    pub(super) fn model_list(&mut self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        match bytes[i] {
            b'/' => {
                let n = self.push(i, i + 1, Role::Slash);
                self.scan.tokens[n].data = false;
                self.phase = Phase::AfterText;
                i + 1
            }
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                self.end(false);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                i + 1
            }
            b'(' | b')' => {
                self.push(
                    i,
                    i + 1,
                    if bytes[i] == b'(' {
                        Role::Open
                    } else {
                        Role::Close
                    },
                );
                i + 1
            }
            _ => {
                let end = words::word_end(bytes, i);
                if end > i && words::statement_word(self.code, i, end).is_some() && self.new_line {
                    // The slash was forgotten.
                    self.end(false);
                    return i;
                }
                let all = self.code[i..end].eq_ignore_ascii_case("all");
                let end = self.plain(i, if all { Role::Keyword } else { Role::Name });
                let last = self.scan.tokens.len() - 1;
                self.scan.tokens[last].data = false;
                end
            }
        }
    }

    /// The lines of a table.
    pub(super) fn table(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let end = words::word_end(bytes, i);
        if self.new_line && words::begins_statement_in_table(self.code, i, end) {
            self.end(true);
            return i;
        }
        match bytes[i] {
            b';' => {
                self.phase = Phase::Start;
                self.push(i, i + 1, Role::Semicolon);
                let last = self.scan.tokens.len() - 1;
                self.scan.tokens[last].table = true;
                self.end(true);
                i + 1
            }
            b'.' | b'(' | b')' | b',' | b'+' | b'*' | b':'
                if !bytes.get(i + 1).is_some_and(u8::is_ascii_digit) || bytes[i] != b'.' =>
            {
                self.push(i, i + 1, Role::Operator);
                i + 1
            }
            _ => {
                if let Some(end) = quoted_end(bytes, i) {
                    self.push(i, end, Role::Quoted);
                    return end;
                }
                let stops = |b: u8| words::is_blank(b) || matches!(b, b';' | b'(' | b')' | b',');
                let end = (i..hi).find(|n| stops(bytes[*n])).unwrap_or(hi).max(i + 1);
                let word = &self.code[i..end];
                let number = word.parse::<f64>().is_ok();
                self.push(i, end, if number { Role::Number } else { Role::Label });
                end
            }
        }
    }
}
