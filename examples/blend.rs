//! Solves a model again and again with changed data: how the cost of a mixture depends on the price of soy.
//!
//!     cargo run --example blend

use bmod::{Error, Model, Options};

const TEXT: &str = "
Set i 'ingredients' / corn, soy, meal /;
Parameters price(i)   / corn 0.30, soy 0.90, meal 0.55 /
           protein(i) / corn 0.09, soy 0.60, meal 0.38 /;
Scalar need 'protein per unit' / 0.30 /;
Positive variable share(i);  Variable cost;
Equations total, enough, whole;
total..   cost =e= sum(i, price(i)*share(i));
enough..  sum(i, protein(i)*share(i)) =g= need;
whole..   sum(i, share(i)) =e= 1;
Model blend / all /;
solve blend using lp minimizing cost;
";

fn main() -> Result<(), Error> {
    let mut model = Model::from_text("blend.blk", TEXT);
    println!("{:>9} {:>9} {:>9}  mixture", "soy price", "cost", "protein");
    for step in 0..=6 {
        let soy = 0.6 + 0.1 * f64::from(step);
        model.set_parameter("price", [("corn", 0.30), ("soy", soy), ("meal", 0.55)]);
        let run = model.run(&Options::default()).ok()?;
        let shares = run.symbol("share")?.variable_records();
        let mixture: Vec<String> = shares
            .filter(|r| r.level > 0.0)
            .map(|r| format!("{:.0}% {}", 100.0 * r.level, r.labels[0]))
            .collect();
        println!(
            "{soy:>9.2} {:>9.4} {:>9.4}  {}",
            run.level("cost", [])?,
            run.marginal("enough", [])?,
            mixture.join(", ")
        );
    }
    Ok(())
}
