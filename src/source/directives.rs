//! Lines that begin with `$`.
//!
//! Three kinds: those that shape the text (`$include`, `$set`, `$if`, `$macro` …), those that belong
//! to the program and are left in the text for the parser (`$load`, `$gdxin`, `$kill` …), and those
//! that only shape a listing, which are accepted and do nothing.

use super::Modes;
use super::conditions::Flavour;
use super::directive_names::{EXPORTS, OTHERS, SILENT, SILENT_LINES, SILENT_SWITCHES};
use super::evaluate::{evaluate, number_text};
use super::line::Line;
use super::preprocess::{Ending, Known, Preprocessor};
use super::variables::Reach;
use super::{Outcome, embedded_code, passed_over};
use crate::diag::{Diagnostic, nearest};
use crate::host::date_of;

/// Length of the word at the start of a text.
pub(super) fn word_len(text: &str) -> usize {
    text.bytes()
        .position(|c| !c.is_ascii_alphanumeric() && c != b'_')
        .unwrap_or(text.len())
}

/// The tag of a directive whose name ends at `at` (`$ifThen.tag`), in lower case, and its length with the dot.
pub(super) fn tag_of(text: &str, at: usize) -> (String, usize) {
    match text[at..].strip_prefix('.') {
        Some(tag) => {
            let len = word_len(tag);
            (tag[..len].to_ascii_lowercase(), len + 1)
        }
        None => (String::new(), 0),
    }
}

/// The quotes that a text begins with: what stands inside, and what follows them.
pub(super) fn quoted(text: &str) -> Option<(&str, &str)> {
    let q = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(q)
}

/// The next argument: quoted, or up to a blank; and what follows it.
fn argument(text: &str) -> (&str, &str) {
    let t = text.trim_start();
    quoted(t).unwrap_or_else(|| {
        let end = t.find([' ', '\t']).unwrap_or(t.len());
        t.split_at(end)
    })
}

/// The GDX file that a command makes of a spreadsheet or CSV file: `gdxxrw in.xlsx o=out.gdx par=p`.
/// Where it is not named it has its source's name, and stands in the current folder.
fn conversion(command: &str) -> Option<String> {
    let spaced = command.replace(" =", "=").replace("= ", "=");
    let (program, mut rest) = argument(spaced.trim_start_matches('='));
    let program = program.rsplit(['/', '\\']).next()?.to_ascii_lowercase();
    if !matches!(program.trim_end_matches(".exe"), "gdxxrw" | "csv2gdx") {
        return None;
    }
    let (mut source, mut made) = (None, None);
    while !rest.trim().is_empty() {
        let (word, behind) = argument(rest);
        rest = behind;
        let (name, value) = word.split_once('=').unwrap_or(("i", word));
        // The value alone may stand in quotes, with blanks in it.
        let value = match value.strip_prefix(['"', '\'']) {
            Some(begun) => match begun.strip_suffix(['"', '\'']) {
                Some(whole) => whole.to_owned(),
                None => {
                    let (more, behind) = rest.split_once(['"', '\''])?;
                    rest = behind;
                    format!("{begun}{more}")
                }
            },
            None => value.to_owned(),
        };
        match name.to_ascii_lowercase().as_str() {
            "i" | "input" if !value.starts_with('@') => _ = source.get_or_insert(value),
            "o" | "output" => made = Some(value),
            _ => {}
        }
    }
    made.or_else(|| {
        let source = source?;
        let file = source.rsplit(['/', '\\']).next()?;
        let stem = file.rsplit_once('.').map_or(file, |f| f.0);
        Some(format!("{stem}.gdx"))
    })
}

/// A text without the quotes around it.
pub(super) fn unquoted(text: &str) -> &str {
    let t = text.trim();
    for q in ['\'', '"'] {
        if t.len() >= 2 && t.starts_with(q) && t.ends_with(q) {
            return &t[1..t.len() - 1];
        }
    }
    t
}

/// The name of a file: in quotes, a semicolon may follow.
pub(super) fn file_name(text: &str) -> &str {
    let text = text.trim();
    match quoted(text) {
        Some((name, tail)) if tail.trim_matches([';', ' ', '\t']).is_empty() => name,
        _ => text,
    }
}

/// `11/21/26` from days since 1899-12-31.
pub(super) fn date_text(now: f64) -> String {
    let date = date_of(now).unwrap_or_default();
    date.strftime("%m/%d/%y").to_string()
}

/// `09:28:49` from days since 1899-12-31.
pub(super) fn time_text(now: f64) -> String {
    let s = (now.fract() * 86_400.0).max(0.0) as u32;
    format!("{:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

/// Blanks and semicolons may stand between and behind switches: `$offDigit;`.
fn behind_separators(rest: &str) -> &str {
    rest.trim_start_matches(|c: char| c.is_whitespace() || c == ';')
}

impl Preprocessor<'_> {
    /// A line that begins with `$`, without its comments.
    pub(super) fn directive_line(&mut self, line: Line, known: &dyn Known) -> Outcome<()> {
        // All of it may have been a comment.
        let start = self.marks.directive(&line.text);
        let start = start.unwrap_or(line.text.len().min(1));
        self.directives(&line, start, known)
    }

    /// The directives from byte `at` on (behind the `$`).
    fn directives(&mut self, line: &Line, mut at: usize, known: &dyn Known) -> Outcome<()> {
        loop {
            let text = &line.text;
            at = text.len() - behind_separators(&text[at..]).len();
            let from = at;
            let len = word_len(&text[at..]);
            let word = text[at..at + len].to_ascii_lowercase();
            at += len;
            if word.is_empty() {
                let help =
                    "a `$` condition must not begin in the first column: put a blank before it";
                let (lo, hi) = line.origin(0, text.len().max(1));
                let span = self.place(lo, hi);
                return Diagnostic::error("E0107", span)
                    .says("a `$` in the first column begins a directive, but no name follows")
                    .help(help)
                    .refuse();
            }
            let silent = SILENT.contains(&word.as_str());
            if !self.switch(&word) && !silent {
                return self.directive(line, &word, from, at, known);
            }
            let dollar = self.marks.dollar as char;
            let mut rest = behind_separators(&text[at..]);
            if silent {
                // A number or a mark may stand behind.
                if !rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == dollar) {
                    rest = behind_separators(argument(rest).1);
                } else if !self.is_directive(rest) {
                    return Ok(());
                }
            }
            if rest.is_empty() {
                return Ok(());
            }
            at = text.len() - rest.len() + usize::from(rest.starts_with(dollar));
        }
    }

    /// Another directive in what is left of a line: `$inlineCom { } eolCom !`.
    fn further_directive(&mut self, line: &Line, rest: &str, known: &dyn Known) -> Outcome<()> {
        let rest = behind_separators(rest);
        if rest.is_empty() || !self.is_directive(rest) {
            return Ok(());
        }
        let mark = usize::from(rest.as_bytes()[0] == self.marks.dollar);
        self.directives(line, line.text.len() - rest.len() + mark, known)
    }

    /// Whether a text begins with the name of a directive.
    fn is_directive(&self, text: &str) -> bool {
        let t = text.strip_prefix(self.marks.dollar as char).unwrap_or(text);
        let w = t[..word_len(t)].to_ascii_lowercase();
        let switch = |w: &str| {
            w.strip_prefix("on")
                .or_else(|| w.strip_prefix("off"))
                .is_some_and(|x| SILENT_SWITCHES.contains(&x))
        };
        SILENT.contains(&w.as_str()) || OTHERS.contains(&w.as_str()) || switch(&w)
    }

    /// Directives without argument that set something. True if it was one.
    fn switch(&mut self, word: &str) -> bool {
        let (on, what) = match (word.strip_prefix("on"), word.strip_prefix("off")) {
            (Some(w), _) => (true, w),
            (_, Some(w)) => (false, w),
            _ => return false,
        };
        let mut modes = self.modes.last().map_or(Modes::default(), |m| m.1);
        let m = &mut modes;
        match what {
            "multi" => (m.multi, m.multi_replace) = (on, false),
            "multir" => (m.multi, m.multi_replace) = (on, on),
            "empty" => m.empty = on,
            "eps" => m.eps = on,
            "undf" => m.undf = on,
            "order" => m.off_order = !on,
            "dotl" => m.dot_l = on,
            "implicitassign" => m.implicit_assign = on,
            "uni" => m.universal = on,
            "warning" => m.warnings = on,
            "strictsingleton" => m.loose_singleton = !on,
            "end" => self.on_end = on,
            // `$offText` and its kin without their partner do nothing.
            "text" | "echo" | "put" if !on => {}
            w if self.marks.switch(w, on) => self.marks_changed(),
            w if SILENT_SWITCHES.contains(&w) => {}
            _ => return false,
        }
        self.modes.push((self.map.expanded().len() as u32, modes));
        true
    }

    /// A directive with arguments. `from` is where its name begins, `at` where it ends.
    fn directive(
        &mut self,
        line: &Line,
        word: &str,
        from: usize,
        mut at: usize,
        known: &dyn Known,
    ) -> Outcome<()> {
        let text = line.text.as_str();
        // `$ifThen.tag`, `$abort.noError`
        let (suffix, len) = tag_of(text, at);
        at += len;
        let (lo, hi) = line.origin(from.saturating_sub(1), text.trim_end().len().max(from));
        let rest = &text[at..];
        match word {
            "title" => self.map.title = Some(rest.trim().to_owned()),
            "log" => self.host.print(&format!("{}\n", rest.trim())),
            "ontext" => return self.comment_block(line),
            "include" => {
                let name = file_name(rest).to_owned();
                return self.include(&name, None, lo, hi);
            }
            "batinclude" | "libinclude" | "sysinclude" => {
                let (name, mut tail) = argument(rest);
                let mut arguments = Vec::new();
                while !tail.trim().is_empty() {
                    let (a, t) = argument(tail);
                    arguments.push(a.to_owned());
                    tail = t;
                }
                let outcome = self.include(name, Some(arguments), lo, hi);
                let missing =
                    word == "libinclude" && matches!(&outcome, Err(d) if d.code == "E0103");
                if missing && EXPORTS.contains(&name.to_lowercase().as_str()) {
                    let span = self.place(lo, hi);
                    self.warnings.push(passed_over(
                        span,
                        format!("`{name}` belongs to the library of a GAMS installation, which is not there"),
                    ));
                    return Ok(());
                }
                return outcome.map_err(|d| match (word, d.code) {
                    ("libinclude" | "sysinclude", "E0103") => Box::new(
                        Diagnostic::error("E0112", d.span)
                            .says(format!("`{name}` belongs to the library of a GAMS installation, which is not there"))
                            .help("put the file beside the model, or do without it"),
                    ),
                    _ => d,
                });
            }
            "set" | "setlocal" | "setglobal" | "eval" | "evallocal" | "evalglobal" => {
                // Behind a value in quotes the line goes on: `$set x 'a' set y 'b' $set z c`.
                let dollar = self.marks.dollar as char;
                let next = quoted(argument(rest).1.trim_start())
                    .map(|(_, behind)| behind)
                    .filter(|b| word.starts_with("set") || b.trim_start().starts_with(dollar));
                let end = rest.len() - next.map_or(0, str::len);
                self.define(word, suffix == "set", &rest[..end], lo, hi, known)?;
                let next = behind_separators(next.unwrap_or_default());
                if next.is_empty() {
                    return Ok(());
                }
                let mark = usize::from(next.starts_with(dollar));
                return self.directives(line, text.len() - next.len() + mark, known);
            }
            "drop" | "droplocal" | "dropglobal" => {
                let (name, _) = argument(rest);
                self.names.drop(reach(word), name);
            }
            "setenv" => {
                let (name, value) = argument(rest.trim_start());
                let value = unquoted(value).to_owned();
                self.environment.insert(name.to_lowercase(), value);
            }
            "dropenv" => {
                self.environment.remove(&rest.trim().to_lowercase());
            }
            "prefixpath" => {}
            "phantom" => self.map.phantom = Some(argument(rest).0.into()),
            "setargs" => {
                let frame = self.frames.last();
                let values = frame.and_then(|f| f.arguments.clone()).unwrap_or_default();
                // The last name takes all that is left.
                let names: Vec<&str> = rest.split_whitespace().collect();
                for (i, name) in names.iter().enumerate() {
                    let is_last = i + 1 == names.len();
                    let end = if is_last { values.len() } else { i + 1 };
                    let value = values.get(i..end).unwrap_or_default().join(" ");
                    self.names.set(Reach::Local, name, value);
                }
            }
            "setcomps" => {
                let (all, tail) = argument(rest);
                let components = all.split('.').chain(std::iter::repeat(""));
                for (name, value) in tail.split_whitespace().zip(components) {
                    self.names.set(Reach::Scoped, name, value.to_owned());
                }
            }
            "setnames" => {
                let (file, tail) = argument(rest);
                let path = std::path::Path::new(file);
                let words = |part: Option<&std::ffi::OsStr>| {
                    part.map_or(String::new(), |p| p.to_string_lossy().into_owned())
                };
                let mut dir = words(path.parent().map(|p| p.as_os_str()));
                if !dir.is_empty() {
                    dir.push('/');
                }
                let stem = words(path.file_stem());
                let ext = path.extension().map(|e| format!(".{}", words(Some(e))));
                let parts = [dir, stem, ext.unwrap_or_default()];
                for (name, value) in tail.split_whitespace().zip(parts) {
                    self.names.set(Reach::Scoped, name, value);
                }
            }
            "splitoption" => {
                // `-key=value`, `/key value`: what begins otherwise is no option.
                let (option, tail) = argument(rest);
                let option = option.trim_start().strip_prefix(['-', '/']).unwrap_or("");
                let end = option.find(['=', ' ']).unwrap_or(option.len());
                let (key, value) = option.split_at(end);
                let value = value.trim_start();
                let value = value.strip_prefix('=').unwrap_or(value).trim();
                let quoted = |q| value.strip_prefix(q)?.strip_suffix(q);
                let value = quoted('\'').or(quoted('"')).unwrap_or(value);
                for (name, value) in tail.split_whitespace().zip([key, value]) {
                    self.names.set(Reach::Scoped, name, value.to_owned());
                }
            }
            "shift" => {
                if let Some(args) = self.frames.last_mut().and_then(|f| f.arguments.as_mut())
                    && !args.is_empty()
                {
                    args.remove(0);
                }
            }
            "if" | "ifi" | "ife" => {
                let flavour = flavour(&word[2..]);
                match self.condition(rest, flavour, known) {
                    Err(why) => return self.bad_condition(word, why, lo, hi).refuse(),
                    Ok((false, len)) if rest[len..].trim().is_empty() => {
                        // With nothing behind it, it speaks of the next line, whatever that is.
                        self.take_line();
                    }
                    Ok((false, _)) => {}
                    Ok((true, len)) => return self.action(line, at + len, known),
                }
            }
            "ifthen" | "iftheni" | "ifthene" => {
                let flavour = flavour(&word[6..]);
                match self.condition(rest, flavour, known) {
                    Err(why) => {
                        // Its `$endIf` is not to blame.
                        self.if_then(line, suffix, true, known)?;
                        return self.bad_condition(word, why, lo, hi).refuse();
                    }
                    Ok((truth, len)) => {
                        self.if_then(line, suffix, truth, known)?;
                        if truth {
                            return self.action(line, at + len, known);
                        }
                    }
                }
            }
            "else" | "elseif" | "elseifi" | "elseife" | "endif" => {
                if !self.branch(line, known)? {
                    self.leave_out(known)?;
                }
            }
            "goto" => return self.goto(rest, lo, hi),
            "label" => {
                let behind = argument(rest).1.trim_start();
                if behind.starts_with(self.marks.dollar as char) {
                    return self.directives(line, text.len() - behind.len() + 1, known);
                }
            }
            "exit" => {
                // What is left of the present file is not read.
                let listed = self.listed();
                if let Some(frame) = self.frames.last_mut() {
                    frame.pos = frame.len;
                    frame.ifs.clear();
                }
                self.set_listed(listed);
            }
            "stop" => self.stop(Ending::Regular),
            "terminate" => self.stop(Ending::NoRun),
            "abort" if suffix == "noerror" => {
                self.host.print(&format!("{}\n", rest.trim()));
                self.stop(Ending::NoRun);
            }
            "abort" | "error" => {
                let span = self.place(lo, hi);
                let message = match rest.trim() {
                    "" => "stopped here",
                    _ => unquoted(rest),
                };
                let d = Diagnostic::error("E0110", span)
                    .says(message)
                    .label(format!("`${word}` stands here"));
                if word == "abort" {
                    self.stop(Ending::Aborted);
                }
                return d.refuse();
            }
            "clearerror" | "clearerrors" => self.cleared_errors = known.errors(),
            "macro" => return self.define_macro(rest, lo, hi),
            "escape" => {
                let mark = rest.trim().bytes().next();
                self.marks.escape = mark.filter(|&c| c != b'%');
            }
            "eolcom" | "inlinecom" | "comment" | "dollar" => {
                let behind = self.set_mark(word, rest, lo, hi)?;
                return self.further_directive(line, behind, known);
            }
            "maxcol" | "mincol" => {
                let (number, behind) = argument(rest);
                let column = match word {
                    "maxcol" => &mut self.marks.columns.1,
                    _ => &mut self.marks.columns.0,
                };
                *column = number.parse().map_or(*column, |n: usize| n.max(1));
                return self.further_directive(line, behind, known);
            }
            "maxgoto" => {
                let jumps = rest.trim().parse().unwrap_or(self.max_jumps);
                self.max_jumps = jumps.min(self.most_jumps);
            }
            "echo" | "echon" => {
                let (body, file) = rest.rsplit_once('>').unwrap_or((rest, ""));
                let text = unquoted(body.trim_end_matches('>')).to_owned()
                    + if word == "echo" { "\n" } else { "" };
                let append = body.ends_with('>');
                let span = self.place(lo, hi);
                self.echo(file_name(file), &text, append, span);
            }
            "onecho" | "onechos" | "onechov" => {
                return self.echo_block(line, word, &suffix, rest, lo, hi);
            }
            "onput" | "onputs" | "onputv" => return self.put_block(word, &suffix, lo, hi),
            "call" | "hiddencall" | "execute" => {
                let span = self.place(lo, hi);
                let from = self.frames.last().map(|f| f.path.clone());
                if let Some(made) = conversion(rest)
                    && self.host.exists(&made, from.as_deref())
                {
                    self.warnings.push(
                        Diagnostic::warning("E0113", span)
                            .says(format!(
                                "`${word}` starts no program: `{made}` is read as it is there"
                            ))
                            .label("not run")
                            .help("run the program again yourself where its source has changed"),
                    );
                    return Ok(());
                }
                return Diagnostic::error("E0113", span)
                    .says(format!("`${word}` would start another program, which is refused"))
                    .label("not run")
                    .help("run it yourself before the model, and read what it writes with `$include` or `$load`")
                    .refuse();
            }
            "onembeddedcode" | "onembeddedcodes" | "onembeddedcodev" => {
                let span = self.place(lo, hi);
                let mut gives_back = !rest.trim_start().to_lowercase().starts_with("connect");
                self.collect_to("offembeddedcode", &suffix, &mut |line, _| {
                    gives_back |= line.to_lowercase().contains("gamswriter");
                });
                let d = embedded_code(span, gives_back);
                if gives_back {
                    return d.refuse();
                }
                self.warnings.push(d);
            }
            "gdxin" | "gdxout" | "gdxload" | "gdxloadall" | "gdxunload" | "load" | "loaddc"
            | "loadm" | "loadr" | "loaddcm" | "loaddcr" | "loadfiltered" | "loadidx" | "unload"
            | "kill" | "clear" => {
                // The parser reads these; the line goes into the text as a statement.
                let line = line.clone();
                let end = line.text.len();
                line.emit(&mut self.map, from.saturating_sub(1), end);
                let (_, hi) = line.origin(0, end);
                let file = self.frames.last().map_or(super::FileId(0), |f| f.file);
                self.map.push_substitute(";\n", file, hi, hi);
            }
            w if SILENT_LINES.contains(&w) => {}
            _ => {
                let span = self.place(lo, hi);
                if rest.trim_start().starts_with('(') {
                    // A condition that was moved to the first column: the line is read as it is meant.
                    let line = line.clone();
                    let file = self.frames.last().map_or(super::FileId(0), |f| f.file);
                    self.map.push_substitute(" ", file, lo, lo);
                    line.emit(&mut self.map, from.saturating_sub(1), line.text.len());
                    return Diagnostic::error("E0107", span)
                        .says("a `$` in the first column begins a directive")
                        .help("put a blank before the condition")
                        .refuse();
                }
                let names = OTHERS.iter().chain(SILENT).map(|s| (*s).to_owned());
                let switches = SILENT_SWITCHES.iter();
                let switches = switches.flat_map(|s| [format!("on{s}"), format!("off{s}")]);
                let all: Vec<String> = names.chain(switches).collect();
                let near = nearest(word, all.iter().map(String::as_str));
                let help = near.map_or(
                    "take the line out; docs/language.md lists the directives".into(),
                    |n| format!("did you mean `${n}`?"),
                );
                return Diagnostic::error("E0107", span)
                    .says(format!("there is no directive `${word}`"))
                    .help(help)
                    .refuse();
            }
        }
        Ok(())
    }

    fn bad_condition(&mut self, word: &str, why: String, lo: u32, hi: u32) -> Diagnostic {
        let span = self.place(lo, hi);
        Diagnostic::error("E0114", span)
            .says(format!("the condition of `${word}` cannot be read: {why}"))
            .help("for example `$if set x`, `$if not exist 'data.inc'`, `$if %n% == 3`, `$ifE %n% > 3`")
    }

    /// What follows a true condition, as at the begin of a line: a directive, a text, a comment, or nothing.
    fn action(&mut self, line: &Line, at: usize, known: &dyn Known) -> Outcome<()> {
        let rest = &line.text[at..];
        let start = at + rest.len() - rest.trim_start().len();
        let Some(&first) = line.text.as_bytes().get(start) else {
            return Ok(());
        };
        if first == self.marks.comment {
            return Ok(());
        }
        if first == self.marks.dollar {
            if self.conditions_on_line >= 50 {
                let (lo, hi) = line.origin(0, line.text.len());
                let span = self.place(lo, hi);
                return Diagnostic::error("E0114", span)
                    .says("more than 50 conditions on one line")
                    .help("use `$ifThen … $endIf` blocks")
                    .refuse();
            }
            self.conditions_on_line += 1;
            let outcome = self.directives(line, start + 1, known);
            self.conditions_on_line -= 1;
            return outcome;
        }
        self.finish_text(line.clone(), start)
    }

    /// `$else`, `$elseIf`, `$endIf`: whether the lines that follow count.
    pub(super) fn branch(&mut self, line: &Line, known: &dyn Known) -> Outcome<bool> {
        let text = line.text.as_str();
        let (word, mut at) = self.marks.directive_name(text).unwrap_or_default();
        let word = word.to_ascii_lowercase();
        let (tag, len) = tag_of(text, at);
        at += len;
        let (lo, hi) = line.origin(0, text.trim_end().len().max(1));
        let Some(open) = self.frames.last_mut().and_then(|f| f.ifs.last_mut()) else {
            let span = self.place(lo, hi);
            return Diagnostic::error("E0106", span)
                .says(format!(
                    "`${word}` without an `$ifThen` before it in this file"
                ))
                .help("`$if` on one line needs no `$endIf`; blocks begin with `$ifThen`")
                .refuse();
        };
        if open.tag != tag {
            let (at, expected) = (open.span, open.tag.clone());
            if let Some(f) = self.frames.last_mut()
                && word == "endif"
            {
                f.ifs.pop();
            }
            let span = self.place(lo, hi);
            return Diagnostic::error("E0106", span)
                .says(format!(
                    "`${word}.{tag}` does not belong to the innermost open `$ifThen`"
                ))
                .other(at, "which is this one")
                .help(if expected.is_empty() {
                    format!("write `${word}`")
                } else {
                    format!("write `${word}.{expected}`")
                })
                .refuse();
        }
        match word.as_str() {
            "endif" => {
                if let Some(f) = self.frames.last_mut() {
                    f.ifs.pop();
                }
                // Only a directive may follow, with its `$` or without.
                let behind = text[at..].trim_start();
                if self.is_directive(behind) {
                    let dollar = usize::from(behind.starts_with(self.marks.dollar as char));
                    self.directives(line, text.len() - behind.len() + dollar, known)?;
                }
                Ok(true)
            }
            _ if open.taken => Ok(false),
            "else" => {
                open.taken = true;
                self.action(line, at, known)?;
                Ok(true)
            }
            _ => {
                let flavour = flavour(&word[6..]);
                match self.condition(&text[at..], flavour, known) {
                    Err(why) => self.bad_condition(&word, why, lo, hi).refuse(),
                    Ok((truth, len)) => {
                        if let Some(open) = self.frames.last_mut().and_then(|f| f.ifs.last_mut()) {
                            open.taken = truth;
                        }
                        if truth {
                            self.action(line, at + len, known)?;
                        }
                        Ok(truth)
                    }
                }
            }
        }
    }

    /// `$set x value`, `$eval x expression` and their kin.
    fn define(
        &mut self,
        word: &str,
        of_set: bool,
        rest: &str,
        lo: u32,
        hi: u32,
        known: &dyn Known,
    ) -> Outcome<()> {
        let rest = rest.trim_start();
        let len = rest
            .bytes()
            .position(|c| !c.is_ascii_alphanumeric() && c != b'_' && c != b'.')
            .unwrap_or(rest.len());
        let (name, value) = (&rest[..len], rest[len..].trim());
        if name.is_empty() {
            let span = self.place(lo, hi);
            return Diagnostic::error("E0107", span)
                .says(format!("`${word}` needs a name"))
                .help(format!(
                    "write `${word} name value`; then `%name%` stands for the value"
                ))
                .refuse();
        }
        let value = if word.starts_with("eval") && of_set {
            // `$eval.set X i.te`
            let (set, what) = value.split_once('.').unwrap_or((value, ""));
            match known.set_text(set, what) {
                Some(text) => text,
                None => {
                    let span = self.place(lo, hi);
                    return Diagnostic::error("E0115", span).says(format!("`${word}.set {name}`: there is no text `{value}`")).help(
                        "write the name of a set with elements and `.tl`, `.te`, `.ts`, `.firstTL`, `.lastTE` …",
                    )
                        .refuse();
                }
            }
        } else if word.starts_with("eval") {
            let value = match quoted(value) {
                Some((inside, "")) => inside,
                _ => value,
            };
            match evaluate(value, known) {
                // Without a value it is UNDF, which only `$onUndf` lets pass.
                Ok((x, _)) if x.is_nan() && self.modes.last().is_none_or(|m| !m.1.undf) => {
                    self.names.set(reach(word), name, number_text(x));
                    let span = self.place(lo, hi);
                    return Diagnostic::error("E0115", span)
                        .says(format!("`${word} {name}`: `{value}` has no value"))
                        .help("`%name%` stands for UNDF after it")
                        .refuse();
                }
                Ok((x, n)) if value[n..].trim().is_empty() => number_text(x),
                Ok((_, n)) => {
                    let message = format!(
                        "`${word} {name}`: the expression ends before `{}`",
                        value[n..].trim()
                    );
                    let span = self.place(lo, hi);
                    return Diagnostic::error("E0115", span)
                        .says(message)
                        .help("is an operator missing?")
                        .refuse();
                }
                Err(why) => {
                    let span = self.place(lo, hi);
                    return Diagnostic::error("E0115", span)
                        .says(format!("`${word} {name}` cannot be evaluated: {why}"))
                        .help("numbers, operators, functions, `card(set)` and scalars with data can stand here")
                        .refuse();
                }
            }
        } else {
            unquoted(value).to_owned()
        };
        self.names.set(reach(word), name, value);
        Ok(())
    }

    fn define_macro(&mut self, rest: &str, lo: u32, hi: u32) -> Outcome<()> {
        let mut text = rest.to_owned();
        let mut hi = hi;
        while text.trim_end().ends_with('\\') {
            text.truncate(text.trim_end().len() - 1);
            if self.frames.last().is_none_or(|f| f.pos >= f.len) {
                break;
            }
            let next = self.take_line();
            // Comments may stand between the lines.
            if next.text.as_bytes().first() == Some(&self.marks.comment) {
                text.push('\\');
                continue;
            }
            let name = self.marks.directive_name(&next.text);
            if name.is_some_and(|(name, _)| name.eq_ignore_ascii_case("ontext")) {
                self.comment_block(&next)?;
                text.push('\\');
                continue;
            }
            hi = next.origin(0, next.text.len()).1;
            let next = self.directive_text(next)?;
            text.push(' ');
            text.push_str(&next.text);
        }
        let replace = self.modes.last().is_some_and(|m| m.1.multi_replace);
        self.macros.define(&text, replace).map_err(|why| {
            let span = self.place(lo, hi);
            Box::new(
                Diagnostic::error("E0111", span)
                    .says(why)
                    .help("`$macro name(a,b) text with a and b`"),
            )
        })
    }

    /// Gives what stands behind the marks.
    fn set_mark<'t>(&mut self, word: &str, rest: &'t str, lo: u32, hi: u32) -> Outcome<&'t str> {
        let Some(behind) = self.marks.set(word, rest) else {
            let span = self.place(lo, hi);
            let example = match word {
                "inlinecom" => "$inlineCom { }",
                "eolcom" => "$eolCom !!",
                "comment" => "$comment *",
                _ => "$dollar #",
            };
            return Diagnostic::error("E0107", span)
                .says(format!("`${word}` needs its mark"))
                .help(format!("for example `{example}`"))
                .refuse();
        };
        self.marks_changed();
        Ok(behind)
    }
}

fn reach(word: &str) -> Reach {
    if word.ends_with("local") {
        Reach::Local
    } else if word.ends_with("global") {
        Reach::Global
    } else {
        Reach::Scoped
    }
}

fn flavour(suffix: &str) -> Flavour {
    match suffix {
        "i" => Flavour::NoCase,
        "e" => Flavour::Numeric,
        _ => Flavour::Exact,
    }
}
