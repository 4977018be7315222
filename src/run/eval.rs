//! Values of expressions.

use super::Machine;
use super::arithmetic::{self, ArithmeticError};
use super::plan::Wanted;
use super::random;
use super::support::SAME;
use crate::autodiff::functions::{self, function_value};
use crate::check::calendar;
use crate::check::node::*;
use crate::check::symbols::{SymbolKind, attribute};
use crate::data::universe::Label;
use crate::data::value::{self, EPS, NA, UNDF, is_eps, is_na, is_undf, number, truth};
use crate::diag::Diagnostic;
use crate::model::instance::Function;
use crate::report::textfile::Item;
use crate::source::Span;
use rustc_hash::FxHashSet;

/// Labels in the slots.
pub type Frame = Vec<Label>;

impl Machine<'_> {
    /// The label a part stands for; None for a lag that leaves its set.
    #[inline]
    pub(super) fn part(&self, p: &Part, frame: &mut Frame) -> Option<Label> {
        match p {
            Part::Slot(s) => Some(frame[*s as usize]),
            Part::Label(l) => Some(*l),
            Part::Lag(lag) => self.lag(lag, frame),
            Part::Singleton(t, p) => {
                let t = self.store.table(*t);
                (!t.is_empty() && t.is_tidy()).then(|| t.key(0)[*p as usize])
            }
        }
    }

    fn lag(&self, lag: &Lag, frame: &mut Frame) -> Option<Label> {
        let base = self.part(&lag.base, frame)?;
        self.shift(lag, base, 1, frame)
    }

    /// The label whose part is this one: the way back through a lag.
    pub(super) fn unlag(&self, p: &Part, label: Label, frame: &mut Frame) -> Option<Label> {
        match p {
            Part::Lag(lag) => self.shift(lag, label, -1, frame),
            _ => Some(label),
        }
    }

    /// The label that stands `times` offsets after another in the set of a lag.
    fn shift(&self, lag: &Lag, from: Label, times: i64, frame: &mut Frame) -> Option<Label> {
        let offset = number(self.eval(&lag.offset, frame));
        if offset.is_nan() {
            self.execution_error(
                "E0403",
                lag.offset.span,
                "a lag by what is not available or undefined leads nowhere".into(),
                "give it a value before, or guard the statement with a condition",
            );
        }
        if !offset.is_finite() {
            return None;
        }
        let offset = times * offset.round().clamp(-1e15, 1e15) as i64;
        let set = self.store.table(lag.set);
        let at = i64::from(set.find(&[from])?);
        let n = set.len() as i64;
        let to = match lag.circular {
            true => (at + offset).rem_euclid(n.max(1)),
            false => at + offset,
        };
        (0..n).contains(&to).then(|| set.key(to as u32)[0])
    }

    /// Fills the labels of a key; false if a lag leaves its set.
    #[inline]
    pub(super) fn key(&self, key: &Key, frame: &mut Frame, out: &mut [Label; 20]) -> bool {
        for (k, p) in key.parts.iter().enumerate() {
            match self.part(p, frame) {
                Some(l) => out[k] = l,
                None => return false,
            }
        }
        true
    }

    /// The value of a record.
    #[inline]
    fn data(&self, table: TableId, key: &Key, frame: &mut Frame) -> f64 {
        let t = self.store.table(table);
        match key.parts.as_slice() {
            [] => t.get(&[]),
            [Part::Slot(s)] => t.get(&[frame[*s as usize]]),
            [Part::Slot(a), Part::Slot(b)] => t.get(&[frame[*a as usize], frame[*b as usize]]),
            parts => {
                let mut k = [0; 20];
                match self.key(key, frame, &mut k) {
                    true => t.get(&k[..parts.len()]),
                    false => t.default_value(),
                }
            }
        }
    }

    pub(super) fn is_member(&self, table: TableId, key: &Key, frame: &mut Frame) -> bool {
        let mut k = [0; 20];
        self.key(key, frame, &mut k)
            && match table {
                SAME => k[0] == k[1],
                _ => {
                    let table = self.store.table(table);
                    table.find(&k[..key.parts.len()]).is_some()
                }
            }
    }

    fn arithmetic(&self, r: Result<f64, ArithmeticError>, span: Span) -> f64 {
        let (code, message, help) = match r {
            Ok(x) => return x,
            Err(ArithmeticError::DivisionByZero) => (
                "E0401",
                "division by zero",
                "guard it with a condition, `a / b $ b` or `(a/b)$b`",
            ),
            Err(ArithmeticError::Indefinite) => (
                "E0402",
                "infinity times zero has no value",
                "replace the infinite number, or guard the product with a condition",
            ),
            Err(ArithmeticError::Overflow) => {
                let message = "the result is too large for a number";
                ("E0404", message, "rescale the data")
            }
        };
        self.execution_error(code, span, message.into(), help)
    }

    /// A value to compute with: an acronym is none.
    #[inline]
    fn no_acronym(&self, v: f64, span: Span) -> f64 {
        if v.is_nan() && value::as_acronym(v).is_some() {
            return self.execution_error(
                "E0408",
                span,
                "an acronym stands where a number is computed with".into(),
                "acronyms can be assigned and compared with `=` and `<>`",
            );
        }
        v
    }

    /// Reports an execution error; the value is `undf`.
    pub(super) fn execution_error(
        &self,
        code: &'static str,
        span: Span,
        message: String,
        help: &str,
    ) -> f64 {
        let message = match self.current_record() {
            at if at.is_empty() => message,
            at => format!("{message} ({at})"),
        };
        Diagnostic::execution(code, span)
            .says(message)
            .label("here")
            .help(help)
            .note(self);
        UNDF
    }

    /// Whether conditions hold together: `na and 0` is `na`, which counts as true.
    pub(super) fn all_hold<'n>(
        &self,
        conditions: impl IntoIterator<Item = &'n Node>,
        frame: &mut Frame,
    ) -> bool {
        let mut all = 1.0;
        for c in conditions {
            all = arithmetic::relate(BinaryOp::And, all, self.eval(c, frame));
        }
        truth(all)
    }

    /// The value of an expression without unknowns.
    pub(super) fn eval(&self, n: &Node, frame: &mut Frame) -> f64 {
        match &n.kind {
            NodeKind::Const(x) => *x,
            NodeKind::Data(t, key) => self.data(*t, key, frame),
            NodeKind::Sum(terms) => {
                let mut acc = 0.0;
                for (k, (minus, t)) in terms.iter().enumerate() {
                    let v = self.no_acronym(self.eval(t, frame), t.span);
                    let v = if *minus { arithmetic::negate(v) } else { v };
                    acc = if k == 0 { v } else { arithmetic::add(acc, v) };
                }
                acc
            }
            NodeKind::Product(factors) => {
                let mut acc = 1.0;
                for (k, (divide, f)) in factors.iter().enumerate() {
                    if let Some(b) = f.kind.reciprocal_of() {
                        let v = self.no_acronym(self.eval(b, frame), b.span);
                        let r = arithmetic::divide_by_scalar(if k == 0 { 1.0 } else { acc }, v);
                        acc = self.arithmetic(r, b.span);
                        continue;
                    }
                    let v = self.no_acronym(self.eval(f, frame), f.span);
                    acc = match (k, divide) {
                        (0, false) => v,
                        (_, true) => self.arithmetic(arithmetic::divide(acc, v), f.span),
                        (_, false) => self.arithmetic(arithmetic::multiply(acc, v), n.span),
                    };
                }
                acc
            }
            NodeKind::Not(a) => arithmetic::not(self.eval(a, frame)),
            NodeKind::Binary(BinaryOp::Power, a, b) => {
                let (a, b) = (self.eval(a, frame), self.eval(b, frame));
                if a.is_normal() && a > 0.0 && b.is_finite() && self.options.gams_power() {
                    return (b * a.ln()).exp().min(functions::HUGE);
                }
                self.call(Function::RPower, &[a, b], n.span)
            }
            NodeKind::Binary(
                op @ (BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge),
                a,
                b,
            ) => {
                let x = self.no_acronym(self.eval(a, frame), a.span);
                arithmetic::relate(*op, x, self.no_acronym(self.eval(b, frame), b.span))
            }
            NodeKind::Binary(op, a, b) => {
                let (a, b) = (self.eval(a, frame), self.eval(b, frame));
                arithmetic::relate(*op, a, b)
            }
            NodeKind::Dollar(a, c) => {
                if truth(self.eval(c, frame)) {
                    self.eval(a, frame)
                } else {
                    0.0
                }
            }
            NodeKind::Aggregate(op, d, body) => self.aggregate(*op, d, body, frame),
            NodeKind::Call(f, args) => {
                let mut buffer = [0.0; 4];
                if args.len() <= 4 {
                    for (b, a) in buffer.iter_mut().zip(args) {
                        *b = self.eval(a, frame);
                    }
                    self.call(*f, &buffer[..args.len()], n.span)
                } else {
                    let values: Vec<f64> = args.iter().map(|a| self.eval(a, frame)).collect();
                    self.call(*f, &values, n.span)
                }
            }
            NodeKind::DataCall(f, args) => {
                let values: Vec<f64> = args.iter().map(|a| self.eval(a, frame)).collect();
                self.data_call(*f, &values, n.span)
            }
            NodeKind::Ord(set, p) => match self.part(p, frame) {
                Some(l) => self
                    .store
                    .table(*set)
                    .find(&[l])
                    .map_or(0.0, |r| f64::from(r) + 1.0),
                None => 0.0,
            },
            NodeKind::Card(t) => self.count(*t) as f64,
            NodeKind::SameAs(a, b) => {
                let (a, b) = (self.part(a, frame), self.part(b, frame));
                f64::from(u8::from(a.is_some() && a == b))
            }
            NodeKind::LabelAttribute(which, set, p) => {
                self.label_attribute(*which, *set, p, frame, n.span)
            }
            NodeKind::Derived(d, s, key) => self.derived(*d, *s, key, frame),
            NodeKind::ObjectAttribute(s, a) => self.object_attribute(*s, a),
            NodeKind::Var(s, key) => {
                // Only where a level is asked for although unknowns stand there (start points).
                let t = self.symbols.get(*s).table;
                self.data(t + attribute::L, key, frame)
            }
            NodeKind::OfText(text, at) => {
                let text = match (&text.kind, self.put_item(text, frame)) {
                    // `put` writes the label where an element has no text.
                    (NodeKind::ElementText(t, key), _) => {
                        let mut k = [0; 20];
                        let there = self.key(key, frame, &mut k);
                        let text = self.store.element_text(*t, &k[..key.parts.len()]);
                        text.filter(|_| there).unwrap_or_default().to_string()
                    }
                    (_, Some(Item::Text(t) | Item::Label(t))) => t,
                    _ => String::new(),
                };
                match at {
                    None => text.chars().count() as f64,
                    Some(n) => {
                        let position = self.eval(n, frame);
                        let most = text.chars().count() + 1;
                        match self.whole(position, "the position in a text", [1, most], n.span) {
                            Some(n) => text.chars().nth(n - 1).map_or(0.0, |c| f64::from(c as u32)),
                            None => UNDF,
                        }
                    }
                }
            }
            NodeKind::Text(_)
            | NodeKind::LabelText(_)
            | NodeKind::ElementText(..)
            | NodeKind::SymbolText(_)
            | NodeKind::RecordName(..) => 0.0,
        }
    }

    fn aggregate(&self, op: AggregateOp, d: &Domain, body: &Node, frame: &mut Frame) -> f64 {
        let zero_matters = !matches!(op, AggregateOp::Sum | AggregateOp::Sor);
        let plan = self.plan(d, Wanted::nonzero((!zero_matters).then_some(body)));
        let mut acc = op.of_nothing();
        self.run_plan(d, &plan, frame, &mut |frame| {
            let v = self.eval(body, frame);
            match op {
                AggregateOp::Sum => acc = arithmetic::add(acc, v),
                AggregateOp::Prod => acc = self.arithmetic(arithmetic::multiply(acc, v), body.span),
                AggregateOp::Smin => acc = extreme(acc, v, |a, b| a < b),
                AggregateOp::Smax => acc = extreme(acc, v, |a, b| a > b),
                // To the end, as in GAMS: `na` anywhere makes it `na`.
                AggregateOp::Sand => acc = arithmetic::relate(BinaryOp::And, acc, v),
                AggregateOp::Sor => acc = arithmetic::relate(BinaryOp::Or, acc, v),
            }
            self.keep_going()
        });
        acc
    }

    /// A mathematical function of values, with the special values' rules.
    pub(super) fn call(&self, f: Function, args: &[f64], span: Span) -> f64 {
        if args.iter().all(|x| x.is_finite()) {
            return match function_value(f, args) {
                Ok(v) => v,
                Err(e) => {
                    self.execution_error("E0403", span, e.to_string(), "guard it with a condition")
                }
            };
        }
        // These look at some of their arguments only, or at what they are and not how large.
        match f {
            Function::IfThen if is_undf(args[0]) || is_na(args[0]) => return args[0],
            Function::IfThen => return args[if truth(args[0]) { 1 } else { 2 }],
            Function::RelEq => return arithmetic::relate(BinaryOp::Eq, args[0], args[1]),
            Function::RelNe => return arithmetic::relate(BinaryOp::Ne, args[0], args[1]),
            _ => {}
        }
        let takes_words = matches!(
            f,
            Function::BoolAnd
                | Function::BoolOr
                | Function::BoolNot
                | Function::BoolXor
                | Function::BoolEqv
                | Function::BoolImp
        );
        let bad = if takes_words {
            is_undf
        } else {
            arithmetic::is_undefined
        };
        if args.iter().any(|&x| bad(x)) {
            let word = args.iter().find(|&&x| value::as_acronym(x).is_some());
            if word.is_none() && !functions::takes_na(f, args.len()) {
                let at = args.iter().position(|&x| bad(x)).unwrap_or(0);
                return self.refused(f.name(), "undf", at, span);
            }
            return self.no_acronym(*word.unwrap_or(&UNDF), span);
        }
        let power = matches!(f, Function::Power | Function::RPower);
        if let Some(at) = args.iter().position(|&x| is_na(x))
            && !(power && args[0] < 0.0)
        {
            return if functions::takes_na(f, args.len()) {
                NA
            } else {
                self.refused(f.name(), "na", at, span)
            };
        }
        let eps = args.iter().any(|&x| is_eps(x));
        match f {
            Function::Min => args
                .iter()
                .copied()
                .fold(f64::INFINITY, |a, b| extreme(a, b, |a, b| a < b)),
            Function::Max => args
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, |a, b| extreme(a, b, |a, b| a > b)),
            Function::Abs
            | Function::Sqrt
            | Function::Sign
            | Function::Sqr
            | Function::ArcTan
            | Function::Sin
                if eps =>
            {
                EPS
            }
            Function::Mod if is_eps(args[0]) && args[1].is_finite() && args[1] != 0.0 => EPS,
            Function::Power | Function::RPower if is_eps(args[0]) && args[1] > 0.0 => {
                if args[1].is_finite() { EPS } else { 0.0 }
            }
            Function::Power | Function::RPower if args[0] == 0.0 && args[1] == f64::INFINITY => 0.0,
            Function::Power | Function::RPower
                if args[0] == f64::INFINITY && number(args[1]) != 0.0 =>
            {
                if args[1] > 0.0 {
                    args[0]
                } else {
                    0.0
                }
            }
            Function::Round if is_eps(args[0]) || args.get(1) == Some(&f64::NEG_INFINITY) => 0.0,
            Function::Sign => args[0].signum(),
            Function::Floor | Function::Ceil | Function::Trunc => args[0],
            Function::RelLt => arithmetic::relate(BinaryOp::Lt, args[0], args[1]),
            Function::RelLe => arithmetic::relate(BinaryOp::Le, args[0], args[1]),
            Function::RelGt => arithmetic::relate(BinaryOp::Gt, args[0], args[1]),
            Function::RelGe => arithmetic::relate(BinaryOp::Ge, args[0], args[1]),
            Function::BoolAnd => arithmetic::relate(BinaryOp::And, args[0], args[1]),
            Function::BoolOr => arithmetic::relate(BinaryOp::Or, args[0], args[1]),
            Function::BoolXor => arithmetic::relate(BinaryOp::Xor, args[0], args[1]),
            Function::BoolEqv => arithmetic::relate(BinaryOp::Equivalent, args[0], args[1]),
            Function::BoolImp => arithmetic::relate(BinaryOp::Implies, args[0], args[1]),
            Function::BoolNot => arithmetic::not(args[0]),
            _ => {
                let plain: Vec<f64> = args.iter().map(|&x| number(x)).collect();
                match function_value(f, &plain) {
                    Ok(v) => v,
                    Err(e) => self.execution_error(
                        "E0403",
                        span,
                        e.to_string(),
                        "guard it with a condition",
                    ),
                }
            }
        }
    }

    /// Records of a symbol. A variable or an equation has one where any attribute is not at its default, and for each column or
    /// row of the last solve until levels or marginals are assigned.
    pub(super) fn count(&self, table: TableId) -> usize {
        let first = self.store.table(table);
        let symbol = self.table_symbol(table).map(|s| (s, self.symbols.get(s)));
        let Some((s, symbol)) = symbol.filter(|(_, s)| s.has_attributes() && s.dim() > 0) else {
            return first.len();
        };
        let tables = (0..attribute::COUNT).map(|a| self.store.table(symbol.table + a));
        let stored = tables.flat_map(|t| t.keys());
        let generated = self.generated.get(&s).map_or(&[][..], |keys| keys);
        let keys: FxHashSet<&[Label]> =
            stored.chain(generated.chunks_exact(symbol.dim())).collect();
        keys.len()
    }

    fn data_call(&self, f: DataFunction, a: &[f64], span: Span) -> f64 {
        use DataFunction as D;
        if f == D::Mapval {
            return match a[0] {
                x if is_undf(x) => 4.0,
                x if is_na(x) => 5.0,
                f64::INFINITY => 6.0,
                f64::NEG_INFINITY => 7.0,
                x if is_eps(x) => 8.0,
                x if value::as_acronym(x).is_some() => 9.0,
                _ => 0.0,
            };
        }
        let a: Vec<f64> = a.iter().map(|&x| number(x)).collect();
        if let Some(at) = a.iter().position(|&x| is_na(x)) {
            return if a.len() < 3 {
                NA
            } else {
                self.refused("the function", "na", at, span)
            };
        }
        if f == D::Fact && a[0] == f64::INFINITY {
            return functions::HUGE;
        }
        if let Err(why) = random::valid(f, &a) {
            if matches!(f, D::RandLinear | D::RandTriangle) {
                // These look at their arguments behind the draw.
                self.random.borrow_mut().uniform(0.0, 1.0);
            }
            return self.execution_error("E0403", span, why.into(), "guard it with a condition");
        }
        let mut random = self.random.borrow_mut();
        match f {
            D::Uniform => random.uniform(a[0], a[1]),
            D::UniformInt => random.uniform_int(a[0], a[1]),
            D::Normal => random.normal(a[0], a[1]),
            D::RandBinomial => random.binomial(a[0], a[1]),
            D::RandLinear => random.linear(a[0], a[1], a[2]),
            D::RandTriangle => random.triangle(a[0], a[1], a[2]),
            D::RandExponential => random.exponential(a[0]),
            D::RandPoisson => random.poisson(a[0]),
            D::SetSeed => {
                *random = random::Random::new(a[0] as i64);
                0.0
            }
            D::ExecSeed => random.take_seed(),
            D::Fact => {
                if a[0] < 0.0 || a[0].fract() != 0.0 {
                    drop(random);
                    return self.execution_error(
                        "E0403",
                        span,
                        format!("fact({}) has no value", a[0]),
                        "`fact` takes a whole number that is not negative",
                    );
                }
                (1..=a[0] as u64)
                    .take(400)
                    .fold(1.0, |p, k| p * k as f64)
                    .min(1e299)
            }
            D::Pi => std::f64::consts::PI,
            D::JNow => self.now(),
            D::JStart => self.started,
            D::JDate => match calendar::jdate(a[0], a[1], a[2]) {
                Some(day) => day,
                None => {
                    drop(random);
                    self.no_date(span)
                }
            },
            D::JTime => (a[0] * 3600.0 + a[1] * 60.0 + a[2]) / 86400.0,
            D::GYear
            | D::GMonth
            | D::GDay
            | D::GDow
            | D::GLeap
            | D::GHour
            | D::GMinute
            | D::GSecond
            | D::GMillisec => match calendar::part(f, a[0]) {
                Some(part) => part,
                None => {
                    drop(random);
                    self.no_date(span)
                }
            },
            D::TimeElapsed => self.elapsed(),
            D::ExecError => self.statements_failed() as f64,
            D::MaxExecError => self.most_errors as f64,
            // Nobody waits: the seconds that would have passed.
            D::Sleep => a[0],
            D::HandleCollect => self.grid.collect(a[0]),
            D::HandleStatus => self.grid.status(a[0]),
            D::HandleDelete | D::HandleSubmit => {
                let (name, found) = match f {
                    D::HandleDelete => ("handleDelete", self.grid.delete(a[0])),
                    _ => ("handleSubmit", self.grid.submit_again(a[0])),
                };
                if found != 0.0 {
                    let message = format!("{name}: no solve has the handle {}", a[0]);
                    let help = "`m.handle` is the number of the last solve with `m.solveLink = 3`";
                    self.execution_error("E0403", span, message, help);
                }
                found
            }
            D::ErrorLevel | D::Zero | D::ReadyCollect => 0.0,
            D::One => 1.0,
            D::GamsVersion => 546.0,
            D::GamsRelease => 54.6,
            D::Mapval => unreachable!("handled above"),
        }
    }

    fn refused(&self, name: &str, value: &str, at: usize, span: Span) -> f64 {
        self.execution_error(
            "E0403",
            span,
            format!("{name} does not take {value} (argument {})", at + 1),
            "guard it with a condition",
        )
    }

    fn no_date(&self, span: Span) -> f64 {
        self.execution_error(
            "E0403",
            span,
            "this is no date".into(),
            "days have numbers from the year 1 to the year 9999",
        )
    }

    fn label_attribute(
        &self,
        which: LabelAttribute,
        set: TableId,
        p: &Part,
        frame: &mut Frame,
        span: Span,
    ) -> f64 {
        let Some(l) = self.part(p, frame) else {
            return 0.0;
        };
        let t = self.store.table(set);
        let Some(r) = t.find(&[l]) else { return 0.0 };
        let (r, n) = (f64::from(r), t.len() as f64);
        let yes = |c: bool| f64::from(u8::from(c));
        match which {
            LabelAttribute::Pos | LabelAttribute::Ord => r + 1.0,
            LabelAttribute::Off => r,
            LabelAttribute::Rev => n - 1.0 - r,
            LabelAttribute::Uel => f64::from(l) + 1.0,
            LabelAttribute::Len => self.store.universe.name(l).chars().count() as f64,
            LabelAttribute::TextLen => self
                .store
                .element_text(set, &[l])
                .map_or(0.0, |t| t.chars().count() as f64),
            LabelAttribute::First => yes(r == 0.0),
            LabelAttribute::Last => yes(r + 1.0 == n),
            LabelAttribute::Val => self.spelled(self.store.universe.name(l), "the label", span),
            LabelAttribute::TextVal => match self.store.element_text(set, &[l]) {
                Some(text) => self.spelled(text, "the text", span),
                None => 0.0,
            },
        }
    }

    /// The number that a label or a text says.
    fn spelled(&self, text: &str, what: &str, span: Span) -> f64 {
        match text.to_lowercase().as_str() {
            "inf" | "+inf" => return f64::INFINITY,
            "-inf" => return f64::NEG_INFINITY,
            "eps" => return EPS,
            "na" => return NA,
            _ => {}
        }
        let plain = text.strip_prefix('+').unwrap_or(text);
        match fast_float2::parse::<f64, _>(plain) {
            Ok(v) if v.is_finite() => v,
            _ => self.execution_error(
                "E0405",
                span,
                format!("{what} `{text}` is not a number"),
                "`.val` and `.tval` need numbers",
            ),
        }
    }

    fn derived(&self, d: Derived, s: SymbolId, key: &Key, frame: &mut Frame) -> f64 {
        if let Derived::RangeLo | Derived::RangeUp | Derived::PriceLo | Derived::PriceUp = d {
            let mut k = [0; 20];
            return match self.ranges.get(&(s, d)) {
                Some(t) if self.key(key, frame, &mut k) => t.get(&k[..key.parts.len()]),
                _ => NA,
            };
        }
        let symbol = self.symbols.get(s);
        let t = symbol.table;
        let (l, lo, up) = (
            self.data(t + attribute::L, key, frame),
            self.data(t + attribute::LO, key, frame),
            self.data(t + attribute::UP, key, frame),
        );
        derived_value(d, matches!(symbol.kind, SymbolKind::Equation(_)), l, lo, up)
    }
}

/// A computed attribute from level and bounds.
pub(super) fn derived_value(d: Derived, is_equation: bool, l: f64, lo: f64, up: f64) -> f64 {
    let (l, lo, up) = (number(l), number(lo), number(up));
    let below = if lo == f64::NEG_INFINITY {
        f64::INFINITY
    } else {
        (l - lo).max(0.0)
    };
    let above = if up == f64::INFINITY {
        f64::INFINITY
    } else {
        (up - l).max(0.0)
    };
    match d {
        Derived::SlackLo => below,
        Derived::SlackUp => above,
        Derived::Slack => below.min(above),
        Derived::Infeas => (lo - l).max(l - up).max(0.0),
        Derived::RangeLo | Derived::RangeUp | Derived::PriceLo | Derived::PriceUp => NA,
        Derived::Range => {
            if is_equation && lo == up {
                0.0
            } else {
                arithmetic::add(up, arithmetic::negate(lo))
            }
        }
    }
}

/// The smaller or larger of two values: na and undf win, eps counts as 0.
fn extreme(a: f64, b: f64, better: fn(f64, f64) -> bool) -> f64 {
    if a.is_nan() || b.is_nan() {
        if arithmetic::is_undefined(a) || arithmetic::is_undefined(b) {
            return UNDF;
        }
        if is_na(a) || is_na(b) {
            return NA;
        }
        let (x, y) = (number(a), number(b));
        if x == y {
            return if is_eps(a) || is_eps(b) { EPS } else { a };
        }
        return if better(x, y) { a } else { b };
    }
    if better(b, a) { b } else { a }
}
