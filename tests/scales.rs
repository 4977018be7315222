//! Random programs of badly scaled numbers: bounds that stand for "no limit", and linear programs whose optimum is known by
//! construction.

use bmod::model::outcome::ModelStatus;
use bmod::solver::{
    Answer, Budget, Instance, ProblemType, Quiet, Relation, Sense, Settings, answer,
};

use crate::common::{self, Memory, Random};

/// Covering programs; their numbers have two decimals.
const COVERING: u64 = 25;
/// Linear programs with a known optimum.
const KNOWN: u64 = 300;
/// What sums may be off by, relative to their largest term.
const TOLERANCE: f64 = 1e-9;

/// A number from 0.5 to 10, with two decimals.
fn number(random: &mut Random) -> f64 {
    (50 + random.below(951)) as f64 / 100.0
}

/// A power of ten.
fn power_of_ten(random: &mut Random, most: i64) -> f64 {
    10f64.powi(random.whole(most) as i32)
}

/// Costs and rows of `min c x, A x ≥ b, 0 ≤ x ≤ far`; every column is in a row.
struct Covering {
    cost: Vec<f64>,
    rows: Vec<(Vec<f64>, f64)>,
    far: f64,
}

fn sum(factors: &[f64]) -> String {
    let terms = factors.iter().enumerate().filter(|t| *t.1 != 0.0);
    let all: Vec<String> = terms.map(|(j, a)| format!("{a}*x{j}")).collect();
    all.join(" + ")
}

impl Covering {
    fn random(random: &mut Random) -> Self {
        let (n, m) = (1 + random.below(10) as usize, 1 + random.below(4) as usize);
        let size = power_of_ten(random, 3);
        let rows = (0..m).map(|i| {
            let entry = |j: usize, r: &mut Random| match j % m == i || r.below(3) > 0 {
                true => number(r),
                false => 0.0,
            };
            let mut row: Vec<f64> = (0..n).map(|j| entry(j, random)).collect();
            row[0] += 1.0;
            (row, number(random) * size)
        });
        let rows = rows.collect();
        Self {
            rows,
            cost: (0..n).map(|_| number(random)).collect(),
            far: 10f64.powi(10 + random.below(6) as i32),
        }
    }

    /// As a model of this type.
    fn text(&self, using: &str) -> String {
        let n = self.cost.len();
        let mut text = "variable z; option optcr = 0; equation o;\n".to_string();
        let mut say = |line: String| text.push_str(&line);
        for j in 0..n {
            say(format!("positive variable x{j}; x{j}.up = {};\n", self.far));
        }
        if using == "mcp" {
            for (i, (row, b)) in self.rows.iter().enumerate() {
                say(format!("positive variable y{i}; equation r{i}; "));
                say(format!(
                    "y{i}.up = {};\nr{i}.. {} =g= {b};\n",
                    self.far,
                    sum(row)
                ));
            }
            for (j, c) in self.cost.iter().enumerate() {
                say(format!("equation d{j}; d{j}.. {c}"));
                for (i, (row, _)) in self.rows.iter().enumerate() {
                    say(format!(" - {}*y{i}", row[j]));
                }
                say(" =g= 0;\n".into());
            }
            let rows = (0..self.rows.len()).map(|i| format!("r{i}.y{i}"));
            let pairs: Vec<String> = rows.chain((0..n).map(|j| format!("d{j}.x{j}"))).collect();
            say(format!(
                "model m /{}/; solve m using mcp;\n",
                pairs.join(", ")
            ));
            return text;
        }
        let more = match using {
            "mip" => " + 1.5*i",
            "miqcp" => " + 1.5*i + sqr(x0)",
            "qcp" => " + sqr(x0)",
            "nlp" => " + exp(-x0)",
            "dnlp" => " + abs(x0 - 1)",
            _ => "",
        };
        if more.contains('i') {
            say("integer variable i; i.up = 1000;\n".into());
        }
        for (i, (row, b)) in self.rows.iter().enumerate() {
            let whole = if more.contains("*i") { " + 0.7*i" } else { "" };
            say(format!(
                "equation r{i}; r{i}.. {}{whole} =g= {b};\n",
                sum(row)
            ));
        }
        say(format!("o.. z =e= {}{more};\n", sum(&self.cost)));
        say(format!(
            "model m /all/; solve m using {using} minimizing z;\n"
        ));
        text
    }
}

/// Bounds of 1e10 to 1e15 that stand for "no limit" spoil no status.
#[test]
fn far_bounds_spoil_no_status() {
    let mut random = Random(7);
    for case in 0..COVERING {
        let program = Covering::random(&mut random);
        for using in ["lp", "rmip", "mip", "qcp", "miqcp", "nlp", "dnlp", "mcp"] {
            let text = program.text(using);
            let finished = common::run(&mut Memory::text(&text), "m.blk", common::quiet());
            let solve = common::last_solve(&finished).unwrap_or_else(|e| panic!("{e}\n{text}"));
            let code = solve.model_status.code;
            let known = if using == "dnlp" { 1..=2 } else { 1..=1 };
            assert!(known.contains(&code), "program {case}: {code}\n{text}");
        }
    }
}

/// A linear program with its least or largest value.
fn known(random: &mut Random) -> (Instance, f64) {
    let (n, m) = (1 + random.below(9) as usize, 1 + random.below(7) as usize);
    let sense = [Sense::Minimize, Sense::Maximize][random.below(2) as usize];
    let sigma = sense.sign();
    let mut out = Instance::default();
    let units: Vec<f64> = (0..n).map(|_| power_of_ten(random, 5)).collect();
    let (mut level, mut cost) = (Vec::new(), Vec::new());
    for unit in &units {
        let x = [0.0, number(random), -number(random)][random.below(3) as usize] / unit;
        let d = number(random) * power_of_ten(random, 2) * unit;
        let side = |r: &mut Random| [f64::INFINITY, number(r) / unit][r.below(2) as usize];
        let (below, above) = (side(random), side(random));
        // inside, at the lower bound, at the upper bound
        let (l, u, d) = match random.below(3) {
            0 => (x - below, x + above, 0.0),
            1 => (x, x + above, sigma * d),
            _ => (x - below, x, -sigma * d),
        };
        out.add_column(l, u, 0.0);
        level.push(x);
        cost.push(d);
    }
    for _ in 0..m {
        let r = power_of_ten(random, 5);
        let mut row = Vec::new();
        for (j, unit) in units.iter().enumerate() {
            if random.below(5) < 3 {
                row.push((j, (number(random) - 5.0) * r * unit));
            }
        }
        let at: f64 = row.iter().map(|&(j, a)| a * level[j]).sum();
        let y = number(random) * power_of_ten(random, 2) / r;
        let room = number(random) * r;
        // tight or slack
        let (relation, rhs, y) = match random.below(5) {
            0 => (Relation::Equal, at, y),
            1 => (Relation::Greater, at, sigma * y),
            2 => (Relation::Less, at, -sigma * y),
            3 => (Relation::Greater, at - room, 0.0),
            _ => (Relation::Less, at + room, 0.0),
        };
        row.iter().for_each(|&(j, a)| cost[j] += a * y);
        out.add_row(row, relation, rhs);
    }
    let z = out.add_column(f64::NEG_INFINITY, f64::INFINITY, 0.0);
    let value = cost.iter().zip(&level).map(|(c, x)| c * x).sum();
    let objective = cost.iter().enumerate().map(|(j, c)| (j, -c));
    out.add_row(objective.chain([(z, 1.0)]), Relation::Equal, 0.0);
    out.set_objective(z, sense);
    (out, value)
}

/// Σ multiplier · right side + Σ marginal · bound, and the largest term of both objectives.
fn dual_value(instance: &Instance, found: &Answer) -> [f64; 2] {
    let o = &found.outcome;
    let rows = instance.rows.rhs.iter().zip(&o.row_marginal);
    let columns = o.level.iter().zip(&o.column_marginal);
    let terms = rows.chain(columns).filter(|t| *t.1 != 0.0);
    let terms: Vec<f64> = terms.map(|(b, y)| b * y).collect();
    let (row, _) = instance.objective_row().expect("an objective");
    let costs = instance.matrix.row(row).map(|(j, c)| c * o.level[j]);
    let all = costs.chain(terms.iter().copied());
    let largest = all.fold(0.0f64, |t, v| t.max(v.abs()));
    [terms.iter().sum(), largest]
}

/// The optimum is found, and multipliers times right sides and bounds add up to it.
#[test]
fn prices_add_up_to_the_known_optimum() {
    let mut random = Random(54);
    for case in 0..KNOWN {
        let (instance, value) = known(&mut random);
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let settings = Settings::default();
        let found = answer(ProblemType::Lp, None, &instance, &settings, &budget);
        let found = found.expect("it is solved");
        assert_eq!(
            found.status,
            ModelStatus::Optimal,
            "program {case}: {found:?}"
        );
        let z = *found.outcome.level.last().expect("an objective");
        let [dual, size] = dual_value(&instance, &found);
        let near = TOLERANCE * size;
        assert!(
            (z - value).abs() <= near,
            "program {case}: {z}, not {value}"
        );
        assert!((dual - z).abs() <= near, "program {case}: {dual}, not {z}");
        let columns = &instance.columns;
        for (j, &d) in found.outcome.column_marginal.iter().enumerate() {
            let (x, bounds) = (found.outcome.level[j], [columns.lower[j], columns.upper[j]]);
            assert!(
                d == 0.0 || bounds.contains(&x),
                "program {case}, column {j}: {x} {d}"
            );
        }
    }
}
