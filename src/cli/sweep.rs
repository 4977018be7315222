//! `bmod sweep`: a model for every combination of values, on the cores of this machine or as a job array.
//!
//! Rows go to `rows-*.jsonl` in the folder while they come, each in one write. A run that is there, with the same key, is not
//! repeated; half a line that a killed process has left is cut off. `results.csv` is written whole at the end, in the order of the grid.

use super::args::{EXECUTION, INTERRUPT, SweepArgs, USAGE};
use super::commands::{Status, complain, stem};
use super::host::{interrupted, say, styled, write_whole};
use crate::{Control, Error, Model, ModelStatus, Options, Run, SymbolKind};
use indicatif::ProgressBar;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, HashMap};
use std::fs::{File, OpenOptions};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

type Row = Map<String, Value>;

/// A value of each name, as text.
type Point = Vec<(String, String)>;

/// Values that `friction=0.3:0.8:0.05` can stand for at most.
const MOST_VALUES: f64 = 1e6;

/// Carries out `bmod sweep`; its exit status.
pub(super) fn sweep(a: &SweepArgs) -> Status {
    let points = points(&a.model.define).map_err(|why| complain(USAGE, why))?;
    match a.slurm {
        Some(jobs) => slurm(a, jobs, points.len()),
        None => carry_out(a, &points),
    }
    .map_err(|why| complain(EXECUTION, why))
}

/// All combinations; the values of the last name vary fastest.
fn points(define: &[(String, String)]) -> Result<Vec<Point>, String> {
    let mut points: Vec<Point> = vec![Vec::new()];
    for (name, text) in define {
        let values = values(text).map_err(|why| format!("-D {name}={text}: {why}"))?;
        let with = |p: &Point| {
            let p = p.clone();
            let one = move |v: &String| [p.clone(), vec![(name.clone(), v.clone())]].concat();
            values.iter().map(one).collect::<Vec<_>>()
        };
        points = points.iter().flat_map(with).collect();
    }
    Ok(points)
}

/// `0.3:0.8:0.05` (first, last, step), `1,-1`, `x`.
fn values(text: &str) -> Result<Vec<String>, String> {
    let parts: Vec<&str> = text.split(':').collect();
    if let [first, last, step] = parts[..] {
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let (Some(a), Some(b), Some(h)) = (number(first), number(last), number(step)) else {
            return Err("a range is FIRST:LAST:STEP, of numbers".into());
        };
        let count = ((b - a) / h + 1e-9).floor() + 1.0;
        if h == 0.0 || !(1.0..=MOST_VALUES).contains(&count) {
            return Err(format!("a step of {h} does not lead from {a} to {b}"));
        }
        // As many decimals as the text has: 0.3 + 2·0.05 is 0.4.
        let decimals = |t: &str| t.trim().split_once('.').map_or(0, |(_, d)| d.len());
        let digits = decimals(first).max(decimals(step));
        let exact = |v: f64| match text.contains(['e', 'E']) {
            true => v,
            false => format!("{v:.digits$}").parse().unwrap_or(v),
        };
        let value = |k: usize| exact(a + k as f64 * h).to_string();
        return Ok((0..count as usize).map(value).collect());
    }
    Ok(text.split(',').map(|v| v.trim().to_string()).collect())
}

/// The model with each name of a point as a `%name%` of the text.
fn defined(base: &Model, point: &Point) -> Model {
    let mut model = base.clone();
    for (name, value) in point {
        model.define(name, value);
    }
    model
}

/// The model at a point: a name is a `%name%` of the text, and a scalar of the model if it has one.
fn model_at(base: &Model, point: &Point) -> Model {
    let mut model = defined(base, point);
    model.keep(true);
    let declared = model.check();
    for (name, value) in point {
        if let (true, Ok(v)) = (is_scalar(&declared, name), value.parse()) {
            model.set_scalar(name, v);
        }
    }
    model
}

fn is_scalar(declared: &Run, name: &str) -> bool {
    let symbol = declared.symbol(name).ok();
    symbol.is_some_and(|s| s.kind() == SymbolKind::Parameter && s.dimension() == 0)
}

/// Whether every name stands for something at some point, and every scalar's value is a number. A model that does not
/// compile says so in its rows.
fn check_names(base: &Model, points: &[Point]) -> Result<(), String> {
    let mut idle: Vec<String> = points.first().map_or_else(Vec::new, |p| {
        p.iter().map(|(name, _)| name.clone()).collect()
    });
    for point in points {
        if idle.is_empty() {
            return Ok(());
        }
        let declared = defined(base, point).check();
        if !declared.succeeded() {
            return Ok(());
        }
        let unused = declared.unused_defines();
        idle.retain(|n| !is_scalar(&declared, n) && unused.contains(&n.to_ascii_lowercase()));
        let scalars = point.iter().filter(|(n, _)| is_scalar(&declared, n));
        let wrong = |v: &str| !v.parse::<f64>().is_ok_and(f64::is_finite);
        for (name, _) in scalars {
            let values = points
                .iter()
                .flat_map(|p| p.iter().filter(|(n, _)| n == name));
            if let Some((_, v)) = values.into_iter().find(|(_, v)| wrong(v)) {
                return Err(format!(
                    "-D {name}: `{name}` is a scalar, `{v}` is no finite number; values are `1,2,5` or FIRST:LAST:STEP"
                ));
            }
        }
    }
    match idle.first() {
        None => Ok(()),
        Some(name) => Err(format!(
            "-D {name}: the model asks for no `%{name}%`, and has no scalar of this name; all runs would be the same"
        )),
    }
}

/// What came of a run, as a row: the columns are those of `bmod.sweep` in Python.
fn row(run: &Run, outputs: &[String]) -> Result<Row, Error> {
    let mut row = Row::new();
    row.insert("run".into(), json!(run.status()));
    row.insert("messages".into(), json!(run.messages()));
    row.insert("stopped".into(), json!(run.was_stopped()));
    if let Some(last) = run.solves().last() {
        let seconds: f64 = run.solves().iter().map(|s| s.seconds.total).sum();
        row.insert("status".into(), json!(snake(last.model_status)));
        row.insert("objective".into(), json!(last.objective));
        row.insert("solver".into(), json!(last.solver));
        row.insert("iterations".into(), json!(last.iterations));
        row.insert("primal".into(), json!(last.residuals.primal));
        row.insert("seconds".into(), json!(seconds));
    }
    if !run.succeeded() {
        return Ok(row);
    }
    for name in outputs {
        let symbol = run.symbol(name)?;
        let columns = symbol.columns();
        let values = columns.values.first().map_or(&[][..], |c| &c.1);
        for (r, &v) in values.iter().enumerate() {
            let key = match columns.keys.dimension() {
                0 => name.clone(),
                _ => format!("{name}[{}]", columns.keys.key(r).join(",")),
            };
            row.insert(key, json!(v));
        }
    }
    Ok(row)
}

/// `LocallyOptimal` as `locally_optimal`.
fn snake(status: ModelStatus) -> String {
    let mut out = String::new();
    for c in format!("{status:?}").chars() {
        if c.is_uppercase() && !out.is_empty() {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// The rows of a folder: those that were there, and a file for those to come.
struct Store {
    /// By key; of those with the same one, files that the run read may have changed since.
    known: HashMap<String, Vec<Row>>,
    file: File,
}

impl Store {
    fn open(folder: &Path, own: &str) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let mut known = HashMap::default();
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with("rows-") && name.ends_with(".jsonl") {
                let text = std::fs::read_to_string(&path)?;
                let rows = text.lines().filter_map(|l| serde_json::from_str(l).ok());
                for row in rows {
                    remember(&mut known, row);
                }
            }
        }
        let path = folder.join(own);
        let file = OpenOptions::new().create(true).append(true).open(&path)?;
        let text = std::fs::read(&path)?;
        let whole = memchr::memrchr(b'\n', &text).map_or(0, |at| at + 1);
        if whole < text.len() {
            file.set_len(whole as u64)?;
        }
        Ok(Self { known, file })
    }

    fn add(&mut self, row: &Row) -> std::io::Result<()> {
        let line = format!("{}\n", Value::Object(row.clone()));
        self.file.write_all(line.as_bytes())
    }

    /// The row of a run, if what it read is as it was.
    fn find(&self, key: &str, model: &Model) -> Option<&Row> {
        let same = |r: &&Row| {
            let reads = r.get("reads").and_then(Value::as_str);
            reads.is_some_and(|reads| model.still_reads(reads))
        };
        self.known.get(key)?.iter().find(same)
    }
}

fn remember(known: &mut HashMap<String, Vec<Row>>, row: Row) {
    if let Some(key) = row.get("key").and_then(Value::as_str) {
        known.entry(key.to_string()).or_default().push(row);
    }
}

fn carry_out(a: &SweepArgs, points: &[Point]) -> Result<u8, String> {
    let mut base = Model::from_file(&a.model.file).map_err(|e| e.to_string())?;
    if a.model.sandbox {
        base.sandbox();
    }
    for folder in &a.model.allow_read {
        base.allow_read(folder);
    }
    let mut options = Options::default();
    for (name, value) in &a.solve.option {
        options = options.option(name, value);
    }
    if let Some(seconds) = a.solve.time_limit {
        options = options.time_limit(seconds);
    }
    check_names(&base, points)?;
    let outputs: Vec<&str> = a.output.iter().map(String::as_str).collect();
    let (part, parts) = a.part.unwrap_or((1, 1));
    let own = format!("rows-{part}.jsonl");
    let folder = &a.out;
    let in_folder = |e: std::io::Error| format!("{}: {e}", folder.display());
    let store = Mutex::new(Store::open(folder, &own).map_err(in_folder)?);
    let next = AtomicUsize::new(part - 1);
    let rows: Mutex<BTreeMap<usize, Row>> = Mutex::default();
    let failed: Mutex<Option<String>> = Mutex::default();
    let bar = bar(points.len().div_ceil(parts));
    let controls: Vec<Control> = (0..a.jobs).map(|_| Control::new()).collect();
    let over = AtomicBool::new(false);
    let work = |control: &Control| {
        let options = options.clone().control(control);
        while !control.is_cancelled() {
            let n = next.fetch_add(parts, Ordering::Relaxed);
            let Some(point) = points.get(n) else { break };
            let model = model_at(&base, point);
            let key = model.digest(&options, &outputs);
            let found = locked(&store).find(&key, &model).cloned();
            if let Some(row) = found {
                locked(&rows).insert(n, row);
            } else {
                let run = model.run(&options);
                // What Ctrl-C has stopped is run again next time.
                if control.is_cancelled() {
                    break;
                }
                let stored = row(&run, &a.output)
                    .map_err(|e| e.to_string())
                    .and_then(|found| {
                        let point = point.iter().map(|(k, v)| (k.clone(), typed(v)));
                        let own = [("key", json!(key)), ("reads", json!(run.reads()))];
                        let own = own.map(|(k, v)| (k.to_string(), v));
                        let all = Row::from_iter(own.into_iter().chain(point).chain(found));
                        locked(&store).add(&all).map_err(in_folder)?;
                        locked(&rows).insert(n, all);
                        Ok(())
                    });
                if let Err(why) = stored {
                    *locked(&failed) = Some(why);
                    break;
                }
            }
            bar.inc(1);
        }
    };
    std::thread::scope(|scope| {
        // Ctrl-C reaches every run.
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                if interrupted() {
                    controls.iter().for_each(Control::cancel);
                }
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        let workers: Vec<_> = controls.iter().map(|c| scope.spawn(|| work(c))).collect();
        for worker in workers {
            let _ = worker.join();
        }
        over.store(true, Ordering::Relaxed);
    });
    bar.finish_and_clear();
    if let Some(why) = locked(&failed).take() {
        return Err(why);
    }
    let rows = locked(&rows);
    let rows: Vec<&Row> = rows.values().collect();
    if parts == 1 {
        let path = folder.join("results.csv");
        let names: Vec<&str> = a.model.define.iter().map(|d| d.0.as_str()).collect();
        let text = table(&rows, &names, &outputs).map_err(|e| e.to_string())?;
        write_whole(&path, &text).map_err(in_folder)?;
    }
    let status = summary(&rows, points.len().div_ceil(parts), folder);
    if interrupted() {
        let message = "interrupted; runs that are there are not repeated";
        return Ok(complain(INTERRUPT, message));
    }
    Ok(status)
}

fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A number where it is one.
fn typed(value: &str) -> Value {
    let number = value.parse::<f64>().ok().filter(|v| v.is_finite());
    number.map_or_else(|| json!(value), |v| json!(v))
}

/// Columns behind those of the values and outputs.
#[rustfmt::skip]
const ABOUT: &[&str] = &[
    "run", "status", "objective", "solver", "iterations", "primal", "seconds", "stopped",
    "messages",
];

/// Rows as comma-separated values: what is varied, outputs, how the run ended, messages.
fn table(rows: &[&Row], varied: &[&str], outputs: &[&str]) -> Result<Vec<u8>, csv::Error> {
    let mut found: Vec<&str> = Vec::new();
    for row in rows {
        for name in row.keys() {
            if name != "key" && name != "reads" && !found.contains(&name.as_str()) {
                found.push(name);
            }
        }
    }
    let place = |name: &&str| {
        let symbol = name.split('[').next().unwrap_or(name);
        let at = |list: &[&str], name: &str| list.iter().position(|n| *n == name);
        let known = at(varied, name).map(|n| (0, n));
        let known = known.or_else(|| at(ABOUT, name).map(|n| (2, n)));
        known.unwrap_or((1, at(outputs, symbol).unwrap_or(outputs.len())))
    };
    found.sort_by_key(place);
    let names = found;
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(&names)?;
    for row in rows {
        let cell = |name: &&str| match row.get(*name) {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(text)) => text.clone(),
            Some(other) => other.to_string(),
        };
        out.write_record(names.iter().map(cell))?;
    }
    out.into_inner().map_err(|e| e.into_error().into())
}

/// Says what came of the runs; the exit status.
fn summary(rows: &[&Row], wanted: usize, folder: &Path) -> u8 {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for row in rows {
        let text = |name: &str| row.get(name).and_then(Value::as_str);
        let word = match text("run") {
            Some("ok") => text("status").unwrap_or("ran"),
            other => other.unwrap_or("?"),
        };
        *counts.entry(word.replace('_', " ")).or_default() += 1;
    }
    let counts: Vec<String> = counts.iter().map(|(w, n)| format!("{n} {w}")).collect();
    say!(
        "{} of {wanted} runs: {}; see {}",
        rows.len(),
        counts.join(", "),
        folder.display()
    );
    let ran = |row: &&Row| row.get("run").and_then(Value::as_str) == Some("ok");
    match rows.len() < wanted || !rows.iter().any(ran) {
        true => EXECUTION,
        false => 0,
    }
}

fn bar(count: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let template = "{wide_bar} {pos}/{len} runs, {eta} left";
    styled(ProgressBar::new(count as u64), template)
}

/// Writes the script of a job array: each of its tasks takes every N-th point.
fn slurm(a: &SweepArgs, jobs: usize, points: usize) -> Result<u8, String> {
    let jobs = jobs.min(points).max(1);
    let quoted = |t: String| format!("'{}'", t.replace('\'', r"'\''"));
    let mut words = vec!["bmod".to_string(), "sweep".into()];
    words.push(quoted(a.model.file.to_string_lossy().into_owned()));
    let mut add = |flag: &str, value: String| words.extend([flag.to_string(), quoted(value)]);
    for (name, value) in &a.model.define {
        add("-D", format!("{name}={value}"));
    }
    for folder in &a.model.allow_read {
        add("--allow-read", folder.to_string_lossy().into_owned());
    }
    for (name, value) in &a.solve.option {
        add("--option", format!("{name}={value}"));
    }
    if let Some(seconds) = a.solve.time_limit {
        add("--time-limit", seconds.to_string());
    }
    for name in &a.output {
        add("--output", name.clone());
    }
    add("--out", a.out.to_string_lossy().into_owned());
    if a.model.sandbox {
        words.push("--sandbox".into());
    }
    let command = words.join(" ");
    let name = stem(&a.model);
    let text = format!(
        "#!/bin/bash\n#SBATCH --job-name={name}\n#SBATCH --array=1-{jobs}\n#SBATCH --cpus-per-task={cores}\n\n\
         # {points} runs in {jobs} jobs. Runs that are there are not repeated: submit it again after a failure.\n\
         # When all are done, the same command without --part writes results.csv.\n\
         {command} -j {cores} --part \"$SLURM_ARRAY_TASK_ID/{jobs}\"\n",
        cores = a.jobs,
    );
    let path: PathBuf = a.out.join("sweep.sh");
    std::fs::create_dir_all(&a.out)
        .and_then(|()| write_whole(&path, text.as_bytes()))
        .map_err(|e| format!("{}: {e}", path.display()))?;
    let script = match path.to_string_lossy() {
        p if p.contains(' ') => quoted(p.into_owned()),
        p => p.into_owned(),
    };
    say!(
        "written: {}; submit it with `sbatch {script}`",
        path.display()
    );
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What only the run reads counts too.
    #[test]
    fn data_that_have_changed() -> std::io::Result<()> {
        let folder = tempfile::tempdir()?;
        let (file, data) = (folder.path().join("m.blk"), folder.path().join("d.csv"));
        std::fs::write(
            &file,
            "Set i / a /;\nParameter p(i);\nexecute_load 'd.csv' p;",
        )?;
        std::fs::write(&data, "i,value\na,1\n")?;
        let model = Model::from_file(&file).expect("a file");
        for keep in [false, true] {
            std::fs::write(&data, "i,value\na,1\n")?;
            let model = model.clone().keep(keep).clone();
            let run = model.run(&Options::default());
            assert!(run.succeeded() && model.still_reads(run.reads()));
            std::fs::write(&data, "i,value\na,2\n")?;
            assert!(!model.still_reads(run.reads()));
        }
        Ok(())
    }

    #[test]
    fn columns_in_their_order() {
        let row = json!({
            "run": "ok", "messages": "a\nb", "status": "optimal", "key": "1", "friction": 0.5, "b[x]": 1, "a": 2,
        });
        let row = row.as_object().expect("a row");
        let text = table(&[row], &["friction"], &["b", "a"]).expect("a table");
        let text = String::from_utf8(text).expect("a text");
        assert!(
            text.starts_with("friction,b[x],a,run,status,messages\n"),
            "{text}"
        );
        let failed = Row::from_iter([("run".to_string(), json!("aborted"))]);
        assert_eq!(summary(&[row, &failed], 2, Path::new(".")), 0);
        assert_eq!(summary(&[&failed], 1, Path::new(".")), EXECUTION);
    }

    #[test]
    fn ranges_and_lists() {
        assert_eq!(
            values("0.3:0.45:0.05").expect("a range"),
            ["0.3", "0.35", "0.4", "0.45"]
        );
        assert_eq!(values("3:1:-1").expect("a range"), ["3", "2", "1"]);
        assert_eq!(values("1, -1").expect("a list"), ["1", "-1"]);
        assert!(values("1:2:-1").is_err() && values("1:2:0").is_err() && values("a:b:c").is_err());
        let pair = |k: &str, v: &str| (k.to_string(), v.to_string());
        let all = points(&[pair("a", "1,2"), pair("b", "x,y")]).expect("right");
        assert_eq!(all.len(), 4);
        assert_eq!(all[1], [pair("a", "1"), pair("b", "y")]);
    }
}
