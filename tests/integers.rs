//! Programs with discrete variables: optima that are proved, a limit on memory, and HiGHS beside the own search.

use crate::common::{self, Memory};
use bmod::report::json::SolveReport;
use bmod::run::Options;

/// Models over data that are drawn, one line each; `seed` is set before them.
const MODELS: &[&str] = &[
    // knapsack in three dimensions
    "set i /1*14/, k /1*3/; parameter c(i), w(k,i); c(i) = uniformint(5,40); w(k,i) = uniformint(3,30);
     binary variable x(i); variable z; equation o, r(k); o.. z =e= sum(i, c(i)*x(i));
     r(k).. sum(i, w(k,i)*x(i)) =l= floor(0.4*sum(i, w(k,i)));
     model m /all/; m.optcr = 0; solve m using mip maximizing z;",
    // generalised assignment
    "set i /1*3/, j /1*8/; parameter c(i,j), a(i,j); c(i,j) = uniformint(10,50); a(i,j) = uniformint(5,20);
     binary variable x(i,j); variable z; equation o, once(j), room(i); o.. z =e= sum((i,j), c(i,j)*x(i,j));
     once(j).. sum(i, x(i,j)) =e= 1;  room(i).. sum(j, a(i,j)*x(i,j)) =l= ceil(1.1*sum(j, a(i,j))/3);
     model m /all/; m.optcr = 0; solve m using mip minimizing z;",
    // lot sizing, with numbers that are no integers
    "set t /1*7/; parameter d(t), s(t), h(t); d(t) = uniform(10,40); s(t) = uniform(40,90); h(t) = uniform(0.5,2);
     positive variable x(t), v(t); binary variable y(t); variable z; equation o, b(t), u(t);
     o.. z =e= sum(t, s(t)*y(t) + h(t)*v(t));  b(t).. v(t-1) + x(t) =e= d(t) + v(t);  u(t).. x(t) =l= 75*y(t);
     model m /all/; m.optcr = 0; solve m using mip minimizing z;",
    // sequencing with a big M
    "set j /1*4/; alias (j,k); parameter p(j), d(j), w(j); p(j) = uniformint(2,9); d(j) = uniformint(4,20); w(j) = uniformint(1,5);
     positive variable s(j), l(j); binary variable o(j,k); variable z; equation a(j,k), b(j,k), t(j), c;
     a(j,k)$(ord(j) < ord(k)).. s(k) =g= s(j) + p(j) - 40*(1 - o(j,k));
     b(j,k)$(ord(j) < ord(k)).. s(j) =g= s(k) + p(k) - 40*o(j,k);
     t(j).. l(j) =g= s(j) + p(j) - d(j);  c.. z =e= sum(j, w(j)*l(j));
     model m /all/; m.optcr = 0; solve m using mip minimizing z;",
    // semicontinuous purchases in lots
    "set r /1*6/; parameter c(r), q(r); c(r) = uniform(10,40); q(r) = uniform(0,4);
     semicont variable x(r); integer variable n(r); variable z; equation o, amount, good, lot(r);
     x.lo(r) = 10; x.up(r) = 50; n.up(r) = 9;
     o.. z =e= sum(r, c(r)*x(r) + 25*n(r));  amount.. sum(r, x(r)) =e= 90;
     good.. sum(r, q(r)*x(r)) =l= 170;  lot(r).. x(r) =l= 8*n(r);
     model m /all/; m.optcr = 0; solve m using mip minimizing z;",
    // costs in pieces, by ordered sets
    "set k /1*3/, p /1*5/; parameter a(p) /1 0, 2 10, 3 25, 4 45, 5 70/, f(k,p); f(k,p) = a(p)*uniform(0.6,1.6) + 10$(ord(p) > 1);
     sos2 variable l(k,p); variable z; equation o, one(k), need; l.up(k,p) = 1;
     o.. z =e= sum((k,p), f(k,p)*l(k,p));  one(k).. sum(p, l(k,p)) =e= 1;  need.. sum((k,p), a(p)*l(k,p)) =g= 120;
     model m /all/; m.optcr = 0; solve m using mip minimizing z;",
];

const SEEDS: u64 = 5;

fn solved(text: &str, options: Options) -> SolveReport {
    let finished = common::run(&mut Memory::text(text), "m.blk", options);
    common::last_solve(&finished).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn drawn() -> impl Iterator<Item = String> {
    let of = |m: &'static &str| (1..=SEEDS).map(move |s| format!("option seed = {s};\n{m}"));
    MODELS.iter().flat_map(of)
}

fn number(value: impl serde::Serialize) -> f64 {
    let value = serde_json::to_value(value).expect("a number");
    value.as_f64().expect("a finite number")
}

/// Solution and bound of thirty small programs, proved in interval or rational arithmetic.
#[test]
fn thirty_optima_are_proved() {
    let mut count = 0;
    for text in drawn() {
        let s = solved(
            &text,
            Options {
                certify: true,
                ..common::quiet()
            },
        );
        let z = number(s.objective);
        let [low, high] = s.bounds.expect("an interval").map(number);
        assert_eq!(s.model_status.code, 1, "{text}");
        let tolerance = 1e-8 * z.abs().max(1.0);
        assert!(
            low <= high && high - low <= tolerance,
            "[{low}, {high}]\n{text}"
        );
        assert!(low - tolerance <= z && z <= high + tolerance, "{z}\n{text}");
        count += 1;
    }
    assert_eq!(count, 30);
}

/// Bins for so many things that the tree has no end: what was found is there when the memory is used up.
#[test]
fn open_nodes_are_limited_by_memory() {
    let text = "set i /1*40/, b /1*20/; parameter s(i); s(i) = uniformint(26,49);
        binary variable y(b), x(i,b); variable n; equation one(i), room(b), o;
        one(i).. sum(b, x(i,b)) =e= 1;  room(b).. sum(i, s(i)*x(i,b)) =l= 100*y(b);  o.. n =e= sum(b, y(b));
        model m /all/; option optcr = 0, mip = bmip; solve m using mip minimizing n;";
    let mut host = Memory::text(text);
    let now = bmod::host::Host::memory(&host);
    let options = Options {
        time_limit: 30.0,
        max_memory: Some(now + (20 << 20)),
        ..common::quiet()
    };
    let finished = common::run(&mut host, "m.blk", options);
    let s = common::last_solve(&finished).unwrap_or_else(|e| panic!("{e}"));
    assert!(
        matches!(s.model_status.code, 1 | 8 | 14),
        "{:?}",
        s.model_status
    );
    assert!(
        matches!(s.solver_status.code, 1 | 3),
        "{:?}",
        s.solver_status
    );
}

#[cfg(feature = "highs")]
mod highs {
    use super::*;

    /// The same values as the own search.
    #[test]
    fn highs_agrees_with_the_own_search() {
        for text in drawn() {
            let own = solved(&format!("option mip = bmip;\n{text}"), common::quiet());
            let other = solved(&format!("option mip = highs;\n{text}"), common::quiet());
            let ordered = text.contains("sos2");
            assert_eq!(other.solver, if ordered { "bmip" } else { "highs" });
            assert_eq!(other.model_status.code, 1, "{text}");
            let (a, b) = (number(own.objective), number(other.objective));
            assert!((a - b).abs() <= 1e-6 * a.abs().max(1.0), "{a} {b}\n{text}");
        }
    }

    /// Linear and convex quadratic programs where it is named, and what has no solution.
    #[test]
    fn highs_solves_what_it_is_named_for() {
        let text = |using: &str, objective: &str, rows: &str| {
            format!(
                "option lp = highs, qcp = highs, mip = highs; positive variables x, y; variable z; equations o, r, s;
                 o.. z =e= {objective};  r.. x + 2*y =l= 8;  s.. {rows};
                 model m /all/; solve m using {using} maximizing z;"
            )
        };
        for (using, objective, rows, status, value) in [
            ("lp", "2*x + 3*y", "3*x + y =l= 9", 1, Some(13.0)),
            ("lp", "2*x + 3*y", "3*x + y =g= 90", 4, None),
            ("lp", "2*x - 3*y", "3*x - 900*y =l= 9", 1, Some(15.88411)),
            (
                "qcp",
                "4*x + 2*y - sqr(x) - sqr(y) + x*y",
                "x + y =l= 9",
                1,
                Some(9.285714), // on x + 2y = 8: y = 34/14
            ),
        ] {
            let s = solved(&text(using, objective, rows), common::quiet());
            assert_eq!(s.model_status.code, status, "{using} {objective}");
            if let Some(v) = value {
                assert_eq!(s.solver, "highs", "{using} {objective}");
                let z = number(s.objective);
                assert!((z - v).abs() < 1e-3, "{objective}: {z}");
            }
        }
    }

    /// Levels are offered as a start; the number of nodes and the cutoff count.
    #[test]
    fn highs_keeps_to_limits() {
        let text = drawn().next().expect("a model");
        let best = number(solved(&text, common::quiet()).objective);
        for (more, status) in [("m.cutoff = 1e6;", 10), ("m.cutoff = 1;", 1)] {
            let again =
                format!("option mip = highs;\n{text}\n{more} solve m using mip maximizing z;");
            let s = solved(&again, common::quiet());
            assert_eq!(s.model_status.code, status, "{more}");
            if status == 1 {
                assert!((number(s.objective) - best).abs() < 1e-6);
            }
        }
    }
}

/// Of every node of a search that came to its end one knows what became of it.
#[test]
fn a_finished_tree_leaves_no_node_open() {
    let text = "set i /1*20/, k /1*5/; parameter w(k,i), c(i), b(k);
        w(k,i) = uniformint(5,100); c(i) = sum(k, w(k,i))/5 + uniformint(0,20); b(k) = floor(sum(i, w(k,i))/2);
        binary variable x(i); variable z; equations v, r(k); v.. z =e= sum(i, c(i)*x(i)); r(k).. sum(i, w(k,i)*x(i)) =l= b(k);
        model m /all/; m.optcr = 0; option mip = bmip; solve m using mip maximizing z;";
    let collected = || Options {
        collect: true,
        ..common::quiet()
    };
    let s = solved(text, collected());
    let search = s.search.expect("a search");
    let tree = &search.tree;
    assert!(search.nodes > 20 && search.left_out == 0, "{search:?}");
    assert!(tree.iter().all(|n| n.fate != "open"), "{search:?}");
    let children = |k: usize| tree.iter().filter(|n| n.parent == Some(k as u32)).count();
    let divided = |k: usize| 2 * usize::from(tree[k].fate == "branched");
    assert!(
        (0..tree.len()).all(|k| children(k) == divided(k)),
        "{search:?}"
    );
    let found = tree.iter().filter_map(|n| n.solution.map(number));
    assert_eq!(found.reduce(f64::max), Some(number(s.objective)));
    // and a search that ends at a limit says what may do better
    let s = solved(
        &text.replace("m.optcr", "m.nodlim = 3; m.optcr"),
        collected(),
    );
    let search = s.search.expect("a search");
    assert!(search.tree.iter().any(|n| n.fate == "open"), "{search:?}");
    assert!(s.hint.is_some_and(|h| h.contains("small models")));
}

/// Where a proof was asked for and there is none, the answer says so.
#[test]
fn a_proof_that_is_not_made_is_missed() {
    let text = "integer variable x; variable z; equation o; o.. z =e= sqr(x - 1.3); model m /all/; solve m using miqcp minimizing z;";
    let certify = Options {
        certify: true,
        ..common::quiet()
    };
    let s = solved(text, certify);
    assert!(s.bounds.is_none() && s.message.is_some_and(|m| m.contains("no bound is proved")));
}
