//! Options of the complementarity solver, by PATH's names where the meaning is PATH's.

use super::Settings;
use crate::model::option::{Kind, OptionTable, row};

const LIMIT: Kind = Kind::Whole(0.0, 1e15);

/// What `mcp` and `cns` take.
#[rustfmt::skip]
pub const OPTIONS: OptionTable = OptionTable {
    backend: "bmcp",
    title: "mcp, cns: bmod's own, after PATH",
    rows: &[
        row("convergence_tolerance", Kind::Real(0.0, f64::INFINITY), "1e-8", "natural residual at which the problem is solved"),
        row("crash_method", Kind::Words(&["pnewton", "none"]), "pnewton", "projected Newton steps before the first major iteration, or none"),
        row("crash_iteration_limit", LIMIT, "50", "crash iterations"),
        row("major_iteration_limit", LIMIT, "120", "major iterations of one run of the main method"),
        row("minor_iteration_limit", LIMIT, "0", "pivots of one linear subproblem; 0 chooses by size"),
        row("cumulative_iteration_limit", LIMIT, "10000000", "pivots of all runs together"),
        row("proximal_perturbation", Kind::Real(0.0, f64::INFINITY), "0", "proximal term of the first major iteration"),
        row("nms_memory_size", LIMIT, "10", "memory of the nonmonotone line search"),
        row("restart_limit", LIMIT, "30", "random restarts after all methods have failed; without the option they also end where they would cost more than what went before"),
        row("time_limit", Kind::Real(0.0, f64::INFINITY), "inf", "seconds; `reslim` and `--time-limit` hold as well"),
    ],
    more: None,
    ignored: &[
        "crash_merit_function", "crash_minimum_dimension", "crash_nbchange_limit", "crash_perturb",
        "crash_searchtype", "factorization_library_name", "factorization_method", "gradient_searchtype",
        "gradient_step_limit", "infinity_tolerance", "interrupt_limit", "lemke_rank_deficiency_iterations",
        "lemke_search_type", "lemke_start", "lemke_start_type", "merit_function", "nms",
        "nms_initial_reference_factor", "nms_maximum_watchdogs", "nms_mstep_frequency", "nms_searchtype",
        "output", "output_crash_iterations",
        "output_crash_iterations_frequency", "output_errors", "output_factorization_singularities",
        "output_final_degeneracy_statistics", "output_final_point", "output_final_point_statistics",
        "output_final_scaling_statistics", "output_final_summary", "output_initial_point",
        "output_initial_point_statistics", "output_initial_scaling_statistics", "output_initial_statistics",
        "output_linear_model", "output_listing", "output_final_statistics", "output_major_iterations", "output_minor_iterations",
        "output_major_iterations_frequency", "output_memory",
        "output_minor_iterations_frequency", "output_model_statistics", "output_options",
        "output_preprocess_level", "output_restart_log", "output_time", "output_timing", "output_warnings",
        "preprocess", "return_best_point", "singularity_tolerance", "use_basics", "use_start",
    ],
};

impl Settings {
    /// What these ask for, whose values the table has passed.
    pub fn new(asked: &crate::solve::Settings) -> Self {
        let number = |name| asked.number_of(&OPTIONS, name);
        let whole = |name| number(name).min(1e15) as usize;
        let restarts = asked.number("restart_limit");
        Self {
            convergence_tolerance: number("convergence_tolerance"),
            acceptable_tolerance: 1e-6,
            crash_method: asked.option("crash_method").is_none_or(|m| m != "none"),
            crash_iteration_limit: whole("crash_iteration_limit"),
            major_iteration_limit: whole("major_iteration_limit"),
            cumulative_iteration_limit: whole("cumulative_iteration_limit"),
            minor_iteration_limit: whole("minor_iteration_limit"),
            proximal_perturbation: number("proximal_perturbation"),
            nms_memory_size: whole("nms_memory_size"),
            restart_limit: restarts.map(|r| r.min(1e15) as usize),
            time_limit: number("time_limit"),
            strategies: asked.strategies(),
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new(&crate::solve::Settings::default())
    }
}
