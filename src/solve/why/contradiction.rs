//! An irreducible set of rows and bounds of a nonlinear program that is proved to be infeasible: by cones, intervals or a
//! relaxation.
//!
//! The deletion filter (Chinneck & Dravnieks 1991) asks the solvers whether what is left is infeasible still, first of
//! many members at once, in the end of each alone. What is neither proved infeasible nor feasible keeps its member.

use super::{Finding, Member};
use crate::model::instance::{Instance, Objective, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::answer;
use crate::solve::{Budget, ModelStatus, Settings};

/// Seconds for the search.
const MAX_SECONDS: f64 = 60.0;

/// Finds one such set. None: the contradiction is not proved without the objective.
pub(super) fn contradiction(
    using: ProblemType,
    instance: &Instance,
    budget: &Budget,
) -> Option<Finding> {
    budget.within(MAX_SECONDS, u64::MAX, |budget| {
        let filter = Filter {
            using,
            instance,
            budget,
        };
        filter.members()
    })
}

struct Filter<'a, 'm> {
    using: ProblemType,
    instance: &'a Instance,
    budget: &'a Budget<'m>,
}

impl Filter<'_, '_> {
    fn members(&self) -> Option<Finding> {
        let i = self.instance;
        let asks = |&i: &usize| self.instance.rows.relation[i] != Relation::Free;
        let rows: Vec<Member> = (0..i.row_count()).filter(asks).map(Member::Row).collect();
        let finite = |bounds: &[f64], j: usize| bounds[j].is_finite();
        let bounds = (0..i.column_count()).flat_map(|j| {
            let sides = [
                finite(&i.columns.lower, j).then_some(Member::Lower(j)),
                finite(&i.columns.upper, j).then_some(Member::Upper(j)),
            ];
            sides.into_iter().flatten()
        });
        let bounds: Vec<Member> = bounds.collect();
        if self.ask(&rows, &bounds, None) != Asked::Infeasible {
            return None;
        }
        let (mut members, shown) = self.needed(&rows, &|rest, one| self.ask(rest, &bounds, one));
        let (bounds, both) = self.needed(&bounds, &|rest, one| self.ask(&members, rest, one));
        members.extend(bounds);
        members.sort_unstable();
        Some(Finding::Contradiction {
            members,
            shown: shown && both,
        })
    }

    /// The members that cannot be spared, and whether that is shown of each.
    fn needed(
        &self,
        all: &[Member],
        ask: &dyn Fn(&[Member], Option<Member>) -> Asked,
    ) -> (Vec<Member>, bool) {
        let (mut kept, mut shown) = (all.to_vec(), true);
        let mut size = all.len().div_ceil(2);
        while size > 0 {
            let mut begin = 0;
            while begin < kept.len() {
                let end = (begin + size).min(kept.len());
                let rest = [&kept[..begin], &kept[end..]].concat();
                let one = (end == begin + 1).then(|| kept[begin]);
                match ask(&rest, one) {
                    Asked::Infeasible => kept = rest,
                    asked => {
                        shown &= size > 1 || asked == Asked::Feasible;
                        begin = end;
                    }
                }
            }
            size = if size == 1 { 0 } else { size.div_ceil(2) };
        }
        (kept, shown)
    }

    /// Whether these rows and bounds alone can be satisfied. Without one bound the search begins behind it, too.
    fn ask(&self, rows: &[Member], bounds: &[Member], without: Option<Member>) -> Asked {
        if self.budget.is_over() {
            return Asked::Unknown;
        }
        let mut part = self.instance.clone();
        let n = part.column_count();
        let relation = std::mem::replace(
            &mut part.rows.relation,
            vec![Relation::Free; self.instance.row_count()],
        );
        part.columns.lower.fill(f64::NEG_INFINITY);
        part.columns.upper.fill(f64::INFINITY);
        for member in rows.iter().chain(bounds) {
            match *member {
                Member::Row(i) => part.rows.relation[i] = relation[i],
                Member::Lower(j) => part.columns.lower[j] = self.instance.columns.lower[j],
                Member::Upper(j) => part.columns.upper[j] = self.instance.columns.upper[j],
            }
        }
        part.columns.push(0.0, 0.0);
        part.objective = Some(Objective {
            column: n as u32,
            sense: Sense::Minimize,
        });
        let found = self.solved(&part);
        let behind = |at: f64, way: f64| at + way * at.abs().max(1.0);
        let columns = &self.instance.columns;
        let (j, level) = match without {
            Some(Member::Lower(j)) => (j, behind(columns.lower[j], -1.0)),
            Some(Member::Upper(j)) => (j, behind(columns.upper[j], 1.0)),
            _ => return found,
        };
        if found != Asked::Unknown {
            return found;
        }
        part.columns.level[j] = level;
        self.solved(&part)
    }

    fn solved(&self, part: &Instance) -> Asked {
        let found = answer(self.using, None, part, &Settings::default(), self.budget);
        match found.map(|a| a.status) {
            Ok(ModelStatus::Infeasible) => Asked::Infeasible,
            Ok(s) if s.has_solution() => Asked::Feasible,
            _ => Asked::Unknown,
        }
    }
}

/// What a set of members is found to be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    Infeasible,
    Feasible,
    Unknown,
}
