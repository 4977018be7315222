//! Linear programs some of whose columns are discrete, and what their bounds imply: what bridges and solvers share.

mod learn;
pub mod model;
pub mod propagate;

pub use model::Mip;
