//! The types of problems that `solve … using` names.

use std::fmt;

/// What kind of problem a model states. The words are GAMS's; `emp` is known to the checker only, which refuses it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ProblemType {
    /// Linear program.
    Lp,
    /// Relaxed mixed-integer linear program.
    Rmip,
    /// Mixed-integer linear program.
    Mip,
    /// Nonlinear program with smooth functions.
    Nlp,
    /// Nonlinear program whose functions may have kinks.
    Dnlp,
    /// Relaxed mixed-integer nonlinear program.
    Rminlp,
    /// Mixed-integer nonlinear program.
    Minlp,
    /// Quadratically constrained program.
    Qcp,
    /// Relaxed mixed-integer quadratically constrained program.
    Rmiqcp,
    /// Mixed-integer quadratically constrained program.
    Miqcp,
    /// Constrained nonlinear system: as many equations as variables.
    Cns,
    /// Mixed complementarity problem.
    Mcp,
    /// Mathematical program with equilibrium constraints.
    Mpec,
    /// The same with its discrete variables relaxed.
    Rmpec,
}

/// What a problem type makes of discrete variables.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Discrete {
    /// It has none.
    Forbidden,
    /// They take values between their bounds.
    Relaxed,
    /// They take discrete values.
    Decided,
}

use ProblemType::*;

impl ProblemType {
    /// All of them, in the order in which messages list them.
    pub const ALL: [Self; 14] = [
        Lp, Rmip, Mip, Nlp, Dnlp, Rminlp, Minlp, Qcp, Rmiqcp, Miqcp, Cns, Mcp, Mpec, Rmpec,
    ];

    /// The type of that name, in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|t| t.name().eq_ignore_ascii_case(name))
    }

    /// Lower-case name, as after `using`.
    pub fn name(self) -> &'static str {
        match self {
            Lp => "lp",
            Rmip => "rmip",
            Mip => "mip",
            Nlp => "nlp",
            Dnlp => "dnlp",
            Rminlp => "rminlp",
            Minlp => "minlp",
            Qcp => "qcp",
            Rmiqcp => "rmiqcp",
            Miqcp => "miqcp",
            Cns => "cns",
            Mcp => "mcp",
            Mpec => "mpec",
            Rmpec => "rmpec",
        }
    }

    /// Whether `minimizing` or `maximizing` belongs to it.
    pub fn has_objective(self) -> bool {
        !matches!(self, Mcp | Cns)
    }

    /// Whether rows may be paired with variables.
    pub fn has_pairs(self) -> bool {
        matches!(self, Mcp | Mpec | Rmpec)
    }

    /// Whether it is a complementarity problem or a square system: no objective, a row for every variable.
    pub fn is_system(self) -> bool {
        !self.has_objective()
    }

    /// Whether all rows must be linear.
    pub fn is_linear(self) -> bool {
        matches!(self, Lp | Rmip | Mip)
    }

    /// Whether functions of variables may have kinks (`abs`, `max`).
    pub fn allows_kinks(self) -> bool {
        matches!(self, Dnlp | Rminlp | Minlp | Mcp | Cns)
    }

    /// What it makes of discrete variables.
    pub fn discrete(self) -> Discrete {
        match self {
            Lp | Nlp | Dnlp | Qcp | Mcp | Cns => Discrete::Forbidden,
            Rmip | Rminlp | Rmiqcp | Rmpec => Discrete::Relaxed,
            Mip | Minlp | Miqcp | Mpec => Discrete::Decided,
        }
    }

    /// The type that solves the same rows with relaxed discrete variables.
    pub fn relaxation(self) -> Self {
        match self {
            Lp | Mip | Rmip => Rmip,
            Qcp | Miqcp | Rmiqcp => Rmiqcp,
            Mpec | Rmpec => Rmpec,
            Nlp | Dnlp | Minlp | Rminlp | Mcp | Cns => Rminlp,
        }
    }
}

/// As its name.
impl serde::Serialize for ProblemType {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.name())
    }
}

impl fmt::Display for ProblemType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
