//! Ipopt itself (cargo feature `ipopt`), through `ipopt-sys`.
//!
//! The library is found with the description in `build-support/pkgconfig/ipopt.pc`: stock, the crate's
//! build script chooses a static library that does not link on Debian 12. One `apt-get` line:
//! `apt-get install build-essential pkg-config cmake libssl-dev libclang-dev coinor-libipopt-dev`.
//!
//! The callbacks get a pointer to a [`State`] that lives on the stack of [`Ipopt::solve`] for as long as
//! the call lasts; none of them unwinds into C++.

// the only module that talks to C
#![allow(unsafe_code)]

use super::super::backend::About;
use super::SUPPORTS;
use super::interior_point::{Control, Ended, InteriorPoint, Progress, Shared, Solution, lock};
use super::options::IPOPT_OPTIONS;
use ipopt_sys as c;
use std::ffi::{CString, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice::{from_raw_parts, from_raw_parts_mut};
use std::sync::Mutex;

/// `option nlp = ipopt`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ipopt;

/// What the callbacks work on.
struct State<'a, 'c> {
    nlp: Shared,
    control: &'a mut Control<'c>,
    iterations: u64,
}

/// Integer options; other numbers are real.
#[rustfmt::skip]
const INTEGERS: [&str; 26] = [
    "max_iter", "print_level", "print_frequency_iter", "acceptable_iter", "max_soc", "accept_after_max_steps",
    "filter_reset_trigger", "max_filter_resets", "watchdog_trial_iter_max", "watchdog_shortened_iter_trigger",
    "max_resto_iter", "limited_memory_max_history", "limited_memory_max_skipping",
    "limited_memory_init_val_max", "max_refinement_steps", "min_refinement_steps", "mumps_pivot_order",
    "mumps_permuting_scaling", "mumps_scaling", "mumps_mem_percent", "quality_function_max_section_steps",
    "adaptive_mu_kkterror_red_iters", "soft_resto_pderror_reduction_iters", "num_linear_variables",
    "derivative_test_first_index", "max_hessian_perturbation_iters",
];

/// MUMPS, Ipopt's linear solver, has global state: one solve at a time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Options of later versions and of pounce, without which this one does as well.
const OPTIONAL: [&str; 1] = ["acceptable_dual_inf_tol"];

impl InteriorPoint for Ipopt {
    fn about(&self) -> About {
        About {
            name: "ipopt",
            aliases: &["ipopth"],
            version: "nlp, dnlp, qcp: Ipopt of the system, through ipopt-sys 0.6",
            supports: SUPPORTS,
            options: &IPOPT_OPTIONS,
            option_files: &["ipopt"],
        }
    }

    fn solve(&self, nlp: Shared, control: &mut Control<'_>) -> Result<Solution, String> {
        let _turn = lock(&ONE_AT_A_TIME);
        let (n, m) = lock(&nlp).size();
        let mut options = control.all_options();
        options.push(("option_file_name".into(), String::new()));
        let mut problem: c::CNLP_ProblemPtr = std::ptr::null_mut();
        // SAFETY: the out-pointer is valid, the callbacks have the required signatures.
        let created = unsafe {
            c::cnlp_create_problem(
                &mut problem,
                0,
                Some(sizes),
                Some(init),
                Some(bounds),
                Some(eval_f),
                Some(eval_g),
                Some(eval_grad_f),
                Some(eval_jac_g),
                Some(eval_h),
                None,
            )
        };
        if created != c::CNLP_CreateProblemStatus_CNLP_SUCCESS || problem.is_null() {
            return Err("Ipopt could not take the problem".into());
        }
        let mut result = Ok(());
        for (k, v) in &options {
            if !set_option(problem, k, v) && !OPTIONAL.contains(&k.as_str()) {
                result = Err(format!("ipopt does not take the option `{k} {v}`"));
                break;
            }
        }
        let mut state = State {
            nlp,
            control,
            iterations: 0,
        };
        let solution = result.map(|()| {
            let data: *mut c_void = (&raw mut state).cast();
            // SAFETY: `problem` is valid until freed below; `data` outlives the call.
            unsafe {
                c::cnlp_set_intermediate_callback(problem, Some(intermediate));
                c::cnlp_init_solution(problem, data);
                let r = c::cnlp_solve(problem, data);
                Solution {
                    ended: ended(r.status),
                    x: copy(r.data.x, n),
                    lambda: copy(r.data.mult_g, m),
                    iterations: state.iterations,
                }
            }
        });
        // SAFETY: created above, freed once.
        unsafe { c::cnlp_free_problem(problem) };
        solution
    }
}

/// # Safety
/// `data` is null or points to `n` numbers.
unsafe fn copy(data: *const f64, n: usize) -> Vec<f64> {
    if data.is_null() || n == 0 {
        return vec![0.0; n];
    }
    unsafe { from_raw_parts(data, n) }.to_vec()
}

fn set_option(problem: c::CNLP_ProblemPtr, name: &str, value: &str) -> bool {
    let (Ok(key), Ok(text)) = (CString::new(name), CString::new(value)) else {
        return false;
    };
    // SAFETY: the problem is valid, the strings end with 0.
    let set = unsafe {
        if INTEGERS.contains(&name) {
            match value.parse() {
                Ok(v) => c::cnlp_add_int_option(problem, key.as_ptr(), v),
                Err(_) => 0,
            }
        } else if let Ok(v) = value.parse::<f64>() {
            c::cnlp_add_num_option(problem, key.as_ptr(), v)
        } else {
            c::cnlp_add_str_option(problem, key.as_ptr(), text.as_ptr())
        }
    };
    set != 0
}

fn ended(status: c::CNLP_ApplicationReturnStatus) -> Ended {
    match status {
        c::CNLP_ApplicationReturnStatus_CNLP_SOLVE_SUCCEEDED => Ended::Solved,
        c::CNLP_ApplicationReturnStatus_CNLP_SOLVED_TO_ACCEPTABLE_LEVEL
        | c::CNLP_ApplicationReturnStatus_CNLP_FEASIBLE_POINT_FOUND => Ended::Acceptable,
        c::CNLP_ApplicationReturnStatus_CNLP_INFEASIBLE_PROBLEM_DETECTED => Ended::Infeasible,
        c::CNLP_ApplicationReturnStatus_CNLP_SEARCH_DIRECTION_BECOMES_TOO_SMALL => Ended::SmallStep,
        c::CNLP_ApplicationReturnStatus_CNLP_DIVERGING_ITERATES => Ended::Diverging,
        c::CNLP_ApplicationReturnStatus_CNLP_USER_REQUESTED_STOP => Ended::Stopped,
        c::CNLP_ApplicationReturnStatus_CNLP_MAXIMUM_ITERATIONS_EXCEEDED => Ended::Iterations,
        c::CNLP_ApplicationReturnStatus_CNLP_MAXIMUM_CPUTIME_EXCEEDED => Ended::Time,
        c::CNLP_ApplicationReturnStatus_CNLP_RESTORATION_FAILED
        | c::CNLP_ApplicationReturnStatus_CNLP_ERROR_IN_STEP_COMPUTATION => Ended::Failed,
        c::CNLP_ApplicationReturnStatus_CNLP_NOT_ENOUGH_DEGREES_OF_FREEDOM => Ended::TooFewDegrees,
        c::CNLP_ApplicationReturnStatus_CNLP_INVALID_NUMBER_DETECTED => Ended::InvalidNumber,
        c::CNLP_ApplicationReturnStatus_CNLP_INVALID_OPTION => Ended::InvalidOption,
        _ => Ended::Broken,
    }
}

type Data = c::CNLP_UserDataPtr;

/// Runs a callback on the state; 0 if it fails or panics.
fn with(data: Data, work: impl FnOnce(&mut State<'_, '_>) -> Option<()>) -> c::CNLP_Bool {
    // SAFETY: `data` is the state of the running call of `solve`, which no one else uses meanwhile.
    let state = unsafe { &mut *data.cast::<State<'_, '_>>() };
    let done = catch_unwind(AssertUnwindSafe(|| work(state)));
    c::CNLP_Bool::from(matches!(done, Ok(Some(()))))
}

/// # Safety
/// `p` is null or points to `n` items that nobody else uses during the callback.
unsafe fn out<'a, T>(p: *mut T, n: c::CNLP_Index) -> &'a mut [T] {
    if p.is_null() || n <= 0 {
        return &mut [];
    }
    unsafe { from_raw_parts_mut(p, n as usize) }
}

/// # Safety
/// `p` is null or points to `n` numbers that do not change during the callback.
unsafe fn numbers<'a>(p: *const f64, n: c::CNLP_Index) -> &'a [f64] {
    if p.is_null() || n <= 0 {
        return &[];
    }
    unsafe { from_raw_parts(p, n as usize) }
}

unsafe extern "C" fn sizes(
    n: *mut c::CNLP_Index,
    m: *mut c::CNLP_Index,
    nnz_jac: *mut c::CNLP_Index,
    nnz_hess: *mut c::CNLP_Index,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| {
        let nlp = lock(&s.nlp);
        let (columns, rows) = nlp.size();
        unsafe {
            *n = c::CNLP_Index::try_from(columns).ok()?;
            *m = c::CNLP_Index::try_from(rows).ok()?;
            *nnz_jac = c::CNLP_Index::try_from(nlp.jacobian_pattern().0.len()).ok()?;
            *nnz_hess = c::CNLP_Index::try_from(nlp.hessian_pattern().0.len()).ok()?;
        }
        Some(())
    })
}

#[allow(clippy::too_many_arguments)] // Ipopt's signature
unsafe extern "C" fn init(
    n: c::CNLP_Index,
    init_x: c::CNLP_Bool,
    x: *mut f64,
    init_z: c::CNLP_Bool,
    z_l: *mut f64,
    z_u: *mut f64,
    m: c::CNLP_Index,
    init_lambda: c::CNLP_Bool,
    lambda: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| {
        let nlp = lock(&s.nlp);
        unsafe {
            if init_x != 0 {
                out(x, n).copy_from_slice(&nlp.start);
            }
            if init_z != 0 {
                nlp.start_bounds(out(z_l, n), out(z_u, n));
            }
            if init_lambda != 0 {
                nlp.start_rows(out(lambda, m));
            }
        }
        Some(())
    })
}

unsafe extern "C" fn bounds(
    n: c::CNLP_Index,
    x_l: *mut f64,
    x_u: *mut f64,
    m: c::CNLP_Index,
    g_l: *mut f64,
    g_u: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| {
        let nlp = lock(&s.nlp);
        let put = |to: &mut [f64], from: &[f64]| {
            for (t, f) in to.iter_mut().zip(from) {
                *t = f.clamp(-1e20, 1e20);
            }
        };
        unsafe {
            put(out(x_l, n), nlp.bounds().0);
            put(out(x_u, n), nlp.bounds().1);
            put(out(g_l, m), nlp.sides().0);
            put(out(g_u, m), nlp.sides().1);
        }
        Some(())
    })
}

unsafe extern "C" fn eval_f(
    n: c::CNLP_Index,
    x: *const f64,
    _new_x: c::CNLP_Bool,
    value: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| unsafe {
        *value = lock(&s.nlp).objective(numbers(x, n))?;
        Some(())
    })
}

unsafe extern "C" fn eval_grad_f(
    n: c::CNLP_Index,
    x: *const f64,
    _new_x: c::CNLP_Bool,
    gradient: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| unsafe {
        lock(&s.nlp).gradient(numbers(x, n), out(gradient, n))
    })
}

unsafe extern "C" fn eval_g(
    n: c::CNLP_Index,
    x: *const f64,
    _new_x: c::CNLP_Bool,
    m: c::CNLP_Index,
    g: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| unsafe {
        lock(&s.nlp).constraints(numbers(x, n), out(g, m))
    })
}

fn put_pattern(
    (rows, columns): (&[u32], &[u32]),
    i: &mut [c::CNLP_Index],
    j: &mut [c::CNLP_Index],
) {
    for (t, &f) in i.iter_mut().zip(rows) {
        *t = f as c::CNLP_Index;
    }
    for (t, &f) in j.iter_mut().zip(columns) {
        *t = f as c::CNLP_Index;
    }
}

#[allow(clippy::too_many_arguments)] // Ipopt's signature
unsafe extern "C" fn eval_jac_g(
    n: c::CNLP_Index,
    x: *const f64,
    _new_x: c::CNLP_Bool,
    _m: c::CNLP_Index,
    count: c::CNLP_Index,
    rows: *mut c::CNLP_Index,
    columns: *mut c::CNLP_Index,
    values: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| unsafe {
        let mut nlp = lock(&s.nlp);
        if values.is_null() {
            put_pattern(
                nlp.jacobian_pattern(),
                out(rows, count),
                out(columns, count),
            );
            return Some(());
        }
        nlp.jacobian(numbers(x, n), out(values, count))
    })
}

#[allow(clippy::too_many_arguments)] // Ipopt's signature
unsafe extern "C" fn eval_h(
    n: c::CNLP_Index,
    x: *const f64,
    _new_x: c::CNLP_Bool,
    sigma: f64,
    m: c::CNLP_Index,
    lambda: *const f64,
    _new_lambda: c::CNLP_Bool,
    count: c::CNLP_Index,
    rows: *mut c::CNLP_Index,
    columns: *mut c::CNLP_Index,
    values: *mut f64,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| unsafe {
        let mut nlp = lock(&s.nlp);
        if values.is_null() {
            put_pattern(nlp.hessian_pattern(), out(rows, count), out(columns, count));
            return Some(());
        }
        nlp.hessian(numbers(x, n), sigma, numbers(lambda, m), out(values, count))
    })
}

#[allow(clippy::too_many_arguments)] // Ipopt's signature
unsafe extern "C" fn intermediate(
    mode: c::CNLP_AlgorithmMode,
    iteration: c::CNLP_Index,
    objective: f64,
    primal: f64,
    dual: f64,
    mu: f64,
    _d_norm: f64,
    _regularization: f64,
    _alpha_dual: f64,
    alpha_primal: f64,
    _trials: c::CNLP_Index,
    data: Data,
) -> c::CNLP_Bool {
    with(data, |s| {
        s.iterations = u64::try_from(iteration).unwrap_or(0);
        let go_on = (s.control.watch)(&Progress {
            iteration: s.iterations,
            objective,
            primal,
            dual,
            mu,
            step: alpha_primal,
            restoration: mode == c::CNLP_AlgorithmMode_CNLP_RESTORATION_PHASE_MODE,
        });
        go_on.then_some(())
    })
}
