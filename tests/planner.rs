//! The planner never changes which tuples count: random sums and assignments, in random wordings, give
//! what a nest of loops over whole sets gives.

use crate::common::{self, Memory};
use bmod::report::json::RunStatus;

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
        const ATOMS: [&str; 34] = [
            "m(i,j)",
            "n(j,k)",
            "c(i,k)",
            "(a(i,j) > 0.5)",
            "(ord(i) <> ord(k))",
            "(d(k) ne 0)",
            "a(i,j+1)",
            "a(i-2,j)",
            "a(i--1,j++2)",
            "m(i+(ord(k)-3),j)",
            "e(i,i)",
            "e(i,i+1)",
            "a('i2',j)",
            "some(i)",
            "a('i7',j)$some(i)",
            "full(i,j,k)",
            "sum(h, f(k,h))",
            "sum(h$g(h,i), b(j,k))",
            "sum(ii, e(i,ii)*a(ii,j))",
            "sum(ii$(e(i,ii) or e(ii,i)), c(ii,k))",
            "(sum(full(ii,j,k), e(i,ii)) <> 0)",
            "smax(h, f(k,h))",
            "prod(h, g(h,i))",
            "(smin(ii, e(i,ii)) < 0)",
            "max(a(i,j),c(i,k))",
            "(abs(a(i,j)) + sqr(b(j,k)))",
            "(exp(c(i,k)) > 1)",
            "(a(i,j) = 0)",
            "(b(j,k) >= 0)",
            "(x.up(i,j) < inf)",
            "(x.lo(i,j) > -inf)",
            "(c(i,k) > level)",
            "d(k)*(b(j,k) - 2)",
            "a(i,j)/full3(i,j)",
        ];
        match self.below(if depth == 0 { 1 } else { 4 }) {
            0 => format!("({})", self.of(&ATOMS)),
            1 => format!("(not {})", self.condition(depth - 1)),
            _ => {
                let op = self.of(&[
                    "and", "and", "or", "or", "xor", "+", "-", "*", "<>", "<", "imp", "eqv", "=",
                ]);
                // A membership is no number.
                let number = |c: String| {
                    let member = ["(m(", "(n(", "(some(", "(full("];
                    if member
                        .iter()
                        .any(|m| c.trim_start_matches("(not ").starts_with(m))
                        && !op.starts_with(char::is_alphabetic)
                    {
                        return format!("1${c}");
                    }
                    c
                };
                let a = number(self.condition(depth - 1));
                let b = number(self.condition(depth - 1));
                format!("({a} {op} {b})")
            }
        }
    }

    fn body(&mut self, depth: usize) -> String {
        const ATOMS: [&str; 10] = [
            "a(i,j)",
            "b(j,k)",
            "c(i,k)",
            "d(k)",
            "2",
            "a(i+1,j)",
            "e(i,i)",
            "sum(ii, e(ii,i))",
            "max(a(i,j),b(j,k))",
            "a(i,'j1')",
        ];
        match self.below(if depth == 0 { 1 } else { 6 }) {
            0 => self.of(&ATOMS).into(),
            1 => format!("{}*{}", self.body(depth - 1), self.body(depth - 1)),
            2 => format!("({} - {})", self.body(depth - 1), self.body(depth - 1)),
            3 => format!("({})$({})", self.body(depth - 1), self.condition(1)),
            4 => format!(
                "sum(h$(f(k,h) {}), f(k,h)*{})",
                self.of(&["", "and g(h,i)", "or g(h,i)"]),
                self.body(0)
            ),
            _ => format!("{}/4", self.body(depth - 1)),
        }
    }
}

/// Whole numbers, so that sums are the same in any order.
const DATA: &str = "
set i /i1*i9/, j /j1*j7/, k /k1*k8/, h /h1*h3/; alias(i,ii);
set m(i,j), n(j,k), full(i,j,k), some(i) / i3, i7 /, st(i,j,k), su(i,j,k);
parameter a(i,j), b(j,k), c(i,k), d(k), e(i,i), f(k,h), g(h,i), full3(i,j);
scalar level / 1 /;
variable x(i,j); x.up(i,j)$(uniform(0,1) < 0.1) = 5; x.lo('i2',j) = 0;
m(i,j)$(uniform(0,1) < 0.2) = yes; n(j,k)$(uniform(0,1) < 0.2) = yes;
full(i,j,k)$(uniform(0,1) < 0.05) = yes; full3(i,j) = 2;
a(i,j)$(uniform(0,1) < 0.2) = uniformInt(-2,3); b(j,k)$(uniform(0,1) < 0.15) = uniformInt(-2,3);
c(i,k)$(uniform(0,1) < 0.1) = uniformInt(-2,3); d(k)$(uniform(0,1) < 0.3) = uniformInt(-1,2);
e(i,ii)$(uniform(0,1) < 0.15) = uniformInt(-1,1); b('j2','k3') = eps;
f(k,h)$(uniform(0,1) < 0.3) = uniformInt(-1,2); g(h,i)$(uniform(0,1) < 0.3) = uniformInt(1,2);
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
    let key = c.of(&["i,j,k", "i+1,j,k", "i,j--1,k"]);
    let (other, value) = (c.condition(2), c.body(2));
    let seed = seed % 1000 + 1;
    format!(
        "option seed = {seed};{DATA}
scalar s, t / 0 /, difference;
{sum}
loop((i,j,k), if(({condition}){also}, t = t + ({body})));
difference = abs(s - t);
abort$(difference <> 0) 'the sum differs', s, t;
parameter p(i,k), q(i,k);
p(i,k)$(ord(i) < 5) = 7; q(i,k)$(ord(i) < 5) = 7;
p(i,k){left} = {inner};
scalar u;
loop((i,k)$(1{left}), u = 0; loop(j, if({condition}, u = u + ({body}))); q(i,k) = u);
difference = smax((i,k), abs(p(i,k) - q(i,k)));
abort$(difference <> 0) 'the assignment differs', p, q;
parameter v(i,j,k), w(i,j,k);
v('i1',j,k) = 3; w('i1',j,k) = 3;
v({key})$({other}) = {value};
loop((i,j,k), w({key})$({other}) = {value});
difference = smax((i,j,k), abs(v(i,j,k) - w(i,j,k))) + abs(card(v) - card(w));
abort$(difference <> 0) 'the assignment under a condition differs', v, w;
st(i,j,k) = mod(ord(i)+ord(k),3); st(i,j,k) = {other};
loop((i,j,k), su(i,j,k)$({other}) = yes);
difference = sum((i,j,k), st(i,j,k) xor su(i,j,k));
abort$(difference <> 0) 'the set differs', st, su;
s = 0; t = 0; loop((k,i,j)$({other}), s = s + 1; t = t + s*ord(k) + ord(j));
scalar r / 0 /; u = 0; loop((k,i,j), if({other}, r = r + 1; u = u + r*ord(k) + ord(j)));
abort$(s <> r or t <> u) 'the loop differs', s, r, t, u;
"
    )
}

#[test]
fn plans_find_what_loops_find() {
    for seed in 0..600 {
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
