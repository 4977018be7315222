//! Warnings about complementarity models, before they are solved.

use super::Machine;
use crate::check::node::EquationDef;
use crate::diag::Diagnostic;
use crate::model::instance::Instance;
use crate::model::origin::{Blocks, Origin};
use crate::solve::pairing::match_rows;
use crate::solve::structure::{Block, Finding, examine};
use crate::source::Span;

/// Names listed in a message.
const SHOWN: usize = 6;

impl Machine<'_> {
    /// Says what is legal in the model but unlikely to be meant.
    pub(super) fn examine(&self, instance: &Instance, origin: &Origin, square: bool, span: Span) {
        // What cannot be matched is refused by the solve itself.
        let Ok(row_of) = match_rows(instance, square) else {
            return;
        };
        for finding in examine(instance, &row_of, square) {
            match finding {
                Finding::BoundedEquation(pairs) => self.bounded_equations(origin, &pairs, span),
                Finding::Overdetermined(block) => self.singular(
                    origin,
                    &block,
                    span,
                    "E0417",
                    "equations stand in fewer variables than there are equations",
                    "whatever the numbers, they contradict or repeat each other: drop or change an equation, or see whether a variable is missing",
                ),
                Finding::Underdetermined(block) => self.singular(
                    origin,
                    &block,
                    span,
                    "E0418",
                    "free variables stand in fewer rows than there are variables",
                    "whatever the numbers, the rows do not determine them: fix a variable, or see whether it is missing in a row",
                ),
            }
        }
    }

    /// One warning per equation.
    fn bounded_equations(&self, origin: &Origin, pairs: &[(usize, usize)], span: Span) {
        let mut last = None;
        for &(row, column) in pairs {
            let symbol = origin.rows.of(row as u32).symbol;
            if last.replace(symbol) == Some(symbol) {
                continue;
            }
            let of = |d: &&EquationDef| d.symbol == symbol;
            let place = self.equations.iter().find(of).map_or(span, |d| d.span);
            let message = format!(
                "the equation {} is paired with {}, which has a bound",
                self.origin_name(&origin.rows, row),
                self.origin_name(&origin.columns, column)
            );
            Diagnostic::warning("E0416", place)
                .says(message)
                .label("`=e=`, but holds only where the variable is off its bounds")
                .other(span, "at this solve")
                .help("write `=g=` (lower bound) or `=l=` (upper bound) for what it means; make the variable free if the equation shall always hold")
                .note(self);
        }
    }

    fn singular(
        &self,
        origin: &Origin,
        block: &Block,
        span: Span,
        code: &'static str,
        what: &str,
        help: &str,
    ) {
        let list = |blocks: &Blocks, indices: &[usize]| {
            let mut names: Vec<String> = indices
                .iter()
                .take(SHOWN)
                .map(|&i| self.origin_name(blocks, i))
                .collect();
            if indices.len() > SHOWN {
                names.push(format!("… ({} in all)", indices.len()));
            }
            if names.is_empty() {
                "none".to_string()
            } else {
                names.join(", ")
            }
        };
        let message = format!(
            "structurally singular: {what}: rows {}; columns {}",
            list(&origin.rows, &block.rows),
            list(&origin.columns, &block.columns)
        );
        Diagnostic::warning(code, span)
            .says(message)
            .label("at this solve")
            .help(help)
            .note(self);
    }
}
