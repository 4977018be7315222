//! Blanks between two words of a line.

use super::{Inside, Layout};
use crate::check::functions;
use crate::editor::scan::{Role, Statement, Token};
use crate::syntax::words::Class;

impl Layout<'_> {
    /// What stands in the parentheses that this token opens.
    pub(super) fn opens(&self, token: usize, within: Inside) -> Inside {
        let tokens = &self.scan.tokens;
        let Some(before) = token.checked_sub(1) else {
            return Inside::Parts;
        };
        let function =
            |name: &str| functions::callee(name).is_some() && !self.declared.contains(name);
        let indices = match tokens[before].role {
            _ if within == Inside::Indices || tokens[token].data => true,
            Role::Declared | Role::Defined => true,
            Role::Keyword => matches!(
                self.word(before).to_ascii_lowercase().as_str(),
                "alias" | "aliases"
            ),
            Role::Name | Role::Attribute => {
                if function(&self.word(before).to_ascii_lowercase()) {
                    // `mod(ord(i),2)`, but `max(a, b + c)`.
                    return match self.holds(token, &["*", "/", "**"], true) {
                        true => Inside::Arguments,
                        false => Inside::Parts,
                    };
                }
                self.holds(token, &["+", "-", "++", "--", "*"], false)
            }
            // `((i,j), …)`
            Role::Open | Role::Comma | Role::Slash => self.holds(token, &["|"], false),
            _ => false,
        };
        if indices {
            Inside::Indices
        } else {
            Inside::Parts
        }
    }

    /// Whether nothing but names, labels and whole numbers stands in these parentheses, and these operators; `signs`: and any
    /// numbers with their signs.
    pub(super) fn holds(&self, open: usize, operators: &[&str], signs: bool) -> bool {
        let tokens = &self.scan.tokens;
        let mut depth = 0usize;
        for (n, t) in tokens.iter().enumerate().skip(open) {
            match t.role {
                Role::Open => depth += 1,
                Role::Close => {
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        return true;
                    }
                }
                Role::Name | Role::Attribute
                    if self.word(n).contains('%')
                        && !self.word(n).starts_with(|c: char| c.is_ascii_alphabetic()) =>
                {
                    return false;
                }
                Role::Comma
                | Role::Name
                | Role::Attribute
                | Role::Label
                | Role::Quoted
                | Role::Dot => {}
                Role::Number if signs || !self.word(n).contains('.') => {}
                // A factor is no index; `*` alone is any label.
                Role::Operator
                    if self.word(n) == "*"
                        && !signs
                        && !matches!(tokens[n - 1].role, Role::Open | Role::Comma) =>
                {
                    return false;
                }
                Role::Operator if operators.contains(&self.word(n)) => {}
                Role::Operator if signs && matches!(self.word(n), "-" | "+") && !self.spaced(n) => {
                }
                _ => return false,
            }
        }
        false
    }

    /// Blanks between two neighbours on a line.
    pub(super) fn gap(&self, a: usize, b: usize) -> usize {
        use Role as R;
        let tokens = &self.scan.tokens;
        let (x, y) = (&tokens[a], &tokens[b]);
        let was = usize::from(y.lo > x.hi);
        let statement: Option<&Statement> = self.scan.statements.get(self.around[b]);
        let indices = self.inside[b] == Inside::Indices;
        let wordy = |r: Role| {
            matches!(
                r,
                R::Name
                    | R::Attribute
                    | R::Keyword
                    | R::Number
                    | R::Quoted
                    | R::Declared
                    | R::Defined
                    | R::Text
                    | R::Label
            )
        };
        // What a substitution leaves is not known; a text that touches the word before it may be a slip.
        let percent = |t: &Token| t.role == R::Operator && &self.text[t.lo..t.hi] == "%";
        let slip = y.role == R::Text && !matches!(x.role, R::Slash | R::Comma);
        if percent(x) || percent(y) || slip {
            return was;
        }
        if y.role == R::Comment {
            return 2;
        }
        if x.role == R::Semicolon {
            let least = usize::from(y.role != R::Close);
            return (y.lo - x.hi).clamp(least, 3);
        }
        if matches!(y.role, R::Semicolon) {
            return 0;
        }
        if x.role == R::Slash || y.role == R::Slash {
            return match (x.role, y.role) {
                (R::Slash, R::Comma) => 0,
                _ => 1,
            };
        }
        if y.data || x.data {
            return match (x.role, y.role) {
                (R::Comma, _) if !indices => 1,
                (_, R::Comma) | (R::Comma, _) => 0,
                _ => was,
            };
        }
        let put = statement.is_some_and(|s| {
            s.class == Class::Other && self.word(s.first).to_ascii_lowercase().starts_with("put")
        });
        if put && self.inside[b] == Inside::Nothing {
            return was;
        }
        match (x.role, y.role) {
            // `{ points(i) }`
            (R::Open, _) if self.word(a) == "{" => was,
            (_, R::Close) if self.word(b) == "}" => was,
            (R::Open, _) | (_, R::Close) | (_, R::Comma) | (R::Dot, _) | (_, R::Dot) => 0,
            (R::Comma, _) if self.inside[b] == Inside::Arguments => was,
            (R::Comma, _) => usize::from(!indices),
            (R::Operator, R::Operator) => match (self.word(a), self.word(b)) {
                (_, "$") | ("$", _) => 0,
                ("..", _) => 2,
                _ => was.max(usize::from(self.spaced(a) && !indices)),
            },
            (R::Keyword, R::Operator) if matches!(self.word(b), "+" | "-") => 1,
            (_, R::Operator) => usize::from(self.spaced(b) && !indices),
            (R::Operator, _) => match self.word(a) {
                ".." => 2,
                _ => usize::from(self.spaced(a) && !indices),
            },
            (R::Keyword, R::Open) => match self.word(a).to_ascii_lowercase().as_str() {
                "and" | "or" | "xor" | "imp" | "eqv" | "eq" | "ne" | "lt" | "le" | "gt" | "ge"
                | "to" | "downto" | "by" | "until" => 1,
                "not" | "display" | "solve" | "option" | "else" | "then" | "do" => was,
                "alias" | "aliases" => 1,
                _ => 0,
            },
            (_, R::Open) if self.word(b) == "{" => was,
            (R::Name | R::Attribute | R::Declared | R::Defined, R::Open) => 0,
            (R::Close, R::Open) => was,
            (p, q) if wordy(p) && wordy(q) => was,
            (R::Close, q) if wordy(q) => 1,
            (p, R::Open) if wordy(p) => was,
            _ => was,
        }
    }

    /// Whether an operator has blanks on both sides: not `*`, `/`, `**`, `$`, and no sign before a number.
    pub(super) fn spaced(&self, token: usize) -> bool {
        let word = self.word(token);
        match word {
            "*" | "/" | "**" | "$" | ".." | ":" | "%" | "#" | "@" | "&" | "\\" => false,
            "+" | "-" => {
                let before = token.checked_sub(1).map(|b| self.scan.tokens[b].role);
                matches!(
                    before,
                    Some(
                        Role::Name
                            | Role::Attribute
                            | Role::Number
                            | Role::Close
                            | Role::Quoted
                            | Role::Label
                    )
                )
            }
            "++" | "--" => false,
            _ => word.is_ascii(),
        }
    }

    /// Whether a sign stands before a word, and no operand before that.
    pub(super) fn is_signed(&self, token: usize) -> bool {
        let before = token - 1;
        self.scan.tokens[before].role == Role::Operator
            && matches!(self.word(before), "-" | "+")
            && !self.spaced(before)
    }
}
