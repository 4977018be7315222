//! Formulas as text for the terminal, as LaTeX, and as MathML.

use super::math::{Math, Name, command};

/// Text in one line.
pub fn text(m: &Math) -> String {
    match m {
        Math::Number(t) | Math::Words(t) => t.clone(),
        Math::Name(n) => match n.below.is_empty() {
            true => n.base.clone(),
            false => format!("{}_{}", n.base, n.below),
        },
        Math::Quoted(t) => format!("'{t}'"),
        Math::Operator(":") => " : ".into(),
        Math::Operator(",") => ", ".into(),
        Math::Operator(o) => format!(" {o} "),
        Math::Prefix(o) => (*o).to_string(),
        Math::Row(list) => in_row(list, text, |_| "·"),
        Math::Parentheses(m) => format!("({})", text(m)),
        Math::Bracket(m) => format!("[{}]", text(m)),
        Math::Open(t) | Math::Close(t) => (*t).to_string(),
        Math::Indexed(base, parts) => {
            let parts: Vec<String> = parts.iter().map(text).collect();
            format!("{}({})", text(base), parts.join(","))
        }
        Math::Bar(m, upper) => format!("{}{}", text(m), if *upper { ".up" } else { ".lo" }),
        Math::Marked(m, "*") => format!("{}.l", text(m)),
        Math::Marked(m, word) => format!("{}.{word}", text(m)),
        Math::Fraction(a, b) => format!("{}/{}", tight(a), tight(b)),
        Math::Power(a, b) => {
            let base = match **a {
                Math::Root(_) => format!("({})", text(a)),
                _ => text(a),
            };
            match superscript(&text(b)) {
                Some(s) => format!("{base}{s}"),
                None => format!("{base}^{}", tight(b)),
            }
        }
        Math::Root(m) => format!("√{}", tight(m)),
        Math::Absolute(m) => format!("|{}|", text(m)),
        Math::Norm(m) => format!("‖{}‖₂", text(m)),
        Math::Big(op, under, body) => format!("{op}{{{}}} {}", text(under), text(body)),
        Math::Function(f, args) => {
            let args: Vec<String> = args.iter().map(text).collect();
            format!("{f}({})", args.join(", "))
        }
    }
}

/// Pieces side by side, with something between two that are multiplied.
fn in_row(list: &[Math], write: fn(&Math) -> String, times: fn(&Math) -> &'static str) -> String {
    let mut out = String::new();
    for (n, m) in list.iter().enumerate() {
        if n > 0 && are_factors(&list[n - 1], m) {
            out.push_str(times(m));
        }
        out.push_str(&write(m));
    }
    out
}

/// Whether two neighbours are multiplied.
fn are_factors(a: &Math, b: &Math) -> bool {
    let is_factor = |m: &Math| !matches!(m, Math::Operator(_) | Math::Prefix(_) | Math::Words(_));
    let opens = match a {
        Math::Big(_, _, body) => matches!(&**body, Math::Row(list) if list.is_empty()),
        a => matches!(a, Math::Open(_)),
    };
    let closes = match b {
        Math::Power(base, _) => matches!(**base, Math::Close(_)),
        b => matches!(b, Math::Close(_)),
    };
    is_factor(a) && is_factor(b) && !opens && !closes
}

/// In parentheses unless it is one piece.
fn tight(m: &Math) -> String {
    match m {
        Math::Row(list) if list.len() == 1 => tight(&list[0]),
        Math::Row(list) if list.len() > 1 => format!("({})", text(m)),
        Math::Fraction(..) | Math::Big(..) => format!("({})", text(m)),
        m => text(m),
    }
}

fn superscript(t: &str) -> Option<String> {
    let raised = "0123456789−".chars().zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻".chars());
    let one = |c| raised.clone().find(|r| r.0 == c).map(|r| r.1);
    t.chars().map(one).collect()
}

/// The pieces between which a line may break: before `+`, `−` and relations of the outermost rows; each begins with its
/// operator.
pub fn pieces(m: &Math) -> Vec<Math> {
    fn split(m: &Math, out: &mut Vec<Vec<Math>>) {
        let Math::Row(list) = m else {
            out.extend((out.is_empty()).then(Vec::new));
            out.iter_mut()
                .last()
                .into_iter()
                .for_each(|p| p.push(m.clone()));
            return;
        };
        for m in list {
            let begins = match out.last().map(Vec::as_slice) {
                None | Some([] | [Math::Operator(_)]) => true,
                Some(_) => false,
            };
            match m {
                Math::Operator(o) if !matches!(*o, ":" | ",") => out.push(vec![m.clone()]),
                Math::Row(_) if begins => split(m, out),
                m => match out.last_mut() {
                    Some(piece) => piece.push(m.clone()),
                    None => out.push(vec![m.clone()]),
                },
            }
        }
    }
    let mut out = Vec::new();
    split(m, &mut out);
    out.into_iter().map(Math::Row).collect()
}

/// The pieces of a formula; those that take more than `room` characters as text are cut inside of their parentheses and sums,
/// then between factors, and what is not the first of them is marked.
fn fitting(m: &Math, room: usize) -> Vec<(bool, Math)> {
    let mut out = Vec::new();
    for p in pieces(m) {
        if text(&p).chars().count() <= room {
            out.push((false, p));
            continue;
        }
        let parts = match opened(&p) {
            Some(list) => fitting(&Math::Row(list), room),
            None => factored(&p).into_iter().map(|p| (true, p)).collect(),
        };
        let parts = parts.into_iter().enumerate();
        out.extend(parts.map(|(n, (_, p))| (n > 0, p)));
    }
    out
}

/// What stands in a row, without rows in it.
fn flat(m: &Math) -> Vec<Math> {
    match m {
        Math::Row(list) => list.iter().flat_map(flat).collect(),
        m => vec![m.clone()],
    }
}

/// A term cut between its factors, and behind what a sum runs over if that is long.
fn factored(m: &Math) -> Vec<Math> {
    let is_long = |m: &Math| matches!(m, Math::Big(..)) && text(m).chars().count() > LINE / 3;
    let mut out: Vec<Vec<Math>> = vec![Vec::new()];
    for m in flat(m) {
        let last = out.last().and_then(|p| p.last());
        let is_factor = last.is_some_and(|l| are_factors(l, &m));
        if is_factor {
            out.push(vec![Math::Prefix("·")]);
        } else if last.is_some_and(is_long) {
            out.push(Vec::new());
        }
        out.last_mut().into_iter().for_each(|p| p.push(m.clone()));
    }
    out.into_iter().map(Math::Row).collect()
}

/// A formula with its outermost parentheses, sums and fractions open; None where it has none.
fn opened(m: &Math) -> Option<Vec<Math>> {
    let between = |m: &Math, close| [vec![Math::Open("(")], flat(m), vec![close]].concat();
    match m {
        Math::Row(list) => {
            let parts: Vec<Option<Vec<Math>>> = list.iter().map(opened).collect();
            let any = parts.iter().any(Option::is_some);
            let each = list.iter().zip(parts);
            let all = each.flat_map(|(m, open)| open.unwrap_or_else(|| vec![m.clone()]));
            any.then(|| all.collect())
        }
        Math::Parentheses(m) => Some(between(m, Math::Close(")"))),
        Math::Power(base, exponent) => match &**base {
            Math::Parentheses(m) => {
                let close = Math::Power(Box::new(Math::Close(")")), exponent.clone());
                Some(between(m, close))
            }
            _ => None,
        },
        Math::Fraction(above, below) if flat(above).len() > 1 => {
            let below = match flat(below).len() {
                1 => (**below).clone(),
                _ => Math::Parentheses(below.clone()),
            };
            let over = vec![Math::Prefix("/"), below];
            Some([between(above, Math::Close(")")), over].concat())
        }
        Math::Big(op, under, body) if !flat(body).is_empty() => {
            let head = Math::Big(op, under.clone(), Box::new(Math::Row(Vec::new())));
            Some([vec![head], flat(body)].concat())
        }
        _ => None,
    }
}

/// Text in lines of at most `width` characters. Lines behind the first begin with `indent` blanks, those that go on inside of a
/// term with two more.
pub fn wrapped(m: &Math, width: usize, indent: usize) -> String {
    let mut out = String::new();
    let mut column = indent;
    for (inside, p) in fitting(m, width.saturating_sub(indent + 2)) {
        let indent = indent + if inside { 2 } else { 0 };
        let p = text(&p);
        let length = p.chars().count();
        if column + length > width && column > indent {
            out.truncate(out.trim_end().len());
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            out.push_str(p.trim_start());
            column = indent + p.trim_start().chars().count();
            continue;
        }
        out.push_str(&p);
        column += length;
    }
    out
}

/// Characters of a line of LaTeX or HTML, as the formula would take them as text.
pub const LINE: usize = 84;

/// LaTeX in lines, for an `align` with `room` characters; what `behind` stands at its end, or on a line of its own.
pub fn latex_lines(m: &Math, room: usize, behind: Option<&Math>) -> String {
    let mut out = String::new();
    let mut column = 0;
    let line = |inside| match inside {
        true => " \\\\\n & \\qquad\\quad {}",
        false => " \\\\\n & \\qquad {}",
    };
    for (inside, p) in fitting(m, room) {
        let length = text(&p).chars().count();
        if column > 0 && column + length > room {
            out.push_str(line(inside));
            column = 0;
        }
        column += length;
        out.push_str(&latex(&p));
    }
    if let Some(m) = behind {
        let fits = column + 3 + text(m).chars().count() <= room;
        out.push_str(if fits { " \\qquad " } else { line(true) });
        out.push_str(&format!("\\forall\\, {}", latex(m)));
    }
    out
}

/// MathML in pieces between which a line may break.
pub fn mathml_lines(m: &Math) -> String {
    let mut out = String::new();
    for (_, p) in fitting(m, LINE) {
        // An operator that begins a piece stands between two terms all the same.
        let piece = mathml(&p).replacen("<mo>", "<mo form=\"infix\">", usize::from(begins(&p)));
        out.push_str(&format!("<math displaystyle=\"true\">{piece}</math><wbr>"));
    }
    out
}

fn begins(piece: &Math) -> bool {
    matches!(piece, Math::Row(list) if matches!(list.first(), Some(Math::Operator(_))))
}

/// LaTeX for a formula, with amsmath.
pub fn latex(m: &Math) -> String {
    match m {
        Math::Number(t) => t.replace('−', "-").replace('∞', "\\infty "),
        Math::Words(t) | Math::Quoted(t) => format!("\\text{{{}}}", latex_words(t)),
        Math::Name(n) => latex_name(n),
        Math::Operator(o) | Math::Prefix(o) => format!(" {} ", latex_operator(o)),
        Math::Row(list) => in_row(list, latex, |m| match m {
            Math::Number(_) | Math::Fraction(..) => " \\cdot ",
            _ => "\\,",
        }),
        Math::Parentheses(m) => format!("\\left({}\\right)", latex(m)),
        Math::Bracket(m) => format!("\\left[{}\\right]", latex(m)),
        Math::Open(t) => format!("\\bigl{t}"),
        Math::Close(t) => format!("\\bigr{t}"),
        Math::Indexed(base, parts) => {
            let single = parts.iter().all(is_letter);
            let parts: Vec<String> = parts.iter().map(latex).collect();
            let parts = parts.join(if single { " " } else { "," });
            match &**base {
                // A symbol with a subscript of its own takes the indices behind it.
                Math::Name(n) if !n.below.is_empty() && n.latex.is_none() => {
                    let (base, below) = (letters(&n.base), escaped(&n.below));
                    format!("{base}_{{\\mathrm{{{below}}},{parts}}}")
                }
                base => format!("{{{}}}_{{{parts}}}", latex(base)),
            }
        }
        Math::Bar(m, true) => format!("\\overline{{{}}}", latex(m)),
        Math::Bar(m, false) => format!("\\underline{{{}}}", latex(m)),
        Math::Marked(m, "*") => format!("{{{}}}^{{*}}", latex(m)),
        Math::Marked(m, word) => format!("{{{}}}^{{\\mathrm{{{word}}}}}", latex(m)),
        Math::Fraction(a, b) => format!("\\frac{{{}}}{{{}}}", latex(a), latex(b)),
        Math::Power(a, b) => format!("{{{}}}^{{{}}}", latex(a), latex(b)),
        Math::Root(m) => format!("\\sqrt{{{}}}", latex(m)),
        Math::Absolute(m) => format!("\\left|{}\\right|", latex(m)),
        Math::Norm(m) => format!("\\left\\lVert{}\\right\\rVert_2", latex(m)),
        Math::Big(op, under, body) => {
            let op = match *op {
                "∑" => "\\sum",
                "∏" => "\\prod",
                "min" => "\\min",
                "max" => "\\max",
                "⋀" => "\\bigwedge",
                _ => "\\bigvee",
            };
            format!("{op}_{{{}}} {}", latex(under), latex(body))
        }
        Math::Function(f, args) => {
            let args: Vec<String> = args.iter().map(latex).collect();
            let f = match *f {
                "ln" | "sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "min" | "max" => {
                    format!("\\{f}")
                }
                "Φ" => "\\Phi".to_string(),
                f => format!("\\operatorname{{{}}}", escaped(f)),
            };
            format!("{f}\\left({}\\right)", args.join(", "))
        }
    }
}

fn is_letter(m: &Math) -> bool {
    matches!(m, Math::Name(n) if n.base.chars().count() == 1 && n.below.is_empty())
}

/// Letters in LaTeX: one alone in italics, a Greek one by its command, a word upright.
fn letters(base: &str) -> String {
    match (command(base), base.chars().count()) {
        (Some(c), _) => format!("\\{c} "),
        (None, 1) => escaped(base),
        _ => format!("\\mathrm{{{}}}", escaped(base)),
    }
}

fn latex_name(n: &Name) -> String {
    if let Some(l) = &n.latex {
        return l.clone();
    }
    match n.below.is_empty() {
        true => letters(&n.base),
        false => format!("{}_{{\\mathrm{{{}}}}}", letters(&n.base), escaped(&n.below)),
    }
}

/// A name in LaTeX.
fn escaped(t: &str) -> String {
    let mut out = String::new();
    for c in t.chars() {
        match c {
            '#' | '$' | '%' | '&' | '_' | '{' | '}' => out.extend(['\\', c]),
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '−' => out.push('-'),
            c => out.push(c),
        }
    }
    out
}

/// Words in LaTeX: what the default fonts lack is written as mathematics.
pub fn latex_words(t: &str) -> String {
    let mut out = String::new();
    for c in t.chars() {
        let mut bytes = [0; 4];
        let text: &str = c.encode_utf8(&mut bytes);
        let operator = latex_operator(text);
        let digit = |zero: char| (c as u32).wrapping_sub(zero as u32);
        match c {
            '<' | '>' | '|' => out.push_str(&format!("${c}$")),
            '−' => out.push('-'),
            c if c.is_ascii() => out.push_str(&escaped(text)),
            _ if operator.starts_with('\\') => out.push_str(&format!("${operator}$")),
            '€' => out.push_str("\\texteuro{}"),
            '→' => out.push_str("$\\to$"),
            '←' => out.push_str("$\\leftarrow$"),
            '∞' => out.push_str("$\\infty$"),
            '⁻' => out.push_str("$^-$"),
            '₀'..='₉' => out.push_str(&format!("$_{}$", digit('₀'))),
            '⁴'..='⁹' => out.push_str(&format!("$^{}$", digit('⁰'))),
            '–' | '—' | '‘' | '’' | '“' | '”' | '„' => out.push(c),
            '\u{a0}'..='\u{ff}' => out.push(c),
            _ => match command(text) {
                Some(greek) => out.push_str(&format!("$\\{greek}$")),
                None => out.push('?'),
            },
        }
    }
    out
}

fn latex_operator(o: &str) -> &str {
    match o {
        "−" => "-",
        "≤" => "\\le",
        "≥" => "\\ge",
        "≠" => "\\ne",
        "∈" => "\\in",
        "∧" => "\\wedge",
        "∨" => "\\vee",
        "⊻" => "\\oplus",
        "⇒" => "\\Rightarrow",
        "⇔" => "\\Leftrightarrow",
        "¬" => "\\neg",
        "⟂" => "\\perp",
        "⊕" => "\\oplus",
        "⊖" => "\\ominus",
        "⋚" => "\\mathrel{\\substack{<\\\\[-.4ex]>}}",
        "…" => "\\ldots",
        "·" => "\\cdot",
        "{" => "\\{",
        "}" => "\\}",
        o => o,
    }
}

/// MathML for a formula, without the outermost element.
pub fn mathml(m: &Math) -> String {
    let row = |m: &Math| format!("<mrow>{}</mrow>", mathml(m));
    match m {
        Math::Number(t) => format!("<mn>{t}</mn>"),
        // Blanks at the ends of a text are not kept.
        Math::Words(t) | Math::Quoted(t) => {
            format!("<mtext>{}</mtext>", plain(t).replace(' ', "&#160;"))
        }
        Math::Name(n) => match n.below.is_empty() {
            true => identifier(&n.base),
            false => format!(
                "<msub>{}<mtext>{}</mtext></msub>",
                identifier(&n.base),
                plain(&n.below)
            ),
        },
        Math::Operator(o) | Math::Prefix(o) => format!("<mo>{}</mo>", plain(o)),
        Math::Row(list) => in_row(list, mathml, |m| match m {
            Math::Number(_) => "<mo>·</mo>",
            _ => "<mspace width=\"0.17em\"/>",
        }),
        Math::Parentheses(m) => format!("<mrow><mo>(</mo>{}<mo>)</mo></mrow>", mathml(m)),
        Math::Bracket(m) => format!("<mrow><mo>[</mo>{}<mo>]</mo></mrow>", mathml(m)),
        Math::Open(t) | Math::Close(t) => format!("<mo stretchy=\"false\">{t}</mo>"),
        Math::Indexed(base, parts) => {
            let comma = match parts.iter().all(is_letter) {
                true => "<mspace width=\"0.1em\"/>",
                false => "<mo separator=\"true\">,</mo>",
            };
            let parts: Vec<String> = parts.iter().map(row).collect();
            let parts = parts.join(comma);
            match &**base {
                Math::Name(n) if !n.below.is_empty() => format!(
                    "<msub>{}<mrow><mtext>{}</mtext><mo separator=\"true\">,</mo>{parts}</mrow></msub>",
                    identifier(&n.base),
                    plain(&n.below)
                ),
                base => format!("<msub>{}<mrow>{parts}</mrow></msub>", row(base)),
            }
        }
        Math::Bar(m, true) => format!("<mover>{}<mo stretchy=\"true\">¯</mo></mover>", row(m)),
        Math::Bar(m, false) => format!("<munder>{}<mo stretchy=\"true\">_</mo></munder>", row(m)),
        Math::Marked(m, word) => format!("<msup>{}<mtext>{}</mtext></msup>", row(m), plain(word)),
        Math::Fraction(a, b) => format!("<mfrac>{}{}</mfrac>", row(a), row(b)),
        Math::Power(a, b) => format!("<msup>{}{}</msup>", row(a), row(b)),
        Math::Root(m) => format!("<msqrt>{}</msqrt>", mathml(m)),
        Math::Absolute(m) => format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", mathml(m)),
        Math::Norm(m) => format!(
            "<msub><mrow><mo>‖</mo>{}<mo>‖</mo></mrow><mn>2</mn></msub>",
            mathml(m)
        ),
        Math::Big(op, under, body) => {
            let word = op.chars().all(char::is_alphabetic);
            let op = match word {
                true => format!("<mi>{op}</mi>"),
                false => format!("<mo largeop=\"true\" movablelimits=\"false\">{op}</mo>"),
            };
            format!("<munder>{op}{}</munder>{}", row(under), mathml(body))
        }
        Math::Function(f, args) => {
            let args: Vec<String> = args.iter().map(row).collect();
            let args = args.join("<mo separator=\"true\">,</mo>");
            format!("<mi>{}</mi><mo>(</mo>{args}<mo>)</mo>", plain(f))
        }
    }
}

fn identifier(t: &str) -> String {
    match t.chars().count() {
        1 => format!("<mi>{}</mi>", plain(t)),
        _ => format!("<mtext>{}</mtext>", plain(t)),
    }
}

/// A text in HTML.
pub fn plain(t: &str) -> String {
    t.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
