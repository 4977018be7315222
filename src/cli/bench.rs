//! `bmod bench`: how long until the answer is good to so many digits.

use std::path::Path;
use std::time::Instant;

use indicatif::ProgressBar;

use super::args::{BenchArgs, INTERRUPT, USAGE};
use super::commands::{Status, carry_out_silently, complain, name, options, unwritten, write_file};
use super::host::{interrupted, say, styled};
use crate::report::figure::png;
use crate::report::study;
use crate::run::Options;
use crate::solve::study::{Study, study as run_study};
use crate::solve::{Limits, Monitor, Settings};

/// Nothing is said while it is timed.
struct Silent(Instant);

impl Monitor for Silent {
    fn log(&mut self, _: &str) {}

    fn interrupted(&mut self) -> bool {
        interrupted()
    }

    fn seconds(&mut self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Carries out `bmod bench`; its exit status.
pub(super) fn bench(a: &BenchArgs) -> Status {
    let options = Options {
        keep_solutions: true,
        quiet: true,
        collect: false,
        time_limit: f64::INFINITY,
        ..options(&a.solve)?
    };
    let settings = Settings {
        options: options.solver_options.clone(),
        ..Settings::default()
    };
    let limits = Limits {
        seconds: a.solve.time_limit.unwrap_or(120.0),
        ..Limits::default()
    };
    let file = name(&a.model);
    let mut studies: Vec<(String, Study)> = Vec::new();
    let mut asked_beyond = None;
    let finished = carry_out_silently(&a.model, options, &mut |m| {
        let kept = m.kept();
        if let Some(k) = a.only.filter(|&k| k == 0 || k > kept.len()) {
            asked_beyond = Some((k, kept.len()));
            return;
        }
        for (k, solve) in kept.iter().enumerate() {
            if a.only.is_some_and(|wanted| wanted != k + 1) {
                continue;
            }
            let (model, using, instance) = solve.parts();
            let title = format!("{model} using {using} ({})", short(&file));
            let bar = styled(
                ProgressBar::new(1),
                "{bar:30} {pos}/{len}  {elapsed:>4}  {wide_msg}",
            );
            let mut progress = |done: usize, total: usize, what: &str| {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(format!("{model}: {what}"));
            };
            let s = run_study(
                using,
                instance,
                &settings,
                limits,
                a.repeat,
                &mut Silent(Instant::now()),
                &mut progress,
            );
            bar.finish_and_clear();
            studies.push((title, s));
            if interrupted() {
                break;
            }
        }
    });
    let mut status = finished.end.exit();
    if interrupted() {
        status = INTERRUPT;
    }
    if let Some((k, n)) = asked_beyond {
        let message = format!("there is no solve {k}: the model has {n}");
        return Err(complain(USAGE, message));
    }
    if studies.is_empty() && status == 0 {
        say!("Nothing was solved.");
    }
    for (k, (title, s)) in studies.iter().enumerate() {
        say!("{}", study::table(title, s));
        let svg = || study::svg(title, s);
        let csv: &dyn Fn() -> Result<Vec<u8>, String> = &|| Ok(study::csv(s).into_bytes());
        let files = [
            (&a.csv, csv),
            (&a.svg, &|| Ok(svg().into_bytes())),
            (&a.png, &|| png::png(&svg(), 2.0)),
        ];
        for (path, content) in files {
            let Some(path) = path else { continue };
            let path = numbered(path, k, studies.len());
            let written = match content() {
                Ok(bytes) => write_file(&path, &bytes).err(),
                Err(e) => Some(unwritten(&path, e)),
            };
            status = status.max(written.unwrap_or(0));
        }
    }
    Ok(status)
}

fn short(file: &str) -> String {
    let name = Path::new(file).file_name();
    name.map_or(file.to_string(), |n| n.to_string_lossy().into_owned())
}

/// `study.csv`, or `study-2.csv` for the second of several.
fn numbered(path: &Path, k: usize, count: usize) -> std::path::PathBuf {
    if count < 2 {
        return path.to_path_buf();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{}.{extension}", k + 1))
}
