//! The summary of a solve on the terminal: short, aligned, coloured only where the reader's
//! terminal shows colours.

use std::fmt::Write;

use super::json::{Number, SolveReport};

const GREEN: &str = "\x1b[32m";
const YELLOW: &str = "\x1b[33m";
const RED: &str = "\x1b[31m";
const BOLD: &str = "\x1b[1m";
const DIM: &str = "\x1b[2m";
const RESET: &str = "\x1b[0m";

/// One solve, in two or three lines.
pub fn solve(s: &SolveReport, color: bool) -> String {
    let paint = |code: &'static str| if color { code } else { "" };
    let reset = paint(RESET);
    let status = match s.model_status.code {
        1 | 2 | 15 | 16 => GREEN,
        3 | 4 | 5 | 8 | 10 | 18 | 19 => YELLOW,
        _ => RED,
    };
    let mut what = format!("{}{}{reset} using {}", paint(BOLD), s.model, s.using);
    match (s.sense, &s.objective_name) {
        (Some(sense), Some(name)) => {
            let _ = write!(what, " {}imizing {name}", sense.name());
        }
        (Some(sense), None) => {
            let _ = write!(what, " {}imizing", sense.name());
        }
        _ => {}
    }
    let mut out = format!("  {what}: {}{}{reset}", paint(status), s.model_status.name);
    if let Some(Number(v)) = s.objective.filter(|_| !means_nothing(s)) {
        let name = s.objective_name.as_deref().unwrap_or("objective");
        let _ = write!(out, ", {name} = {}{}{reset}", paint(BOLD), digits(v));
    }
    out.push('\n');
    if let Some([Number(lo), Number(hi)]) = s.bounds {
        let name = s.objective_name.as_deref().unwrap_or("objective");
        let end = |v: f64| Number(v).text();
        let _ = write!(out, "    proved: {name} ∈ [{}, {}]", end(lo), end(hi));
        if (hi - lo).is_finite() {
            let _ = write!(out, ", width {}", small(hi - lo));
        }
        out.push('\n');
    }
    if let Some(search) = &s.search {
        let mut parts = Vec::new();
        if let Some(Number(bound)) = search.bound {
            parts.push(format!("bound {}", digits(bound)));
        }
        if let Some(Number(gap)) = search.gap {
            parts.push(format!("gap {} %", digits((gap * 1e5).round() / 1e3)));
        }
        let plural = if search.nodes == 1 { "" } else { "s" };
        parts.push(format!("{} node{plural}", grouped(search.nodes as usize)));
        let _ = writeln!(out, "    {}", parts.join(", "));
    }
    if s.solver_status.code != 1 {
        let _ = writeln!(
            out,
            "    {}solver: {}{reset}",
            paint(RED),
            s.solver_status.name
        );
    }
    let _ = writeln!(
        out,
        "    {}{} rows, {} columns, {} nonzeros{} · {}, {} iterations, {}{reset}",
        paint(DIM),
        grouped(s.rows),
        grouped(s.columns),
        grouped(s.nonzeros),
        match s.nonlinear_nonzeros {
            0 => String::new(),
            n => format!(" ({} nonlinear)", grouped(n)),
        },
        s.solver,
        grouped(s.iterations as usize),
        time(s.seconds.total),
    );
    let residuals = [
        ("primal", s.residual.primal),
        ("dual", s.residual.dual),
        ("complementarity", s.residual.complementarity),
        ("natural", s.residual.natural),
    ];
    let shown: Vec<String> = residuals
        .iter()
        .filter_map(|(name, v)| v.map(|v| format!("{name} {}", small(v))))
        .collect();
    if !shown.is_empty() {
        let list = shown.join(", ");
        let _ = writeln!(out, "    {}largest residuals: {list}{reset}", paint(DIM));
    }
    if let Some(message) = &s.message {
        let _ = writeln!(out, "    {message}");
    }
    if let Some(hint) = &s.hint {
        let _ = writeln!(out, "    {hint}");
    }
    for text in s.why.iter().flat_map(|w| &w.text) {
        let _ = writeln!(out, "  {text}");
    }
    if let Some(stationarity) = s.stationarity {
        let _ = writeln!(out, "    stationarity: {stationarity}");
    }
    out
}

/// Whether the objective means nothing: its point violates rows or bounds, or it has no limit.
fn means_nothing(s: &SolveReport) -> bool {
    matches!(s.model_status.code, 3 | 4 | 5 | 6 | 18 | 19)
}

/// Ten significant digits, without trailing zeros.
pub fn digits(v: f64) -> String {
    if !v.is_finite() {
        return Number(v).text();
    }
    let size = v.abs();
    if size != 0.0 && !(1e-5..1e10).contains(&size) {
        return format!("{v:.9e}");
    }
    let decimals = if size < 1.0 {
        10
    } else {
        (9 - size.log10().floor() as i32).clamp(0, 10) as usize
    };
    let text = format!("{v:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}

impl Number {
    /// As `display` shows it.
    pub fn text(self) -> String {
        match serde_json::to_value(self) {
            Ok(serde_json::Value::String(s)) => s,
            _ => self.0.to_string(),
        }
    }
}

/// A residual: one digit is enough.
fn small(v: f64) -> String {
    if v == 0.0 {
        "0".into()
    } else {
        format!("{v:.0e}")
    }
}

/// `12 345`
fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (k, c) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            out.push(' ');
        }
        out.push(c);
    }
    out
}

/// A duration in the unit in which it reads best.
fn time(seconds: f64) -> String {
    if seconds < 0.0995 {
        format!("{:.1} ms", 1000.0 * seconds)
    } else if seconds < 100.0 {
        format!("{seconds:.2} s")
    } else {
        format!("{seconds:.0} s")
    }
}
