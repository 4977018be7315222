//! Options of the nonlinear backends: those of what both share, and Ipopt's.

#![cfg_attr(not(any(feature = "pounce", feature = "ipopt")), allow(dead_code))]

use crate::model::option::{Kind, OptionRow, OptionTable, row};

const POSITIVE: Kind = Kind::Inside(0.0, f64::INFINITY);
const COUNT: Kind = Kind::Whole(0.0, 2e9);

/// What every nonlinear program takes, whichever backend solves it.
#[rustfmt::skip]
pub const SHARED_OPTIONS: OptionTable = OptionTable {
    backend: "nlp",
    title: "nlp, dnlp, qcp and the nonlinear programs inside other types, whichever solver runs",
    rows: &[
        row("nlp_search", Kind::Switch, "no", "whether a better local optimum is looked for where that is cheap"),
    ],
    more: None,
    ignored: &[],
};

/// Ipopt's options that matter to a user of models; the solver knows more.
#[rustfmt::skip]
const IPOPT: &[OptionRow] = &[
    row("tol", POSITIVE, "1e-8", "scaled optimality error at which it has converged"),
    row("acceptable_tol", POSITIVE, "1e-6", "error that is acceptable after `acceptable_iter` iterations without progress"),
    row("acceptable_iter", COUNT, "15", "acceptable iterations in a row that end the run; 0: never"),
    row("max_iter", COUNT, "3000", "iterations of one run"),
    row("max_cpu_time", POSITIVE, "1e20", "seconds of processor time of one run"),
    row("max_wall_time", POSITIVE, "1e20", "seconds of one run"),
    row("dual_inf_tol", POSITIVE, "1", "absolute tolerance of the dual infeasibility"),
    row("constr_viol_tol", POSITIVE, "1e-4", "absolute tolerance of the constraint violation"),
    row("compl_inf_tol", POSITIVE, "1e-4", "absolute tolerance of the complementarity"),
    row("mu_strategy", Kind::Words(&["monotone", "adaptive"]), "monotone", "how the barrier parameter falls"),
    row("mu_init", POSITIVE, "0.1", "first barrier parameter"),
    row("mu_target", Kind::Real(0.0, f64::INFINITY), "0", "last barrier parameter"),
    row("bound_push", POSITIVE, "0.01", "absolute distance of the start from the bounds"),
    row("bound_frac", Kind::Real(1e-300, 0.5), "0.01", "distance of the start from the bounds relative to their distance from each other"),
    row("bound_relax_factor", Kind::Real(0.0, f64::INFINITY), "1e-8", "by how much bounds are relaxed, relative to their size"),
    row("nlp_scaling_method", Kind::Words(&["none", "gradient-based", "equilibration-based"]), "gradient-based", "how functions are scaled"),
    row("hessian_approximation", Kind::Words(&["exact", "limited-memory"]), "exact", "second derivatives of the model, or a quasi-Newton approximation"),
    row("warm_start_init_point", Kind::Switch, "no", "whether the marginals of the model are start multipliers"),
    row("least_square_init_duals", Kind::Switch, "no", "whether all start multipliers are a least-squares estimate"),
    row("expect_infeasible_problem", Kind::Switch, "no", "whether infeasibility is looked for early"),
    row("obj_scaling_factor", Kind::Real(f64::NEG_INFINITY, f64::INFINITY), "1", "what the objective is multiplied by; negative: it is maximised"),
    row("diverging_iterates_tol", POSITIVE, "1e20", "size of a variable at which the run has diverged"),
    row("max_soc", COUNT, "4", "second-order corrections of one line search"),
    row("watchdog_shortened_iter_trigger", COUNT, "10", "shortened steps in a row before the watchdog begins; 0: never"),
];

/// Options that would make a solver read or write files, print, or load libraries: they mean nothing here.
#[rustfmt::skip]
pub(super) const INSTALLATION: &[&str] = &[
    "file_append", "file_print_level", "hsllib", "journal", "linear_solver", "option_file_name",
    "output_file", "pardisolib", "print_frequency_iter", "print_info_string", "print_level",
    "print_options_documentation", "print_timing_statistics", "print_user_options", "sb",
];

/// What pounce takes.
#[cfg(feature = "pounce")]
#[rustfmt::skip]
pub const POUNCE_OPTIONS: OptionTable = OptionTable {
    backend: "pounce",
    title: "nlp, dnlp, qcp: Ipopt's algorithm in Rust; options by Ipopt's names",
    rows: IPOPT,
    more: Some(super::pounce::further_options),
    ignored: INSTALLATION,
};

/// What Ipopt takes.
#[cfg(feature = "ipopt")]
#[rustfmt::skip]
pub const IPOPT_OPTIONS: OptionTable = OptionTable {
    backend: "ipopt",
    title: "nlp, dnlp, qcp: the system's Ipopt; options by its names",
    rows: IPOPT,
    // The library has no list; pounce has the same names.
    #[cfg(feature = "pounce")]
    more: Some(super::pounce::further_options),
    #[cfg(not(feature = "pounce"))]
    more: None,
    ignored: INSTALLATION,
};

/// Whether a row of [`IPOPT`] describes the option.
pub(super) fn is_described(name: &str) -> bool {
    IPOPT.iter().any(|r| r.name == name)
}
