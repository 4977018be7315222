//! Strategies: the fallbacks, restarts and special treatments of the solvers, one row each.
//!
//! Each can be left out by name, `--option without=NAME[,NAME…]` or `option without = NAME;`, so that what it is worth can be measured:
//! `cargo bench --bench ablation` solves the corpora without each in turn. What loses nothing there is deleted. To add one: a row below, and a
//! question at the place where it begins, after everything else that decides whether it applies:
//!
//! ```text
//! if is_stuck && settings.runs(Strategy::ElasticForm) { … }
//! ```

use super::Settings;
use crate::model::option::{Kind, OptionTable, row};
use std::fmt::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is known about a strategy.
#[derive(Clone, Copy, Debug)]
pub struct StrategyRow {
    /// The strategy.
    pub strategy: Strategy,
    /// Its name, as in `without=NAME`.
    pub name: &'static str,
    /// The solver that it belongs to: `lp`, `mcp`, `nlp`, `mpec` or `mip`.
    pub area: &'static str,
    /// When it applies, and what it does then.
    pub when: &'static str,
    /// What it costs at most.
    pub cost: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

macro_rules! strategies {
    ($($area:literal: { $($strategy:ident $name:literal, $when:literal, $cost:literal, $source:literal;)* })*) => {
        /// A strategy that can be left out.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub enum Strategy {
            $($(#[doc = $when] $strategy,)*)*
        }

        /// All strategies.
        pub const STRATEGIES: &[StrategyRow] = &[$($(StrategyRow {
            strategy: Strategy::$strategy,
            name: $name,
            area: $area,
            when: $when,
            cost: $cost,
            source: $source,
        },)*)*];

        const NAMES: &[&str] = &[$($($name,)*)*];
    };
}

// name, when it applies and what it does, what it costs at most, source
strategies! {
    "lp": {
        Presolve "presolve",
            "more than 200 rows and columns: rows and columns that are decided or implied by others are taken out",
            "the nonzeros, some thirty times at most",
            "Andersen & Andersen 1995";
        SimplexFirst "simplex_first",
            "more than 200 rows and columns: the simplex method before the interior point",
            "what an interior point is likely to cost, at most",
            "Koberstein & Suhl 2007";
        FaceVertex "face_vertex",
            "an interior point in a face of 1500 dimensions: a second one, with a random objective, ends near a vertex of it",
            "a second solve by the interior point",
            "Mehrotra 1991";
    }
    "mcp": {
        InteriorCrash "interior_crash",
            "many variables: an interior point method leads to the first basis",
            "its iterations",
            "Wright 1997, chapter 8";
        RandomRestarts "random_restarts",
            "all methods failed from the given start: 30 random ones",
            "twice the work so far, or 0.6 s",
            "PATH's restarts, Ferris & Munson 2000";
    }
    "nlp": {
        TriangularRows "triangular_rows",
            "pre- and post-triangular rows are solved before and after",
            "the nonzeros",
            "Drud 1994";
        ConvexEpigraph "convex_epigraph",
            "kinks on the side where they are convex are replaced by a column and a row for each argument",
            "one solve of the larger program",
            "Boyd & Vandenberghe 2004, 4.1.3";
        Cones "cones",
            "convex rows that may have no multipliers, or others fail: Clarabel",
            "two conic solves",
            "Lobo et al. 1998; Grant, Boyd & Ye 2006; Goulart & Chen 2024";
        InnerSums "inner_sums",
            "linear sums of 500 variables inside functions, others of 1000 (a tenth where second derivatives would fill the memory), become columns",
            "a row and a column for each",
            "Griewank & Toint 1982";
        VanishingSquares "vanishing_squares",
            "the objective is a sum of squares, with the equations as many as the variables: they are solved as equations",
            "250 steps of Newton's method",
            "Nocedal & Wright 2006, chapters 10 and 11";
        ConvexQuadratic "convex_quadratic",
            "linear rows and a positive semidefinite Hessian of the objective: Clarabel solves it",
            "a Cholesky factorisation and two conic solves",
            "Goulart & Chen 2024";
        WarmStart "warm_start",
            "an earlier solve left marginals: the active set that they name is the first working set",
            "an evaluation and a factorisation",
            "Gill, Murray & Saunders 2005";
        SquareNewton "square_newton",
            "at least as many equations as variables: Newton's method, damped, along the path of residuals, then with steps that shorten the next one",
            "250 steps",
            "Nocedal & Wright 2006, chapter 10; Allgower & Georg 2003; Deuflhard 2004, 3.3";
        TruncatedNewton "truncated_newton",
            "no constraints, a factor of the Hessian takes 5·10⁹ operations, or a step with its entries 200 products: conjugate gradients in a trust region",
            "1000 steps, or products worth 20 steps with entries",
            "Steihaug 1983; Lin & Moré 1999";
        DifferentiableStart "differentiable_start",
            "a row has no derivatives at the start, as √x at 0: its variables are moved by up to their size, or 1",
            "100 evaluations of the derivatives",
            "Wächter & Biegler 2006, 3.6";
        ConsistentStart "consistent_start",
            "variables without a start level that are the only such one in an equation are computed from it",
            "50 evaluations of the rows and their derivatives",
            "common in models with intermediate variables";
        SequentialQuadratic "sequential_quadratic",
            "up to 10 000 variables and constraints: sequential linear and quadratic programming goes first",
            "100 steps",
            "Byrd, Gould, Nocedal & Waltz 2004";
        InteriorFirst "interior_first",
            "a quarter of all constraints are nonlinear, 50 of them equations (ten inequalities count as one): the interior point goes first",
            "a run of the interior point",
            "ablation";
        SecondOrderCorrection "second_order_correction",
            "a step keeps less than half of its promise: the curvature of the held rows is taken off",
            "four solves with the factors and evaluations",
            "Fletcher 1982";
        ActiveSetNewton "active_set_newton",
            "multipliers have the right signs: Newton's method on the working set without a linear program",
            "a factorisation a step",
            "Fletcher & Sainz de la Maza 1989";
        DependentRows "dependent_rows",
            "rows of the working set depend on each other: they give way by 1e-7 times their multipliers",
            "nothing",
            "Friedlander & Orban 2012";
        RoundedData "rounded_data",
            "rows contradict each other by less than 5e-7 of their size: they are moved to where they agree best",
            "nothing",
            "bmod";
        InfeasibilityDoubt "infeasibility_doubt",
            "linear programs prove that nothing nearby is feasible: again from where the linear rows hold, near the middle between the bounds, or a unit from 0",
            "100 steps",
            "multistart";
        WidenedRows "widened_rows",
            "rows without multipliers: curvature, by the multipliers of the same rows 1e-8 wider",
            "100 steps",
            "Bonnans & Shapiro 2000, 3.2";
        SaddleEscape "saddle_escape",
            "negative curvature on the tangent space of the active set: a step along it, and on from there",
            "three solves",
            "Moré & Sorensen 1979";
        WeaklyActiveCurvature "weakly_active_curvature",
            "bounds or rows are active without a multiplier: negative curvature is looked for beyond them as well",
            "a factorisation and 60 products",
            "copositivity: Nocedal & Wright 2006, 12.5";
        ViolationCurvature "violation_curvature",
            "linear programs see no way to lessen what is violated: negative curvature of the violation is followed",
            "a factorisation, 60 products and the solve from there",
            "Moré & Sorensen 1979";
        UnboundedBoxes "unbounded_boxes",
            "a run diverges: the program in two boxes tells whether it is unbounded",
            "four solves",
            "bmod";
        KinkSmoothing "kink_smoothing",
            "kinks, and no certified point: they are smoothed with a shrinking parameter",
            "four runs of the interior point",
            "Chen & Mangasarian 1996";
        RestartFromBest "restart_from_best",
            "no certified point: again from the best one, near its bounds",
            "a run of each method",
            "ablation";
        ActiveSetPolish "active_set_polish",
            "residuals above 1e-13: Newton steps on the active set of the point",
            "a few factorisations",
            "Nocedal & Wright 2006, chapter 18";
        IntervalProof "interval_proof",
            "no feasible point: a linear program over interval bounds of the nonlinear terms may prove that there is none",
            "one linear program",
            "Neumaier 2004";
    }
    "mpec": {
        EquilibriumFromZero "equilibrium_from_zero",
            "two systems that only the pairs join: a second start, at the end of the complementarity solver's path from zero",
            "a solve of the complementarity problem",
            "basic solutions have small supports";
        FeasibleByBranching "feasible_by_branching",
            "nothing feasible was found: branch and bound over the pieces finds a point that satisfies all pairs, or proves that there is none",
            "branch and bound",
            "Hu, Mitchell, Pang, Bennett & Kunapuli 2008";
        InteriorRelaxation "interior_relaxation",
            "more than 120 rows and columns: programs in which products are bounded go to the interior point, one coarse run each from μ = 1 on, not to the sequential method",
            "nothing",
            "Raghunathan & Biegler 2005";
    }
    "mip": {
        BinaryProducts "binary_products",
            "not convex quadratic, products with a binary factor, or of integers with at most 256 values: columns and rows instead, if what is left is linear or convex quadratic",
            "20 000 columns, and 5 nodes of the nonlinear program (500, then 20 000 of the linear one, with integers in bits)",
            "Fortet 1960, Watters 1967, McCormick 1976, Adams & Sherali 1986";
        OuterApproximation "outer_approximation",
            "convex terms: tangents at the nodes of a tree over linear programs, those of the perspective where a binary switches columns off",
            "a column and a tangent for each term or block",
            "Quesada & Grossmann 1992, Frangioni & Gentile 2006, Grant, Boyd & Ye 2006";
        OrbitalBranching "orbital_branching",
            "where a binary column is branched down, so are those that permutations make of it",
            "10⁷ entries of rows, and each of them 20 times",
            "Ostrowski, Linderoth, Rossi & Smriglio 2011";
        ClauseLearning "clause_learning",
            "bounds of binary columns that led to a contradiction never meet again",
            "ten times the program's entries for each; 1000 clauses",
            "Marques-Silva & Sakallah 1999, Achterberg 2007";
    }
}

/// The option that leaves strategies out.
pub const OPTIONS: OptionTable = OptionTable {
    backend: "strategies",
    title: "every solver",
    rows: &[row(
        "without",
        Kind::Names(NAMES),
        "",
        "strategies that are left out, to measure what they are worth (listed in `docs/strategies.md`)",
    )],
    more: None,
    ignored: &[],
};

/// Which of them came into question since [`take_asked`].
static ASKED: [AtomicBool; NAMES.len()] = [const { AtomicBool::new(false) }; NAMES.len()];

/// The strategies that came into question since the last call, in any thread: those without which a solve may go another way.
pub fn take_asked() -> Vec<Strategy> {
    let asked = |r: &&StrategyRow| ASKED[r.strategy as usize].swap(false, Ordering::Relaxed);
    STRATEGIES
        .iter()
        .filter(asked)
        .map(|r| r.strategy)
        .collect()
}

/// Which strategies run, for code that sees no [`Settings`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Strategies {
    without: u128,
}

const _: () = assert!(NAMES.len() <= 128, "a bit for each strategy");

impl Strategies {
    /// Whether a strategy is not left out. To be asked last, where all else says that it applies.
    pub fn run(self, strategy: Strategy) -> bool {
        ASKED[strategy as usize].store(true, Ordering::Relaxed);
        self.without & (1 << strategy as u32) == 0
    }
}

impl Settings {
    /// Which strategies run.
    pub fn strategies(&self) -> Strategies {
        let mut out = Strategies::default();
        for name in self.option("without").iter().flat_map(|l| l.split(',')) {
            if let Some(k) = NAMES
                .iter()
                .position(|n| n.eq_ignore_ascii_case(name.trim()))
            {
                out.without |= 1 << k;
            }
        }
        out
    }

    /// Whether a strategy is not left out. To be asked last, where all else says that it applies.
    pub fn runs(&self, strategy: Strategy) -> bool {
        self.strategies().run(strategy)
    }
}

/// The table as a page in Markdown.
pub fn page() -> String {
    let mut out = String::new();
    let mut area = "";
    for r in STRATEGIES {
        if r.area != area {
            area = r.area;
            let gap = if out.is_empty() { "" } else { "\n" };
            let _ = writeln!(
                out,
                "{gap}## {area}\n\n| name | when | costs at most | source |\n| --- | --- | --- | --- |"
            );
        }
        let _ = writeln!(
            out,
            "| `{}` | {} | {} | {} |",
            r.name, r.when, r.cost, r.source
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_does_not_run() {
        let mut settings = Settings::default();
        let first = STRATEGIES[0];
        assert!(settings.runs(first.strategy));
        settings
            .options
            .push(("without".into(), format!(" {} ", first.name)));
        assert!(!settings.runs(first.strategy));
        assert!(take_asked().contains(&first.strategy));
        for (k, r) in STRATEGIES.iter().enumerate() {
            assert_eq!(r.strategy as usize, k);
            assert_eq!(
                NAMES.iter().filter(|n| **n == r.name).count(),
                1,
                "{}",
                r.name
            );
        }
    }
}
