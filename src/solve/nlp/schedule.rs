//! Options and starts: what is tried first, and what when that does not lead to a certified point.

/// Options of every attempt; the user's own come after them.
pub(super) const BASE: [(&str, &str); 8] = [
    ("tol", "1e-9"),
    ("constr_viol_tol", "1e-9"),
    ("dual_inf_tol", "1e-6"),
    ("compl_inf_tol", "1e-12"),
    ("acceptable_tol", "1e-7"),
    ("acceptable_dual_inf_tol", "1e-4"),
    ("honor_original_bounds", "yes"),
    ("diverging_iterates_tol", "1e18"),
];

/// Kinks are rounded by less and less; the last value also serves to judge points at a kink.
pub(super) const ROUNDING: [f64; 4] = [1e-1, 1e-3, 1e-5, FINEST];
pub(super) use crate::solve::certificate::nonlinear::KINK_WIDTH as FINEST;

/// Where an attempt starts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum From {
    /// The user's start point.
    Start,
    /// The best point so far.
    Best,
    /// The user's start, moved by this fraction of its size (and at least by this much).
    Moved(f64),
    /// Anywhere between near bounds, the start moved where there are none; the number is a seed.
    Anywhere(u64),
    /// Halfway between near bounds; where there are none the start, or a unit inside the bounds if that is 0: products of
    /// variables that start at 0 have no slopes there.
    Middle,
}

/// Iterations that one attempt may take; the first less, for what takes so many is better begun elsewhere.
pub(super) const MAX_ATTEMPT_ITERATIONS: u64 = 3000;
pub(super) const FIRST_ATTEMPT_ITERATIONS: u64 = 500;
/// Where there is an answer, a search for a better one may take this many at least.
pub(super) const MIN_ATTEMPT_ITERATIONS: u64 = 50;

/// Options that keep an interior point near its start.
pub(super) const NEAR: &[(&str, &str)] = &[
    ("mu_strategy", "adaptive"),
    ("bound_push", "1e-6"),
    ("bound_frac", "1e-6"),
];
pub(super) const NEARER: &[(&str, &str)] = &[
    ("mu_init", "1e-8"),
    ("bound_push", "1e-8"),
    ("bound_frac", "1e-8"),
];

/// From where a better optimum than a certified one is looked for: the first [`AGREEMENT`] are always tried, the others where
/// these did not agree.
pub(super) const ELSEWHERE: [From; 6] = [
    From::Start,
    From::Middle,
    From::Moved(0.1),
    From::Moved(1.0),
    From::Anywhere(1),
    From::Anywhere(2),
];
pub(super) const AGREEMENT: usize = 4;

/// Work (iterations times nonzeros) of the first attempts up to which a search for a better optimum is
/// cheap: a tenth of a second. What was found in the corpus took at most 1e5.
pub(super) const CHEAP: f64 = 2e5;
/// Work after which no further attempt is begun: a fifth of a second, or so many times that of the first attempts.
pub(super) const ENOUGH: f64 = 5e5;
pub(super) const TIMES: f64 = 4.0;
/// What an iteration takes however small the program is, in nonzeros.
pub(super) const OVERHEAD: f64 = 300.0;
