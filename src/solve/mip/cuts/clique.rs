//! Cliques: binary columns of which at most one is 1 (or 0), any two of which some row excludes (Johnson & Padberg 1982; Atamtürk,
//! Nemhauser & Savelsbergh 2000).

use super::Separator;
use super::sequence::Inequality;
use crate::solve::mip::model::Mip;

/// Where a clique is begun at a point, at most, and what all of them may cost, in entries of sets.
const SEEDS: usize = 300;
const EFFORT: usize = 2_000_000;

/// By how much a clique is violated.
const VIOLATION: f64 = 1e-3;

/// What excludes what: literal 2j stands for column j at 1, 2j + 1 for it at 0.
pub(super) struct Conflicts {
    /// Literals of which a row lets one hold at most.
    sets: Vec<Vec<u32>>,
    /// By literal: the sets that it is in.
    of: Vec<Vec<u32>>,
}

impl Conflicts {
    /// What single rows say.
    pub(super) fn find(mip: &Mip, lower: &[f64], upper: &[f64]) -> Self {
        let p = &mip.problem;
        let mut found = Self {
            sets: Vec::new(),
            of: vec![Vec::new(); 2 * p.n()],
        };
        for i in 0..p.m() {
            for (sign, side) in [(1.0, p.row_upper[i]), (-1.0, -p.row_lower[i])] {
                let mut room = side;
                let mut weights: Vec<(f64, usize)> = Vec::new();
                for (j, a) in p.rows.line(i).map(|(j, a)| (j, sign * a)) {
                    room -= (a * lower[j]).min(a * upper[j]);
                    if mip.is_binary(j, lower, upper) {
                        weights.push((a.abs(), 2 * j + usize::from(a < 0.0)));
                    }
                }
                weights.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
                let excludes =
                    |w: &[(f64, usize)]| w[0].0 + w[1].0 > room + 1e-6 * room.abs().max(1.0);
                let pairs = weights.windows(2).take_while(|w| excludes(w)).count();
                if pairs > 0 {
                    let set = weights[..=pairs].iter().map(|w| w.1 as u32);
                    found.push(set.collect());
                }
            }
        }
        found
    }

    fn push(&mut self, set: Vec<u32>) {
        for &l in &set {
            self.of[l as usize].push(self.sets.len() as u32);
        }
        self.sets.push(set);
    }

    /// Violated cliques.
    pub(super) fn separate(&self, separator: &Separator, values: &[f64]) -> Vec<Inequality> {
        let value = |l: u32| match (values[l as usize / 2], l % 2) {
            (v, 0) => v,
            (v, _) => 1.0 - v,
        };
        let mut seeds: Vec<u32> = (0..2 * separator.n() as u32)
            .filter(|&l| value(l) > VIOLATION && self.of[l as usize].len() > 1)
            .collect();
        let by_value = |a: &u32, b: &u32| value(*b).total_cmp(&value(*a)).then(a.cmp(b));
        seeds.sort_by(by_value);
        let mut met = vec![0u32; self.of.len()];
        let (mut stamp, mut effort) = (0, EFFORT);
        let mut cuts = Vec::new();
        for &seed in seeds.iter().take(SEEDS) {
            let mut clique = vec![seed];
            let mut others = Vec::new();
            let mut last = seed;
            loop {
                stamp += 1;
                for &set in &self.of[last as usize] {
                    let set = &self.sets[set as usize];
                    effort = effort.saturating_sub(set.len());
                    for &l in set {
                        if clique.len() == 1 && met[l as usize] != stamp && l != seed {
                            others.push(l);
                        }
                        met[l as usize] = stamp;
                    }
                }
                if clique.len() == 1 {
                    others.sort_by(by_value);
                } else {
                    others.retain(|&l| l != last && met[l as usize] == stamp);
                }
                let Some(&next) = others.first().filter(|_| effort > 0) else {
                    break;
                };
                clique.push(next);
                last = next;
            }
            let sum: f64 = clique.iter().map(|&l| value(l)).sum();
            if sum > 1.0 + VIOLATION && !self.is_of_one_row(&clique) {
                let zeros = clique.iter().map(|l| l % 2).sum::<u32>();
                let sign = |l: u32| 1.0 - 2.0 * f64::from(l % 2);
                cuts.push(Inequality {
                    terms: clique.iter().map(|&l| (l as usize / 2, sign(l))).collect(),
                    side: 1.0 - f64::from(zeros),
                });
            }
        }
        cuts
    }

    /// Whether a single row says it: other cuts make more of that row.
    fn is_of_one_row(&self, clique: &[u32]) -> bool {
        let has = |set: &u32| {
            let of = |l: &u32| self.of[*l as usize].binary_search(set).is_ok();
            clique.iter().all(of)
        };
        self.of[clique[0] as usize].iter().any(has)
    }
}
