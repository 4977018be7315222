//! Statements that are no declarations: words, numbers, operators, and the blocks of `loop`, `if` and figures.

use super::{Class, Frame, INNER_WORDS, Role, Scanner, Word, is_word_here, quoted_end, words};

impl Scanner<'_> {
    /// A word, number, quoted text or sign.
    pub(super) fn plain(&mut self, i: usize, word: Role) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        let (end, role) = if let Some(end) = quoted_end(bytes, i) {
            (end, Role::Quoted)
        } else if words::is_letter(b) || self.begins_with_percent(i) {
            (self.wordlike(i), word)
        } else if b.is_ascii_digit() {
            (number_end(bytes, i), Role::Number)
        } else {
            let end = i + self.code[i..].chars().next().map_or(1, char::len_utf8);
            (end, if b == b'.' { Role::Dot } else { Role::Operator })
        };
        self.push(i, end, role);
        end
    }

    /// `%name%` stands here.
    pub(super) fn begins_with_percent(&self, i: usize) -> bool {
        let bytes = self.code.as_bytes();
        let end = words::word_end(bytes, i + 1);
        bytes[i] == b'%' && end > i + 1 && bytes.get(end) == Some(&b'%')
    }

    /// The end of a name, `%names%` inside of it included.
    pub(super) fn wordlike(&self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        let mut end = i;
        loop {
            let next = words::word_end(bytes, end);
            if bytes.get(next) == Some(&b'%') {
                let name = words::word_end(bytes, next + 1);
                if name > next + 1 && bytes.get(name) == Some(&b'%') {
                    end = name + 1;
                    continue;
                }
            }
            return next.max(end).max(i + 1);
        }
    }

    pub(super) fn code(&mut self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        let blocky = self.frames.last().is_some_and(|f| f.block && !f.header);
        if self.expects && blocky && !matches!(b, b';' | b')' | b']' | b'}' | b',') {
            let word = self.code[i..words::word_end(bytes, i)].to_ascii_lowercase();
            if !matches!(
                word.as_str(),
                "else" | "elseif" | "until" | "endif" | "endloop" | "endwhile" | "endfor"
            ) {
                self.expects = false;
                let class = words::classify(self.code, i).0;
                self.begin(class);
                self.word = word;
            }
        }
        if words::is_letter(b) {
            return self.code_word(i);
        }
        let end = match b {
            b'\'' | b'"' => match memchr::memchr2(b, b'\n', &bytes[i + 1..]) {
                Some(n) if bytes[i + 1 + n] == b => {
                    self.push(i, i + n + 2, Role::Quoted);
                    i + n + 2
                }
                _ => {
                    // Half-typed: to the end of the line.
                    let end = i + self.code[i..self.line_end(i)].trim_end().len();
                    self.push(i, end, Role::Quoted);
                    end
                }
            },
            b'0'..=b'9' => self.plain(i, Role::Name),
            b'.' if bytes.get(i + 1).is_some_and(u8::is_ascii_digit) && !self.behind_word(i) => {
                let end = number_end(bytes, i);
                self.push(i, end, Role::Number);
                end
            }
            b'%' => self.plain(i, Role::Name),
            b'(' | b'[' | b'{' => self.opening(i),
            b')' | b']' | b'}' => {
                if self.frames.last().is_some_and(|f| f.block) {
                    self.end_inner();
                }
                self.frames.pop();
                self.expects = false;
                self.push(i, i + 1, Role::Close);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                if let Some(f) = self.frames.last_mut().filter(|f| f.block && f.header) {
                    f.header = false;
                    self.expects = true;
                }
                i + 1
            }
            b';' => self.semicolon(i),
            b'.' if bytes.get(i + 1) == Some(&b'.') => {
                self.defines();
                self.push(i, i + 2, Role::Operator);
                i + 2
            }
            b'.' => {
                self.push(i, i + 1, Role::Dot);
                i + 1
            }
            _ => {
                let end = operator_end(self.code, i);
                self.push(i, end, Role::Operator);
                end
            }
        };
        self.control = false;
        end
    }

    /// A parenthesis, a bracket or a brace opens; where code goes on behind it.
    fn opening(&mut self, i: usize) -> usize {
        let figure =
            self.code.as_bytes()[i] == b'{' && self.frames.is_empty() && self.word == "figure";
        let block = self.control || figure;
        let header = block && !figure && self.word_before(i) != "repeat";
        let token = self.push(i, i + 1, Role::Open);
        self.frames.push(Frame {
            token,
            block,
            header,
            by_word: false,
            outside: self.open.len(),
        });
        self.expects = block && !header;
        self.control = false;
        i + 1
    }

    /// A statement ends; where code goes on behind it.
    fn semicolon(&mut self, i: usize) -> usize {
        self.push(i, i + 1, Role::Semicolon);
        let block = self.frames.iter().rposition(|f| f.block);
        let unclosed = self.frames.len() > block.map_or(0, |n| n + 1);
        self.frames.truncate(block.map_or(0, |n| n + 1));
        if block.is_none() {
            self.end(!unclosed);
        } else {
            self.end_inner();
            self.expects = true;
        }
        i + 1
    }

    /// Whether a word has a meaning in this statement only. Behind one of them a name stands: `min minz`.
    pub(super) fn is_word_here(&self, word: &str, at: usize) -> bool {
        let last = self.word_before(at);
        is_word_here(word, &self.word)
            && !(self.word == "solve" && (last == "solve" || is_word_here(&last, "solve")))
    }

    pub(super) fn in_figure(&self) -> bool {
        let outermost = self.open.first().map(|s| self.scan.statements[*s].first);
        let token = outermost.and_then(|t| self.scan.tokens.get(t));
        token.is_some_and(|t| self.code[t.lo..t.hi].eq_ignore_ascii_case("figure"))
    }

    /// The name at the beginning of the statement is an equation that is defined.
    pub(super) fn defines(&mut self) {
        if let Some(&s) = self.open.last() {
            let first = self.scan.statements[s].first;
            if let Some(t) = self
                .scan
                .tokens
                .get_mut(first)
                .filter(|t| t.role == Role::Name)
            {
                t.role = Role::Defined;
                self.scan.statements[s].class = Class::Equation;
            }
        }
    }

    pub(super) fn behind_word(&self, i: usize) -> bool {
        let last = self.scan.tokens.last();
        last.is_some_and(|t| t.hi == i && matches!(t.role, Role::Name | Role::Close | Role::Number))
    }

    pub(super) fn word_before(&self, i: usize) -> String {
        let last = self.scan.tokens.last().filter(|t| t.hi <= i);
        last.map_or(String::new(), |t| {
            self.code[t.lo..t.hi].to_ascii_lowercase()
        })
    }

    pub(super) fn code_word(&mut self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        let end = words::word_end(bytes, i);
        let after_dot = self
            .scan
            .tokens
            .last()
            .is_some_and(|t| t.role == Role::Dot && t.hi == i);
        let first = self
            .open
            .last()
            .is_some_and(|s| self.scan.statements[*s].first == self.scan.tokens.len());
        let lower = self.code[i..end].to_ascii_lowercase();
        let statement = if after_dot {
            None
        } else {
            words::statement_word(self.code, i, end)
        };
        if let Some(word) = statement {
            let outermost = self.frames.is_empty();
            if !first && (outermost && !word.inside_blocks_only() || word == Word::Declaration) {
                // A `;` or a parenthesis is missing.
                let whole = self.frames.is_empty();
                self.end(whole);
                return i;
            }
        }
        let wordlike = self.wordlike(i);
        if wordlike > end {
            self.push(i, wordlike, Role::Name);
            return wordlike;
        }
        let inner =
            !after_dot && (INNER_WORDS.contains(&lower.as_str()) || self.is_word_here(&lower, i));
        let begins = !after_dot
            && first
            && (statement.is_some() || words::classify(self.code, i).0 == Class::Other);
        let keyword = statement.is_some() || inner || begins;
        if keyword {
            self.block_word(&lower);
        }
        let key = self.word == "figure" || self.in_figure();
        let behind = self.code[end..].trim_start();
        let role = match () {
            () if keyword => Role::Keyword,
            // The kind of an element, and what is given of it.
            () if key
                && !self.frames.is_empty()
                && (first || self.frames.len() == 1 && behind.starts_with('=')) =>
            {
                Role::Attribute
            }
            () if after_dot => Role::Attribute,
            () => Role::Name,
        };
        let token = self.push(i, end, role);
        if keyword {
            self.after_block_word(&lower, token, end);
        }
        end
    }

    /// Before `else`, `until`, `endloop`: what is inside ends.
    pub(super) fn block_word(&mut self, word: &str) {
        match word {
            "else" | "elseif" => {
                self.end_inner();
                if let Some(f) = self.frames.iter_mut().rev().find(|f| f.block) {
                    f.header = word == "elseif" && !f.by_word;
                }
                self.expects = word == "else";
            }
            "until" => {
                self.end_inner();
                match self.frames.last_mut() {
                    Some(f) if f.by_word => {
                        self.frames.pop();
                    }
                    Some(f) => f.header = true,
                    None => {}
                }
                self.expects = false;
            }
            "endif" | "endloop" | "endwhile" | "endfor" => {
                self.end_inner();
                if let Some(n) = self.frames.iter().rposition(|f| f.by_word) {
                    self.frames.truncate(n);
                }
                self.expects = false;
            }
            _ => {}
        }
    }

    pub(super) fn after_block_word(&mut self, word: &str, token: usize, end: usize) {
        let by_word = |s: &mut Self, header| {
            let outside = s.open.len();
            s.frames.push(Frame {
                token,
                block: true,
                header,
                by_word: true,
                outside,
            });
            s.expects = true;
        };
        match word {
            "loop" | "while" | "for" | "if" | "repeat" => {
                let opens = matches!(
                    self.code[end..].trim_start().as_bytes().first(),
                    Some(b'(' | b'[' | b'{')
                );
                self.control = opens;
                if word == "repeat" && !opens {
                    by_word(self, false);
                }
            }
            "then" | "do" => {
                // Behind `elseif c` the block is open already.
                match self.frames.last() {
                    Some(f) if f.by_word => self.expects = true,
                    _ => by_word(self, false),
                }
            }
            _ => self.control = false,
        }
    }
}

/// The end of a number that begins at `i`: `12`, `1.5e-3`, not the points of `1..`.
fn number_end(bytes: &[u8], i: usize) -> usize {
    let digits = |mut n: usize| {
        while bytes.get(n).is_some_and(u8::is_ascii_digit) {
            n += 1;
        }
        n
    };
    let mut end = digits(i);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1) != Some(&b'.') {
        end = digits(end + 1);
    }
    if bytes
        .get(end)
        .is_some_and(|b| b.eq_ignore_ascii_case(&b'e'))
    {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let to = digits(end + 1 + sign);
        if to > end + 1 + sign {
            end = to;
        }
    }
    words::word_end(bytes, end).max(i + 1)
}

/// The end of the operator at `i`.
fn operator_end(code: &str, i: usize) -> usize {
    let rest = &code[i..];
    let bytes = rest.as_bytes();
    if bytes.len() > 2 && bytes[0] == b'=' && bytes[1].is_ascii_alphabetic() && bytes[2] == b'=' {
        return i + 3;
    }
    for sign in ["<=>", "<=", ">=", "<>", "->", "**", "++", "--", ":=", "$="] {
        if rest.starts_with(sign) {
            return i + sign.len();
        }
    }
    i + rest.chars().next().map_or(1, char::len_utf8)
}
