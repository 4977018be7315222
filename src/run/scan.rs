//! Which tables a statement may scan: those must be tidy before it runs.

use crate::check::node::*;

/// Tables in domains, conditions, sums, `ord` and lags of a statement (not of the statements inside).
pub fn scanned(kind: &CodeKind) -> Box<[TableId]> {
    let mut out = Vec::new();
    let o = &mut out;
    match kind {
        CodeKind::Assign {
            domain, key, value, ..
        } => {
            // What is stored and what a sparse right side holds are made tidy when they turn out to drive
            // the assignment: an assignment to a few records of a large table must not cost the table.
            self::domain(domain, o);
            expr(value, false, o);
            self::key(key, o);
        }
        CodeKind::Loop(d, _) => domain(d, o),
        CodeKind::While(c, _) => expr(c, false, o),
        CodeKind::Repeat(_, c) => expr(c, false, o),
        CodeKind::For { from, to, by, .. } => {
            expr(from, false, o);
            expr(to, false, o);
            by.iter().for_each(|b| expr(b, false, o));
        }
        CodeKind::If(arms, _) => arms.iter().for_each(|(c, _)| expr(c, false, o)),
        CodeKind::Break(c, _) | CodeKind::Continue(c) | CodeKind::Display(c, _) => {
            c.iter().for_each(|c| expr(c, false, o))
        }
        CodeKind::Abort { condition, .. } => condition.iter().for_each(|c| expr(c, false, o)),
        CodeKind::Put(_, c, items) => {
            c.iter().for_each(|c| expr(c, false, o));
            for i in items {
                match i {
                    PutCode::Column(e) | PutCode::Row(e) | PutCode::Item { value: e, .. } => {
                        expr(e, false, o)
                    }
                    _ => {}
                }
            }
        }
        _ => {}
    }
    out.sort_unstable();
    out.dedup();
    out.into()
}

/// Tables of a domain.
pub fn domain(d: &Domain, out: &mut Vec<TableId>) {
    for m in &d.members {
        out.push(m.table);
        key(&m.key, out);
    }
    out.extend(&d.sets);
    d.conditions
        .iter()
        .for_each(|c| expr(c, !d.slots.is_empty(), out));
}

fn key(k: &Key, out: &mut Vec<TableId>) {
    k.parts.iter().for_each(|p| part(p, out));
}

fn part(p: &Part, out: &mut Vec<TableId>) {
    match p {
        Part::Lag(l) => {
            out.push(l.set);
            part(&l.base, out);
            expr(&l.offset, false, out);
        }
        Part::Singleton(t, _) => out.push(*t),
        _ => {}
    }
}

/// Tables of an expression; with `driving`, also those that a sum or assignment around may scan.
pub fn expr(n: &Node, driving: bool, out: &mut Vec<TableId>) {
    match &n.kind {
        NodeKind::Data(t, k) => {
            if driving {
                out.push(*t);
            }
            key(k, out);
        }
        NodeKind::Var(_, k)
        | NodeKind::Derived(_, _, k)
        | NodeKind::ElementText(_, k)
        | NodeKind::RecordName(_, k) => key(k, out),
        NodeKind::Ord(t, p) | NodeKind::LabelAttribute(_, t, p) => {
            out.push(*t);
            part(p, out);
        }
        NodeKind::LabelText(p) => part(p, out),
        NodeKind::SameAs(a, b) => {
            part(a, out);
            part(b, out);
        }
        NodeKind::OfText(t, n) => {
            expr(t, false, out);
            n.iter().for_each(|n| expr(n, false, out));
        }
        NodeKind::Negate(a) | NodeKind::Not(a) => expr(a, driving, out),
        NodeKind::Sum(t) | NodeKind::Product(t) => {
            t.iter().for_each(|(_, x)| expr(x, driving, out))
        }
        NodeKind::Binary(_, a, b) => {
            expr(a, driving, out);
            expr(b, driving, out);
        }
        NodeKind::Call(_, a) | NodeKind::DataCall(_, a) => {
            a.iter().for_each(|x| expr(x, driving, out))
        }
        NodeKind::Dollar(a, c) => {
            expr(a, driving, out);
            expr(c, driving, out);
        }
        NodeKind::Aggregate(_, d, b) => {
            domain(d, out);
            expr(b, true, out);
        }
        _ => {}
    }
}
