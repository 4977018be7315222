//! The numbers behind the formulas: of each equation one row as it was generated, and the coefficients of a small model.

use super::math::relation_sign;
use super::page::{Block, Page, Setter};
use super::side::short;
use super::text::record;
use super::tree::*;
use super::{Formulation, Row, Scope};
use crate::model::instance::{Instance, Kernel, KernelTerm, Op};
use crate::model::origin::Blocks;
use crate::run::{Generated, Machine};

/// A model with more rows or columns has no table of coefficients.
const MAX_ROWS: usize = 24;
const MAX_COLUMNS: usize = 12;

/// Puts a written-out row beside each formula of a page, and the table of coefficients behind it if the model is small.
pub fn add(page: &mut Page, m: &Machine, g: &Generated) {
    let empty = Formulation::default();
    let mut s = Setter::new(Scope::of(m), &empty);
    for b in page.iter_mut() {
        let Block::Formulas(list) = b else { continue };
        for f in list {
            let symbol = m.symbols.find(&f.name);
            let Some(rows) = symbol.and_then(|s| g.origin.rows.symbol(s)) else {
                continue;
            };
            let i = rows.start;
            let row = Row {
                relation: g.instance.rows.relation[i as usize],
                left: left_side(g, i as usize, &rounded),
                right: rounded(g.instance.rows.rhs[i as usize]),
                ..Row::new(f.name.clone())
            };
            let math = s.row(&row).0;
            f.example = Some((record(&m.store, &f.name, rows.key(i)), math));
        }
    }
    page.extend(table(m, g).into_iter().flatten());
}

/// A number with the digits that are shown.
fn rounded(x: f64) -> Expr {
    let shown = short(x).replace('−', "-").replace('∞', "inf");
    Expr::Number(shown.parse().unwrap_or(x))
}

fn column(g: &Generated, j: usize) -> Expr {
    let b = g.origin.columns.of(j as u32);
    let key = b.key(j as u32).iter().map(|l| Part::Label(*l)).collect();
    Expr::Variable(Variable::Own(b.symbol), key)
}

/// The left side of a row with its labels; `number` writes a number.
pub fn left_side(g: &Generated, i: usize, number: &dyn Fn(f64) -> Expr) -> Expr {
    let p = &g.instance;
    let mut terms = Vec::new();
    for (j, a) in p.matrix.row(i).filter(|t| t.1 != 0.0) {
        terms.push((false, number(a) * column(g, j)));
    }
    for k in &p.nonlinear {
        for t in k.terms().filter(|t| t.row == i) {
            terms.push((false, number(t.coef) * term(g, &k.kernel, t, number)));
        }
    }
    sum(terms)
}

/// A nonlinear term as a formula.
fn term(g: &Generated, k: &Kernel, t: KernelTerm, number: &dyn Fn(f64) -> Expr) -> Expr {
    let variable = |n: u32| column(g, t.columns[n as usize] as usize);
    let constant = |n: u32| number(t.constants[n as usize]);
    let mut stack: Vec<Expr> = Vec::new();
    for op in &k.ops {
        let mut args = stack.split_off(stack.len().saturating_sub(op.arguments()));
        let made = match *op {
            Op::Var(n) => variable(n),
            Op::Const(n) => constant(n),
            Op::Affine(first, x, terms) => {
                let all = (0..terms)
                    .map(|n| (false, constant(first + 1 + n) * variable(x + n)))
                    .chain([(false, constant(first))]);
                sum(all.collect())
            }
            Op::Add(_) => sum(args.into_iter().map(|e| (false, e)).collect()),
            Op::Multiply(_) => product(args.into_iter().map(|e| (false, e)).collect()),
            Op::Negate => negate(args.remove(0)),
            Op::Call(f, _) => Expr::Call(f, args),
            Op::PowerInt(n) => power(args.remove(0), Expr::Number(f64::from(n))),
            Op::Divide => args.remove(0) / args.remove(0),
            Op::Power => power(args.remove(0), args.remove(0)),
        };
        stack.push(made);
    }
    stack.pop().unwrap_or(Expr::Number(0.0))
}

/// The table of coefficients of a small model.
fn table(m: &Machine, g: &Generated) -> Option<[Block; 2]> {
    let p: &Instance = &g.instance;
    if p.row_count() > MAX_ROWS || p.column_count() > MAX_COLUMNS {
        return None;
    }
    let name = |blocks: &Blocks, i: usize| m.origin_name(blocks, i);
    let columns = (0..p.column_count()).map(|j| name(&g.origin.columns, j));
    let head: Vec<String> = [String::new()]
        .into_iter()
        .chain(columns)
        .chain([String::new(), "right side".into()])
        .collect();
    let rows = (0..p.row_count()).map(|i| {
        let mut cells = vec![String::new(); p.column_count()];
        for (j, a) in p.matrix.row(i).filter(|t| t.1 != 0.0) {
            cells[j] = short(a);
        }
        for j in p.terms().filter(|t| t.row == i).flat_map(|t| t.columns) {
            cells[*j as usize] = "f".into();
        }
        cells.insert(0, name(&g.origin.rows, i));
        cells.extend([
            relation_sign(p.rows.relation[i]).into(),
            short(p.rows.rhs[i]),
        ]);
        cells
    });
    let title = match p.is_linear() {
        true => "Coefficients",
        false => "Coefficients (f: the entry depends on the variables)",
    };
    Some([
        Block::Heading(title.into()),
        Block::Table(head, rows.collect()),
    ])
}
