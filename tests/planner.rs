//! The planner never changes which tuples count: random sums and assignments, in random wordings, give
//! what a nest of loops over whole sets gives.

mod common;

use bmod::report::json::RunStatus;
use common::Memory;

/// Fixed stream of choices.
struct Choice(u64);

impl Choice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }

    fn condition(&mut self, depth: usize) -> String {
        match self.below(if depth == 0 { 6 } else { 9 }) {
            0 => "m(i,j)".into(),
            1 => "n(j,k)".into(),
            2 => "c(i,k)".into(),
            3 => "(a(i,j) > 0.5)".into(),
            4 => "(ord(i) <> ord(k))".into(),
            5 => "(d(k) ne 0)".into(),
            6 => format!(
                "({} and {})",
                self.condition(depth - 1),
                self.condition(depth - 1)
            ),
            7 => format!(
                "({} or {})",
                self.condition(depth - 1),
                self.condition(depth - 1)
            ),
            _ => format!("(not {})", self.condition(depth - 1)),
        }
    }

    fn body(&mut self, depth: usize) -> String {
        match self.below(if depth == 0 { 5 } else { 10 }) {
            0 => "a(i,j)".into(),
            1 => "b(j,k)".into(),
            2 => "c(i,k)".into(),
            3 => "d(k)".into(),
            4 => "2".into(),
            5 => format!("{}*{}", self.body(depth - 1), self.body(depth - 1)),
            6 => format!("({} - {})", self.body(depth - 1), self.body(depth - 1)),
            7 => format!("({})$({})", self.body(depth - 1), self.condition(1)),
            8 => format!(
                "sum(h$(f(k,h) {}), f(k,h)*{})",
                self.of(&["", "and g(h,i)", "or g(h,i)"]),
                self.body(0)
            ),
            _ => format!("{}/4", self.body(depth - 1)),
        }
    }
}

const DATA: &str = "
set i /i1*i4/, j /j1*j3/, k /k1*k5/, h /h1*h3/;
set m(i,j), n(j,k); parameter a(i,j), b(j,k), c(i,k), d(k), f(k,h), g(h,i);
m(i,j)$(uniform(0,1) < 0.4) = yes; n(j,k)$(uniform(0,1) < 0.4) = yes;
a(i,j)$(uniform(0,1) < 0.5) = uniform(0,1); b(j,k)$(uniform(0,1) < 0.5) = uniform(-1,1);
c(i,k)$(uniform(0,1) < 0.3) = uniform(-1,1); d(k)$(uniform(0,1) < 0.6) = uniform(0,1);
f(k,h)$(uniform(0,1) < 0.5) = uniform(0,1); g(h,i)$(uniform(0,1) < 0.5) = uniform(0,1);
";

fn case(seed: u64) -> String {
    let mut c = Choice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let (condition, body) = (c.condition(2), c.body(2));
    let order = c.of(&[
        "(i,j,k)",
        "(k,j,i)",
        "(j,i,k)",
        "(m(i,j),k)",
        "(k,m(i,j))",
        "(m(i,j),n(j,k))",
        "(i,n(j,k))",
    ]);
    let also = match order {
        "(m(i,j),k)" | "(k,m(i,j))" => " and m(i,j)",
        "(m(i,j),n(j,k))" => " and m(i,j) and n(j,k)",
        "(i,n(j,k))" => " and n(j,k)",
        _ => "",
    };
    let sum = if c.below(2) == 0 {
        format!("s = sum({order}$({condition}), {body});")
    } else {
        format!("s = sum({order}, ({body})$({condition}));")
    };
    let inner = format!("sum(j$({condition}), {body})");
    let left = if c.below(2) == 0 {
        String::new()
    } else {
        "$(c(i,k) or d(k))".to_string()
    };
    let seed = seed % 1000 + 1;
    format!(
        "option seed = {seed};{DATA}
scalar s, t / 0 /, difference;
{sum}
loop((i,j,k), if(({condition}){also}, t = t + ({body})));
difference = abs(s - t);
abort$(difference > 1e-9) 'the sum differs', s, t;
parameter p(i,k), q(i,k);
p(i,k)$(ord(i) = 2) = 7; q(i,k)$(ord(i) = 2) = 7;
p(i,k){left} = {inner};
scalar u;
loop((i,k)$(1{left}), u = 0; loop(j, if({condition}, u = u + ({body}))); q(i,k) = u);
difference = smax((i,k), abs(p(i,k) - q(i,k)));
abort$(difference > 1e-9) 'the assignment differs', p, q;
"
    )
}

#[test]
fn plans_find_what_loops_find() {
    for seed in 0..400 {
        let text = case(seed);
        let finished = common::run(&mut Memory::text(&text), "m.blk", common::quiet());
        let messages: Vec<&String> = finished.diagnostics.iter().map(|d| &d.message).collect();
        assert_eq!(
            finished.end,
            RunStatus::Ok,
            "seed {seed}: {messages:?}\n{text}"
        );
    }
}
