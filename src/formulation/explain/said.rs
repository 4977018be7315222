//! Sentences about rows and columns: what one is worth, and one sentence for all of which the same is said.

use super::Explained;
use crate::formulation::range::RowRange;
use crate::formulation::side::short;
use crate::model::origin::Blocks;
use crate::report::format::counted;

/// More records than this are not named; more sentences of one kind are not said.
pub(super) const MAX_NAMES: usize = 12;
/// More sentences than this about one block are summed up in one.
const MAX_SENTENCES: usize = 4;
/// Of records that are said the same of, so many are named.
const MAX_ALIKE: usize = 4;

/// What is said of a row or a column.
pub(super) struct Said {
    /// Its number.
    pub(super) at: usize,
    /// Its verb, of one and of many.
    pub(super) verb: [&'static str; 2],
    /// What completes the verb.
    pub(super) place: String,
    /// What follows.
    pub(super) words: String,
    /// What is said in place of that where there are many different numbers, and the number.
    pub(super) lead: String,
    pub(super) number: f64,
}

impl Explained<'_> {
    /// Sentences: one for the records of a block that say the same, and one for a block whose records say too much.
    pub(super) fn told(&self, blocks: &Blocks, kind: &str, all: Vec<Said>) -> Vec<String> {
        let class = |s: &&Said| (blocks.of(s.at as u32).start, s.verb[0], s.lead.clone());
        let words = |s: &&Said| (s.place.clone(), s.words.clone());
        let mut sorted: Vec<&Said> = all.iter().collect();
        sorted.sort_by_cached_key(|s| (class(s), words(s)));
        let mut out: Vec<(String, usize)> = Vec::new();
        for each in sorted.chunk_by(|a, b| class(a) == class(b)) {
            let block = blocks.of(each[0].at as u32);
            let (whole, name) = (block.len as usize, &self.scope.get(block.symbol).name);
            let mut alike: Vec<&[&Said]> = each.chunk_by(|a, b| words(a) == words(b)).collect();
            alike.sort_by_key(|a| a[0].at);
            if alike.len() > MAX_SENTENCES {
                let by = |a: &&&Said, b: &&&Said| a.number.total_cmp(&b.number);
                let end = |s: &Said| format!("{} ({})", short(s.number), self.name(blocks, s.at));
                let numbers = match (each.iter().min_by(by), each.iter().max_by(by)) {
                    (Some(a), Some(b)) if short(a.number) != short(b.number) => {
                        format!("between {} and {}", end(a), end(b))
                    }
                    (a, _) => a.map_or(String::new(), |a| short(a.number)),
                };
                let of = match each.len() {
                    n if n == whole => format!("All {n}"),
                    n => format!("{n} of the {whole}"),
                };
                let Said { verb, lead, .. } = each[0];
                let sentence = format!("{of} {kind}s of {name} {}: {lead} {numbers}.", verb[1]);
                out.push((sentence, each.len()));
                continue;
            }
            for alike in alike {
                let s = alike[0];
                let names = alike.iter().map(|s| self.name(blocks, s.at));
                let names = match alike.len() {
                    n if n == whole && n > 2 => format!("All {n} {kind}s of {name}"),
                    _ => listed(&names.collect::<Vec<_>>(), MAX_ALIKE),
                };
                let many = usize::from(alike.len() > 1);
                let each = match s.words.is_empty() {
                    true => "",
                    false => [": ", "; for each, "][many],
                };
                let sentence = format!("{names} {}{}{each}{}.", s.verb[many], s.place, s.words);
                out.push((sentence, alike.len()));
            }
        }
        let more: usize = out.iter().skip(MAX_NAMES).map(|s| s.1).sum();
        out.truncate(MAX_NAMES);
        let mut out: Vec<String> = out.into_iter().map(|s| s.0).collect();
        if let Some(s) = all.first().filter(|_| more > 0) {
            let (of, verb) = (
                counted(more, &format!("more {kind}")),
                s.verb[usize::from(more > 1)],
            );
            out.push(format!("{of} {verb}."));
        }
        out
    }
}

/// What a row's right side is worth: what is said of many, the number of this one, and what is said of it.
pub(super) fn worth(
    range: Option<&RowRange>,
    marginal: f64,
    objective: &str,
    linear: bool,
) -> (String, f64, String) {
    let Some(r) = range else {
        let by = short(marginal);
        let (lead, words) = match linear {
            true => (
                "their marginals are".into(),
                format!("its marginal is {by}"),
            ),
            false => (
                format!("a little more on a right side changes {objective}, per unit, by"),
                format!("a little more on its right side changes {objective} by {by} per unit"),
            ),
        };
        return (lead, marginal, words);
    };
    let [below, above] = r.price;
    let [from, to] = r.interval.map(short);
    let limits = match r.interval.map(f64::is_finite) {
        [true, true] => format!(" (from {from} to {to})"),
        [true, false] => format!(" (down to {from})"),
        [false, true] => format!(" (up to {to})"),
        [false, false] => String::new(),
    };
    let on = format!(" on its right side changes {objective} by ");
    let many = format!(" on a right side changes {objective} by");
    let [more, less] = ["a unit more", "a unit less"];
    match r.price.map(f64::is_finite) {
        [false, false] => {
            let words = "with any other right side nothing is feasible";
            (String::new(), 0.0, words.into())
        }
        [true, true] if below == 0.0 && above == 0.0 => {
            let words = "changing its right side a little changes nothing";
            (String::new(), 0.0, words.into())
        }
        [true, true] => {
            let other = match below == above {
                true => String::new(),
                false => format!(", {less} by {}", short(-below)),
            };
            let words = format!("{more}{on}{}{other}{limits}", short(above));
            (format!("{more}{many}"), above, words)
        }
        [false, true] if above == 0.0 => {
            let words = "more on its right side changes nothing, with less nothing is feasible";
            (String::new(), 0.0, words.into())
        }
        [true, false] if below == 0.0 => {
            let words = "less on its right side changes nothing, with more nothing is feasible";
            (String::new(), 0.0, words.into())
        }
        [one, _] => {
            let (unit, other, by) = match one {
                false => (more, "less", above),
                true => (less, "more", -below),
            };
            let lead = format!("with {other} on a right side nothing is feasible, {unit}{many}");
            let words = format!(
                "{unit}{on}{}{limits}, with {other} nothing is feasible",
                short(by)
            );
            (lead, by, words)
        }
    }
}

/// Names with commas, the last after "and"; of more than `most` only the first and how many others there are.
pub(super) fn listed(names: &[String], most: usize) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] if names.len() <= most => format!("{} and {last}", first.join(", ")),
        _ => {
            let (first, others) = names.split_at(most - 1);
            format!("{} and {} others", first.join(", "), others.len())
        }
    }
}
