//! Work and precision: one instance solved in many ways, with the time and the error of each.
//!
//! The error of an objective is relative to the middle of its proved interval (linear programs, see
//! [`super::lp::certify`]), otherwise to the objective of the most accurate run: the one whose
//! largest residual is smallest. Models without objective are judged by their natural residual.
//! Times are medians; everything else is the same in every run, and on any number of threads.

use super::answer::{Answer, answer};
use super::lp::certify::certify;
use super::{Budget, Limits, ModelStatus, Monitor, Settings};
use crate::model::instance::Instance;
use crate::model::problem_type::ProblemType;

/// A way to solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Solver, one line of the picture.
    pub family: &'static str,
    /// What distinguishes it within the family: `1e-6`.
    pub setting: String,
    choice: Option<&'static str>,
    options: Vec<(String, String)>,
}

/// What a way took and gave.
#[derive(Clone, Debug)]
pub struct Run {
    /// The way.
    pub way: Way,
    /// Median time in seconds.
    pub seconds: f64,
    /// Relative error of the objective; for models without one the natural residual.
    pub error: Option<f64>,
    /// The objective.
    pub objective: Option<f64>,
    /// Status on the recomputed residuals.
    pub status: ModelStatus,
    /// Largest violation of a row or bound.
    pub primal: Option<f64>,
    /// Largest wrong multiplier.
    pub dual: Option<f64>,
    /// Largest complementarity product, or natural residual.
    pub complementarity: Option<f64>,
    /// Iterations.
    pub iterations: u64,
}

/// What the errors are measured against.
#[derive(Clone, Debug, PartialEq)]
pub enum Reference {
    /// A proved interval.
    Proved(f64, f64),
    /// The most accurate run.
    Best(f64),
    /// Zero: natural residuals.
    Residual,
    /// Nothing: no way gave a solution.
    None,
}

/// A whole study.
#[derive(Clone, Debug)]
pub struct Study {
    /// What errors are measured against.
    pub reference: Reference,
    /// The runs in the order of the ways.
    pub runs: Vec<Run>,
}

fn way(
    family: &'static str,
    setting: &str,
    choice: Option<&'static str>,
    options: &[(&str, &str)],
) -> Way {
    Way {
        family,
        setting: setting.into(),
        choice,
        options: options
            .iter()
            .map(|&(k, v)| (k.to_string(), v.to_string()))
            .collect(),
    }
}

/// The ways that there are for a problem type.
pub fn ways(using: ProblemType, instance: &Instance) -> Vec<Way> {
    use ProblemType::{Cns, Mcp, Mpec, Rmpec};
    let mut out = Vec::new();
    match using {
        Mcp | Cns => {
            for t in ["1e-2", "1e-4", "1e-6", "1e-8", "1e-10", "1e-12"] {
                out.push(way("bmcp", t, None, &[("convergence_tolerance", t)]));
            }
        }
        Mpec | Rmpec => {
            for starts in ["0", "4"] {
                let options = [("mpec_starts", starts)];
                out.push(way("bmod, random starts", starts, None, &options));
            }
            for factor in ["0.01", "0.1", "0.5"] {
                let family = match factor {
                    "0.01" => "factor 0.01",
                    "0.1" => "factor 0.1",
                    _ => "factor 0.5",
                };
                for mu in ["1", "1e-1", "1e-2", "1e-3", "1e-4", "1e-6"] {
                    let options = [
                        ("mpec_method", "relaxation"),
                        ("mpec_mu", mu),
                        ("mpec_factor", factor),
                        ("mpec_starts", "0"),
                    ];
                    out.push(way(family, mu, None, &options));
                }
            }
        }
        _ if instance.is_linear() && instance.objective.is_some() => {
            for t in ["1e-2", "1e-4", "1e-6", "1e-8", "1e-9", "1e-10", "1e-11"] {
                let options = [("method", "interior"), ("tolerance", t)];
                out.push(way("interior point", t, None, &options));
            }
            for a in ["fast", "standard", "high"] {
                out.push(way("bmod", a, None, &[("lp_accuracy", a)]));
            }
            let size = instance.row_count() + instance.column_count();
            if size <= 12_000 {
                for a in ["fast", "standard"] {
                    let options = [("method", "simplex"), ("lp_accuracy", a)];
                    out.push(way("simplex", a, None, &options));
                }
            }
            if size <= 3_000 {
                for t in ["1e-6", "1e-10"] {
                    let options = [("convergence_tolerance", t)];
                    out.push(way("mcp of the KKT system", t, Some("mcp"), &options));
                }
            }
        }
        _ => {
            let solvers: &[(&str, &str)] = match cfg!(feature = "ipopt") {
                true => &[("pounce", "pounce"), ("ipopt", "ipopt")],
                false => &[("pounce", "pounce")],
            };
            for &(family, choice) in solvers {
                for t in ["1e-2", "1e-4", "1e-6", "1e-8", "1e-10"] {
                    let options = [("tol", t), ("acceptable_tol", t), ("constr_viol_tol", t)];
                    out.push(way(family, t, Some(choice), &options));
                }
            }
        }
    }
    out
}

/// Runs a study; each way `repeat` times. `progress` hears how many solves are done, of how many, and
/// what is next.
pub fn study(
    using: ProblemType,
    instance: &Instance,
    settings: &Settings,
    limits: Limits,
    repeat: usize,
    monitor: &mut dyn Monitor,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Study {
    let ways = ways(using, instance);
    let repeat = repeat.max(1);
    let total = ways.len() * repeat + 1;
    let mut done = 0;
    let mut best: Option<Answer> = None;
    let mut runs = Vec::new();
    for way in ways {
        let mut settings = settings.clone();
        settings.options.extend(way.options.iter().cloned());
        let mut times = Vec::new();
        let mut last = None;
        for _ in 0..repeat {
            progress(done, total, &format!("{} {}", way.family, way.setting));
            done += 1;
            if monitor.interrupted() {
                break;
            }
            let budget = Budget::new(&mut *monitor, limits, false);
            let result = answer(using, way.choice, instance, &settings, &budget);
            times.push(budget.seconds());
            match result {
                Ok(a) => last = Some(a),
                Err(_) => break,
            }
        }
        let Some(a) = last else { continue };
        times.sort_by(f64::total_cmp);
        let r = &a.residuals;
        runs.push(Run {
            way,
            seconds: times[times.len() / 2],
            error: None,
            objective: instance
                .objective
                .map(|o| a.outcome.level[o.column as usize]),
            status: a.status,
            primal: r.primal,
            dual: r.dual,
            complementarity: r.complementarity.or(r.natural),
            iterations: a.outcome.iterations,
        });
        if instance.objective.is_none()
            && let Some(run) = runs.last_mut()
        {
            run.error = r.natural.or(r.primal);
            run.complementarity = r.natural;
        }
        if best.as_ref().is_none_or(|b| merit(&a) < merit(b)) {
            best = Some(a);
        }
    }
    progress(done, total, "the reference");
    let budget = Budget::new(monitor, limits, false);
    let reference = reference(using, instance, best.as_ref(), &budget);
    let value = match reference {
        Reference::Proved(lo, hi) => Some(0.5 * lo + 0.5 * hi),
        Reference::Best(v) => Some(v),
        Reference::Residual | Reference::None => None,
    };
    for run in &mut runs {
        if let (Some(v), Some(z)) = (value, run.objective) {
            // A value that is zero but for rounding has no relative error.
            let size = if v.abs() < 1e-9 { 1.0 } else { v.abs() };
            run.error = Some((z - v).abs() / size);
        }
    }
    progress(total, total, "");
    Study { reference, runs }
}

/// Smaller is better: whether it is a solution, then its residuals.
fn merit(a: &Answer) -> (bool, f64) {
    let r = &a.residuals;
    let worst = [r.primal, r.dual, r.complementarity, r.natural];
    let worst = worst.iter().flatten().fold(0.0f64, |t, v| t.max(*v));
    (!is_solution(a), worst)
}

fn is_solution(a: &Answer) -> bool {
    a.status.is_solution()
}

fn reference(
    using: ProblemType,
    instance: &Instance,
    best: Option<&Answer>,
    budget: &Budget,
) -> Reference {
    let Some(best) = best else {
        return Reference::None;
    };
    let Some(objective) = instance.objective else {
        return Reference::Residual;
    };
    let linear = instance.is_linear() && !using.has_pairs();
    if linear
        && let Ok(p) = certify(instance, &best.outcome, budget)
        && p.low.is_finite()
        && p.high.is_finite()
    {
        return Reference::Proved(p.low, p.high);
    }
    if !is_solution(best) && best.status != ModelStatus::Feasible {
        return Reference::None;
    }
    Reference::Best(best.outcome.level[objective.column as usize])
}
