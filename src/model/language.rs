//! Options of the language: of the `option` statement, of `--option`, and most of them of models (`m.reslim = 10`).

use super::option::{Accepted, Kind, OptionTable, Refused, Solvers, check, row};
use super::problem_type::ProblemType;
use crate::diag::nearest;
use Kind::{Real, Switch, Whole, Word, WordsOrReal};

const INF: f64 = f64::INFINITY;

/// The options of the language.
#[rustfmt::skip]
pub static LANGUAGE: OptionTable = OptionTable {
    backend: "language",
    title: "every model; what is said of a model (`m.optcr = 0`) counts before what is said of all (`option optcr = 0`)",
    rows: &[
        row("lp", Word("the name of a solver"), "default", "solver of linear programs; `mip`, `nlp` and all other types likewise"),
        row("reslim", Real(0.0, INF), "1e10", "seconds of a solve"),
        row("iterlim", Whole(0.0, INF), "2147483647", "iterations of a solve"),
        row("domlim", Whole(0.0, INF), "0", "points of a solve at which functions may have no value"),
        row("bratio", Real(0.0, 1.0), "0.25", "1: a solve does not begin at the basis of the one before"),
        row("holdfixed", Real(-INF, INF), "0", "not 0: fixed variables are constants of the solve"),
        row("scaleopt", Real(-INF, INF), "0", "not 0: `.scale` of variables and equations counts"),
        row("optfile", Whole(0.0, INF), "0", "number of the option file: 1 is `pounce.opt`, 2 `pounce.op2`; 0: none"),
        row("solveopt", WordsOrReal(&["merge", "replace", "clear"], 0.0, 2.0), "merge", "levels of equations and variables that are not in a solve: `merge` keeps them"),
        row("savepoint", Whole(-INF, INF), "0", "GDX file of levels and marginals: 1 of the last solve, 2 of each"),
        row("optcr", Real(0.0, INF), "1e-4", "relative gap at which a program with integers is solved"),
        row("optca", Real(0.0, INF), "0", "absolute gap at which a program with integers is solved"),
        row("nodlim", Whole(0.0, INF), "0", "nodes of a search over integers; 0: any number"),
        row("cutoff", Real(-INF, INF), "none", "objective that a program with integers is to be better than"),
        row("cheat", Real(0.0, INF), "0", "by how much each integer solution is better than the last"),
        row("tryint", Real(0.0, INF), "0", "levels at the start that are this near to integers are tried as a solution"),
        row("prioropt", Real(-INF, INF), "0", "not 0: the discrete variable with the least `.prior` is branched on first"),
        row("certify", Switch, "no", "whether the objective of a linear program is enclosed by a proved interval"),
        row("ranging", Switch, "no", "whether linear programs get the ranges of their data"),
        row("log", Switch, "no", "whether the log of the solver is shown"),
        row("gams_power", Switch, "no", "whether `x**y` is rounded as exp(y·log x)"),
        row("seed", Whole(-INF, INF), "3141", "where random numbers begin"),
        row("strictsingleton", Whole(0.0, 1.0), "1", "1: a singleton set that is given several elements is an error; 0: it takes the first"),
        row("decimals", Whole(0.0, 8.0), "3", "decimals of `display`"),
        row("dispwidth", Whole(10.0, 31.0), "10", "width of columns of `display`"),
        row("solprint", WordsOrReal(&["on", "off", "report", "quiet", "summary", "silent"], 0.0, 2.0), "on", "whether levels are shown after a solve where the text displays nothing"),
        row("limrow", Whole(0.0, INF), "3", "rows in GAMS's listing; here `bmod list` prints them"),
        row("limcol", Whole(0.0, INF), "3", "columns in GAMS's listing; here `bmod list` prints them"),
        row("sysout", WordsOrReal(&["on", "off"], 0.0, 1.0), "off", "messages of solvers in GAMS's listing; here `log` prints them"),
        row("solvelink", Whole(0.0, 7.0), "2", "how GAMS starts its solvers; here they are part of the program: with 3, 4, 6 and 7 the solution waits for handleCollect"),
    ],
    more: None,
    ignored: &[
        "asyncsollst", "checkerrorlevel", "debugtask", "dmpopt", "dmpsym", "dmpusersym", "dualcheck",
        "ecimplicitload", "eclogline", "eject", "ejectx", "epstozero", "fddelta", "fdopt", "filtered", "forcework",
        "forlim", "format", "gdxuels", "hessscale", "holdfixedasync", "idcprotect", "integer1", "integer2",
        "integer3", "integer4", "integer5", "intvarup", "maxgenericfiles", "mcprholdfx", "measure", "memorystat",
        "oldname", "on115", "prefixloadpath", "profile", "profiletol", "real1", "real2", "real3", "real4", "real5",
        "reform", "replace", "requestmarginals", "solslack", "solver", "sparseopt", "sparserun", "sparseval",
        "subsystems", "sys10", "sys11", "sys12", "sys15", "sys16", "sys17", "sys18", "sys19", "threads",
        "threadsasync", "validation", "work", "workfactor", "workspace", "zerores", "zeroresrep", "zerotoeps",
    ],
};

/// GAMS's names of solvers: bmod's own stand in for them.
#[rustfmt::skip]
const GAMS_SOLVERS: &[&str] = &[
    "alphaecp", "ampl", "antigone", "baron", "bdmlp", "bench", "bonmin", "cbc", "conopt", "conopt2", "conopt3",
    "conopt4", "convert", "convertd", "copt", "couenne", "cplex", "cplexd", "de", "decisc", "decism", "dicopt",
    "examiner", "examiner2", "gamschk", "glpk", "gurobi", "guss", "highs", "ipopt", "ipopth", "jams", "kestrel",
    "knitro", "lgo", "lindo", "lindoglobal", "lingo", "localsolver", "miles", "minos", "minos5", "minos55",
    "mosek", "mps2gms", "mpsge", "msnlp", "nlpec", "odhcplex", "octeract", "oqnlp", "osicplex", "osigurobi",
    "osimosek", "osixpress", "osl", "path", "pathc", "pathnlp", "quadminos", "sbb", "scensolver", "scip",
    "selkie", "shot", "snopt", "soplex", "xa", "xpress", "zoom",
];

/// Whether an option chooses a solver: that of a problem type, or of GAMS's `emp`.
pub fn chooses_solver(name: &str) -> bool {
    ProblemType::named(name).is_some() || name.eq_ignore_ascii_case("emp")
}

/// Whether an option is the language's and not a solver's.
pub fn is_option(name: &str) -> bool {
    LANGUAGE.find(name).is_some() || LANGUAGE.ignores(name) || chooses_solver(name)
}

impl Solvers {
    /// Looks up an option of the language or of a solver.
    pub fn check(&self, name: &str, value: &str) -> Result<Accepted, Refused> {
        if value.eq_ignore_ascii_case("default") && self.has_option(name) {
            return Ok(Accepted::Taken);
        }
        if chooses_solver(name) {
            return self.check_choice(ProblemType::named(name), value);
        }
        check(self.tables, name, value).map_err(|refused| match refused {
            Refused::Unknown(_) => {
                let types = ProblemType::ALL.iter().map(|t| t.name());
                let rows = self.tables.iter().flat_map(|t| t.all()).map(|r| r.name);
                Refused::Unknown(nearest(name, types.chain(rows)).map(str::to_string))
            }
            refused => refused,
        })
    }

    fn has_option(&self, name: &str) -> bool {
        is_option(name) || self.tables.iter().any(|t| t.find(name).is_some())
    }

    /// Looks up the solver of a type.
    fn check_choice(&self, using: Option<ProblemType>, solver: &str) -> Result<Accepted, Refused> {
        let called = |own: &str| own.eq_ignore_ascii_case(solver);
        let mut own = self
            .names
            .iter()
            .filter(|(name, _)| called(name))
            .peekable();
        if own.peek().is_some() {
            let Some(using) = using else {
                return Ok(Accepted::Ignored);
            };
            return match own.any(|(_, types)| types.contains(&using)) {
                true => Ok(Accepted::Taken),
                false => Err(Refused::Unsuited(using)),
            };
        }
        if GAMS_SOLVERS.iter().any(|s| called(s)) {
            return Ok(Accepted::Ignored);
        }
        let names = self.names.iter().map(|n| n.0);
        let near = nearest(solver, names).map(str::to_string);
        Err(Refused::Solver(near, self.all_names()))
    }

    /// The names of all solvers.
    pub fn all_names(&self) -> String {
        let mut all: Vec<&str> = Vec::new();
        for (name, _) in self.names {
            if !all.contains(name) {
                all.push(name);
            }
        }
        all.join(", ")
    }
}
