//! All tests from outside in one program, built and linked once. `robustness.rs` is another: it measures the memory of its process.

mod api;
mod backends;
mod bad_input;
mod certify;
mod common;
mod complementarity;
mod corpus;
mod derivatives;
mod docs;
mod formulation;
mod functions;
mod library;
mod mcp_corpus;
mod mcp_solver;
mod mcp_walls;
mod mistakes;
mod mpec;
mod nonlinear;
mod options;
mod planner;
mod scenes;
mod suite;
mod syntax;
mod syntax_corpus;
mod syntax_mutations;
mod walls;
