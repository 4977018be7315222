//! The embedded solver: pounce, a port of Ipopt to Rust on `feral`'s LDLᵀ.
//!
//! A. Wächter and L. T. Biegler, "On the implementation of an interior-point filter line-search
//! algorithm for large-scale nonlinear programming", Mathematical Programming 106 (2006).
//!
//! pounce wants a problem it can own and may panic, so it runs on a thread of its own: the problem is
//! shared, progress comes back through a channel, and a panic ends the thread, not the program.
//! Without its restoration phase wired in, every hard case ends `RestorationFailed`.

use super::super::backend::About;
use super::SUPPORTS;
use super::interior_point::{Control, Ended, InteriorPoint, Progress, Shared, Solution, lock};
use super::options::{INSTALLATION, POUNCE_OPTIONS, is_described};
use crate::model::option::{Kind, OptionRow, row};
use pounce_algorithm::application::{
    IpoptApplication, Ma57Config, default_backend_factory, feral_config_from_options,
};
use pounce_common::reg_options::{DefaultValue, OptionType, RegisteredOption};
use pounce_common::types::{Index, Number};
use pounce_nlp::ApplicationReturnStatus as Status;
use pounce_nlp::return_codes::AlgorithmMode;
use pounce_nlp::tnlp::{
    BoundsInfo, IndexStyle, IpoptCq, IpoptData, IterStats, NlpInfo, SparsityRequest, StartingPoint,
    TNLP,
};
use pounce_restoration::resto_alg_builder::RestoAlgorithmBuilder;
use pounce_restoration::resto_inner_solver::{
    InnerBackendFactoryFactory, make_default_restoration_factory_provider,
};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::OnceLock;
#[cfg(feature = "system")]
use std::sync::mpsc::{RecvTimeoutError, channel};
#[cfg(feature = "system")]
use std::time::{Duration, Instant};

/// Seconds after the limit in which a run must have ended by itself; and no limit at all.
#[cfg(feature = "system")]
const GRACE: f64 = 0.5;
#[cfg(feature = "system")]
const A_LIFETIME: f64 = 1e9;

/// `option nlp = pounce`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pounce;

impl InteriorPoint for Pounce {
    fn about(&self) -> About {
        About {
            name: "pounce",
            // It is Ipopt's algorithm.
            aliases: match cfg!(feature = "ipopt") {
                true => &[],
                false => &["ipopt", "ipopth"],
            },
            version: "nlp, dnlp, qcp: Ipopt's algorithm in Rust, pounce 0.14.0",
            supports: SUPPORTS,
            options: &POUNCE_OPTIONS,
            option_files: &["pounce", "ipopt"],
        }
    }

    fn solve(&self, nlp: Shared, control: &mut Control<'_>) -> Result<Solution, String> {
        let mut options = control.all_options();
        let ordering = "feral_ordering";
        if control.fills && !options.iter().any(|o| o.0 == ordering) {
            // minimum fill, minimum degree and nested dissection: the least of what they promise
            options.push((ordering.into(), "auto_race".into()));
        }
        if let Some(s) = control.seconds {
            options.push(("max_wall_time".into(), format!("{s:.6}")));
        }
        // Without threads nobody can be asked; the time limit holds.
        #[cfg(not(feature = "system"))]
        return run(nlp, &options, Box::new(|_| true));
        #[cfg(feature = "system")]
        on_a_thread(nlp, options, control)
    }
}

/// Runs it on a thread of its own, which a panic may end.
#[cfg(feature = "system")]
fn on_a_thread(
    nlp: Shared,
    options: Vec<(String, String)>,
    control: &mut Control<'_>,
) -> Result<Solution, String> {
    let (send, receive) = channel();
    let (reply, on) = channel();
    let thread = {
        let nlp = nlp.clone();
        std::thread::Builder::new()
            .name(super::THREAD.into())
            .stack_size(64 << 20)
            .spawn(move || {
                // The answer is waited for: how far a run gets must not depend on how fast the threads are. A
                // closed channel means that nobody listens any more.
                let tell = move |p| send.send(p).is_ok() && on.recv().unwrap_or(false);
                run(nlp, &options, Box::new(tell))
            })
            .map_err(|e| format!("no thread could be started: {e}"))?
    };
    let seconds = control.seconds.unwrap_or(A_LIFETIME).min(A_LIFETIME);
    let left = Duration::from_secs_f64(seconds + GRACE);
    let deadline = Instant::now() + left;
    let mut iterations = 0;
    let gone = |ended, iterations| {
        let nlp = lock(&nlp);
        let x = nlp.latest().to_vec();
        Ok(Solution {
            iterations,
            ..Solution::without_multipliers(ended, x, &nlp)
        })
    };
    loop {
        match receive.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(progress) => {
                iterations = progress.iteration;
                // Nobody listens: the run has ended by itself.
                let _ = reply.send((control.watch)(&progress));
            }
            Err(RecvTimeoutError::Disconnected) => break,
            // In a factorisation that cannot be stopped: the thread ends with its next message, which nobody hears.
            Err(RecvTimeoutError::Timeout) => return gone(Ended::Time, iterations),
        }
    }
    match thread.join() {
        Ok(result) => result,
        Err(_) => gone(Ended::Broken, 0),
    }
}

/// pounce's options that the table does not describe, from its own list.
pub fn further_options() -> &'static [OptionRow] {
    static ROWS: OnceLock<Vec<OptionRow>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let mut app = IpoptApplication::new();
        if app.initialize().is_err() {
            return Vec::new();
        }
        let all = app.registered_options().registered_options_in_order();
        let known = |name: &str| is_described(name) || INSTALLATION.contains(&name);
        let further = all.iter().filter(|o| !known(&o.name));
        further.map(|o| described(o)).collect()
    })
}

/// A row from pounce's description. It lives as long as the program: the list is made once.
fn described(o: &RegisteredOption) -> OptionRow {
    let leak = |text: &str| -> &'static str { Box::leak(text.to_string().into_boxed_str()) };
    let low = if o.has_lower {
        o.lower
    } else {
        f64::NEG_INFINITY
    };
    let high = if o.has_upper { o.upper } else { f64::INFINITY };
    let kind = match o.option_type {
        OptionType::OT_Number if o.lower_strict || o.upper_strict => Kind::Inside(low, high),
        OptionType::OT_Number => Kind::Real(low, high),
        OptionType::OT_Integer => Kind::Whole(low, high),
        OptionType::OT_String | OptionType::OT_Unknown => {
            let words = o.valid_strings.iter().map(|e| leak(&e.value));
            let words: Vec<&'static str> = words.collect();
            match words.is_empty() || words.contains(&"*") {
                true => Kind::Text,
                false => Kind::Words(words.leak()),
            }
        }
    };
    let default = match &o.default {
        DefaultValue::None => String::new(),
        DefaultValue::Number(v) => format!("{v:e}"),
        DefaultValue::Integer(v) => v.to_string(),
        DefaultValue::String(v) => v.clone(),
    };
    row(
        leak(&o.name),
        kind,
        leak(&default),
        leak(&o.short_description),
    )
}

/// Solves; `tell` hears of each iteration, and says whether to go on.
fn run(
    nlp: Shared,
    options: &[(String, String)],
    tell: Box<dyn FnMut(Progress) -> bool>,
) -> Result<Solution, String> {
    let mut app = IpoptApplication::new();
    for (k, v) in options {
        app.options_mut()
            .read_from_str(&format!("{k} \"{v}\"\n"), true)
            .map_err(|_| format!("pounce does not take the option `{k} {v}`"))?;
    }
    app.initialize()
        .map_err(|e| format!("pounce could not begin: {}", e.message))?;
    // One thread: the same factors without a pool of threads, which a small system is done before it has woken.
    let mut configuration = feral_config_from_options(app.options());
    configuration.parallel = Some(false);
    app.set_linear_backend_factory(default_backend_factory(
        configuration.clone(),
        Ma57Config::default(),
    ));
    let mint = move || -> InnerBackendFactoryFactory {
        let configuration = configuration.clone();
        Box::new(move || default_backend_factory(configuration.clone(), Ma57Config::default()))
    };
    app.set_restoration_factory_provider(make_default_restoration_factory_provider(
        RestoAlgorithmBuilder::new(),
        app.algorithm_builder_from_options(),
        mint,
    ));
    let solution = {
        let nlp = lock(&nlp);
        Solution::without_multipliers(Ended::Broken, nlp.start.clone(), &nlp)
    };
    let adapter = Rc::new(RefCell::new(Adapter {
        nlp,
        tell,
        lambda: solution.lambda.clone(),
        solution,
    }));
    let status = app.optimize_tnlp(adapter.clone());
    let mut solution = adapter.borrow().solution.clone();
    solution.ended = ended(status);
    solution.iterations = u64::try_from(app.statistics().iteration_count).unwrap_or(0);
    Ok(solution)
}

fn ended(status: Status) -> Ended {
    match status {
        Status::SolveSucceeded => Ended::Solved,
        Status::SolvedToAcceptableLevel | Status::FeasiblePointFound => Ended::Acceptable,
        Status::InfeasibleProblemDetected => Ended::Infeasible,
        Status::SearchDirectionBecomesTooSmall => Ended::SmallStep,
        Status::DivergingIterates => Ended::Diverging,
        Status::UserRequestedStop => Ended::Stopped,
        Status::MaximumIterationsExceeded => Ended::Iterations,
        Status::MaximumCpuTimeExceeded | Status::MaximumWallTimeExceeded => Ended::Time,
        Status::RestorationFailed | Status::ErrorInStepComputation => Ended::Failed,
        Status::NotEnoughDegreesOfFreedom => Ended::TooFewDegrees,
        Status::InvalidNumberDetected => Ended::InvalidNumber,
        Status::InvalidOption => Ended::InvalidOption,
        _ => Ended::Broken,
    }
}

/// The problem as pounce sees it.
struct Adapter {
    nlp: Shared,
    tell: Box<dyn FnMut(Progress) -> bool>,
    lambda: Vec<f64>,
    solution: Solution,
}

/// A bound as pounce wants it: infinite ones beyond ±1e19.
fn finite(bounds: &[f64], out: &mut [Number]) {
    for (o, &b) in out.iter_mut().zip(bounds) {
        *o = b.clamp(-1e20, 1e20);
    }
}

fn pattern((rows, columns): (&[u32], &[u32]), irow: &mut [Index], jcol: &mut [Index]) {
    for (o, &i) in irow.iter_mut().zip(rows) {
        *o = i as Index;
    }
    for (o, &j) in jcol.iter_mut().zip(columns) {
        *o = j as Index;
    }
}

impl TNLP for Adapter {
    fn get_nlp_info(&mut self) -> Option<NlpInfo> {
        let nlp = lock(&self.nlp);
        let (n, m) = nlp.size();
        Some(NlpInfo {
            n: Index::try_from(n).ok()?,
            m: Index::try_from(m).ok()?,
            nnz_jac_g: Index::try_from(nlp.jacobian_pattern().0.len()).ok()?,
            nnz_h_lag: Index::try_from(nlp.hessian_pattern().0.len()).ok()?,
            index_style: IndexStyle::C,
        })
    }

    fn get_bounds_info(&mut self, b: BoundsInfo<'_>) -> bool {
        let nlp = lock(&self.nlp);
        finite(nlp.bounds().0, b.x_l);
        finite(nlp.bounds().1, b.x_u);
        finite(nlp.sides().0, b.g_l);
        finite(nlp.sides().1, b.g_u);
        true
    }

    fn get_starting_point(&mut self, sp: StartingPoint<'_>) -> bool {
        let nlp = lock(&self.nlp);
        if sp.init_x {
            sp.x.copy_from_slice(&nlp.start);
        }
        if sp.init_lambda {
            nlp.start_rows(sp.lambda);
        }
        if sp.init_z {
            nlp.start_bounds(sp.z_l, sp.z_u);
        }
        true
    }

    fn eval_f(&mut self, x: &[Number], _new_x: bool) -> Option<Number> {
        lock(&self.nlp).objective(x)
    }

    fn eval_grad_f(&mut self, x: &[Number], _new_x: bool, grad_f: &mut [Number]) -> bool {
        lock(&self.nlp).gradient(x, grad_f).is_some()
    }

    fn eval_g(&mut self, x: &[Number], _new_x: bool, g: &mut [Number]) -> bool {
        lock(&self.nlp).constraints(x, g).is_some()
    }

    fn eval_jac_g(
        &mut self,
        x: Option<&[Number]>,
        _new_x: bool,
        mode: SparsityRequest<'_>,
    ) -> bool {
        let mut nlp = lock(&self.nlp);
        match mode {
            SparsityRequest::Structure { irow, jcol } => {
                pattern(nlp.jacobian_pattern(), irow, jcol);
                true
            }
            SparsityRequest::Values { values } => {
                x.is_some_and(|x| nlp.jacobian(x, values).is_some())
            }
        }
    }

    fn eval_h(
        &mut self,
        x: Option<&[Number]>,
        _new_x: bool,
        obj_factor: Number,
        lambda: Option<&[Number]>,
        _new_lambda: bool,
        mode: SparsityRequest<'_>,
    ) -> bool {
        let mut nlp = lock(&self.nlp);
        match mode {
            SparsityRequest::Structure { irow, jcol } => {
                pattern(nlp.hessian_pattern(), irow, jcol);
                true
            }
            SparsityRequest::Values { values } => {
                let lambda = lambda.unwrap_or(&self.lambda);
                x.is_some_and(|x| nlp.hessian(x, obj_factor, lambda, values).is_some())
            }
        }
    }

    fn finalize_solution(
        &mut self,
        sol: pounce_nlp::tnlp::Solution<'_>,
        _: &IpoptData,
        _: &IpoptCq,
    ) {
        self.solution.x = sol.x.to_vec();
        self.solution.lambda = sol.lambda.to_vec();
    }

    fn intermediate_callback(&mut self, s: IterStats, _: &IpoptData, _: &IpoptCq) -> bool {
        (self.tell)(Progress {
            iteration: u64::try_from(s.iter).unwrap_or(0),
            objective: s.obj_value,
            primal: s.inf_pr,
            dual: s.inf_du,
            mu: s.mu,
            step: s.alpha_pr,
            restoration: s.mode == AlgorithmMode::RestorationPhaseMode,
        })
    }
}
