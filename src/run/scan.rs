//! Which tables a statement may scan: those must be tidy before it runs.

use crate::check::node::*;
use crate::check::visit::{Reading, Visitor};

/// Collects tables whose order matters, and those that may drive a sum or an assignment.
#[derive(Default)]
pub(super) struct Scans {
    tables: Vec<TableId>,
    /// Records that are read here may be scanned.
    driving: bool,
}

impl Scans {
    /// Tables in domains, conditions, sums, `ord` and lags of a statement (not of the statements inside).
    pub(super) fn of(code: &Code) -> Box<[TableId]> {
        // What is stored and what a sparse right side holds are made tidy when they turn out to drive
        // the assignment: an assignment to a few records of a large table must not cost the table.
        let mut scans = Self::default();
        code.walk(&mut scans);
        scans.tables()
    }

    /// What was collected, each once.
    pub(super) fn tables(mut self) -> Box<[TableId]> {
        self.tables.sort_unstable();
        self.tables.dedup();
        self.tables.into()
    }

    /// An expression over which something runs.
    pub(super) fn driving(&mut self, n: &Node) {
        self.with(true, |s| s.node(n));
    }

    fn with(&mut self, driving: bool, f: impl FnOnce(&mut Self)) {
        let before = std::mem::replace(&mut self.driving, driving);
        f(self);
        self.driving = before;
    }
}

impl<'a> Visitor<'a> for Scans {
    fn code(&mut self, _: &'a Code) {}

    fn node(&mut self, n: &'a Node) {
        match &n.kind {
            NodeKind::Aggregate(_, d, body) => {
                self.domain(d);
                self.driving(body);
            }
            NodeKind::OfText(..) => self.with(false, |s| n.walk(s)),
            _ => n.walk(self),
        }
    }

    /// A condition of a loop that draws random numbers tells which turns count.
    fn guard(&mut self, n: &'a Node) {
        let driving = self.driving || n.has_random();
        self.with(driving, |s| s.node(n));
    }

    fn domain(&mut self, d: &'a Domain) {
        self.with(!d.slots.is_empty(), |s| d.walk(s));
    }

    fn part(&mut self, p: &'a Part) {
        self.with(false, |s| p.walk(s));
    }

    fn table(&mut self, t: TableId, how: Reading) {
        match how {
            Reading::Order => self.tables.push(t),
            Reading::Record if self.driving => self.tables.push(t),
            Reading::Record | Reading::Count => {}
        }
    }
}
