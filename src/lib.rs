//! bmod: a declarative algebraic modeling language in the GAMS tradition.
#![warn(missing_docs)]
