//! The types of problems that `solve … using` names.

use super::named::named;
use std::fmt;

named! {
    /// What kind of problem a model states, in the order in which messages list them. The words are GAMS's; `emp` is known to the checker only, which refuses it.
    #[derive(Hash)]
    pub enum ProblemType {
        /// Linear program.
        Lp "lp";
        /// Relaxed mixed-integer linear program.
        Rmip "rmip";
        /// Mixed-integer linear program.
        Mip "mip";
        /// Nonlinear program with smooth functions.
        Nlp "nlp";
        /// Nonlinear program whose functions may have kinks.
        Dnlp "dnlp";
        /// Relaxed mixed-integer nonlinear program.
        Rminlp "rminlp";
        /// Mixed-integer nonlinear program.
        Minlp "minlp";
        /// Quadratically constrained program.
        Qcp "qcp";
        /// Relaxed mixed-integer quadratically constrained program.
        Rmiqcp "rmiqcp";
        /// Mixed-integer quadratically constrained program.
        Miqcp "miqcp";
        /// Constrained nonlinear system: as many equations as variables.
        Cns "cns";
        /// Mixed complementarity problem.
        Mcp "mcp";
        /// Mathematical program with equilibrium constraints.
        Mpec "mpec";
        /// The same with its discrete variables relaxed.
        Rmpec "rmpec";
    }
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
