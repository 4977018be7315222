//! Runs a model from a file, shows its progress, stops it when Enter is pressed, and tells what came of it.
//!
//!     cargo run --example run_file -- models/wall.blk

use bmod::{Control, Error, Model, Options};
use std::time::Duration;

fn main() -> Result<(), Error> {
    let path = std::env::args().nth(1);
    let model = Model::from_file(path.as_deref().unwrap_or("models/wall.blk"))?;
    let control = Control::new();
    let options = Options::default().control(&control).time_limit(60.0);

    let runner = std::thread::spawn(move || model.run(&options));
    let on_enter = control.clone();
    std::thread::spawn(move || {
        if std::io::stdin()
            .read_line(&mut String::new())
            .is_ok_and(|n| n > 0)
        {
            on_enter.cancel();
        }
    });
    let mut last = String::new();
    while !runner.is_finished() {
        std::thread::sleep(Duration::from_millis(20));
        let progress = control.progress();
        if progress.message != last {
            println!("{:6.2} s  {}", progress.seconds, progress.message);
            last = progress.message;
        }
    }
    let run = runner.join().expect("a run does not panic");

    for solve in run.solves() {
        let objective = solve
            .objective
            .map_or(String::new(), |v| format!(", objective {v}"));
        println!(
            "{} using {}: {}{objective} ({} iterations of {}, {:.3} s)",
            solve.model,
            solve.using,
            solve.model_status.name(),
            solve.iterations,
            solve.solver,
            solve.seconds.solve,
        );
    }
    for file in run.files() {
        println!("{}: {} bytes", file.name, file.bytes.len());
    }
    print!("{}", run.messages());
    Ok(())
}
