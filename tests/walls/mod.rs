//! Walls of blocks as complementarity problems: system (7) of Ferris & Tin-Loi (2001), assembled
//! here without the language; and the obstacle problem. For tests and benchmarks of the solver alone.
#![allow(dead_code)]

use std::f64::consts::FRAC_PI_4;

use bmod::solve::mcp::{Data, EvalError, Problem};

/// Mx + q by compressed columns; x₀ is the load factor α.
pub struct Linear {
    data: Data,
    values: Vec<f64>,
    q: Vec<f64>,
}

struct Block {
    left: f64,
    right: f64,
    bottom: f64,
    weight: f64,
}

struct Contact {
    below: Option<usize>,
    above: usize,
    x: f64,
    y: f64,
    bed: bool,
    half_length: f64,
}

const LENGTH: f64 = 4.0;
const HEIGHT: f64 = 1.75;

/// Blocks and contacts of `courses` courses, `width` full lengths wide; the ground course begins and
/// ends with half blocks, the next has full ones only, and so on.
fn geometry(courses: usize, width: usize) -> (Vec<Block>, Vec<Contact>) {
    let (mut blocks, mut contacts): (Vec<Block>, Vec<Contact>) = (Vec::new(), Vec::new());
    let mut under: Vec<usize> = Vec::new();
    for course in 0..courses {
        let lengths = match course % 2 {
            0 => [vec![0.5], vec![1.0; width - 1], vec![0.5]].concat(),
            _ => vec![1.0; width],
        };
        let bottom = course as f64 * HEIGHT;
        let (mut left, mut row) = (0.0, Vec::new());
        for weight in lengths {
            let right = left + weight * LENGTH;
            let above = blocks.len();
            row.push(above);
            blocks.push(Block {
                left,
                right,
                bottom,
                weight,
            });
            let beds: Vec<(Option<usize>, f64, f64)> = match course {
                0 => vec![(None, left, right)],
                _ => under
                    .iter()
                    .map(|&b| {
                        (
                            Some(b),
                            left.max(blocks[b].left),
                            right.min(blocks[b].right),
                        )
                    })
                    .collect(),
            };
            for (below, from, to) in beds.into_iter().filter(|(_, from, to)| to - from > 1e-9) {
                let (x, half_length) = (0.5 * (from + to), 0.5 * (to - from));
                contacts.push(Contact {
                    below,
                    above,
                    x,
                    y: bottom,
                    bed: true,
                    half_length,
                });
            }
            left = right;
        }
        for pair in row.windows(2) {
            let (x, y) = (blocks[pair[0]].right, bottom + 0.5 * HEIGHT);
            contacts.push(Contact {
                below: Some(pair[0]),
                above: pair[1],
                x,
                y,
                bed: false,
                half_length: 0.5 * HEIGHT,
            });
        }
        under = row;
    }
    (blocks, contacts)
}

/// (7) for a wall in running bond, blocks 4 × 1.75, with tan φ = `friction` and φ₀ = φ or 0: norm ⟂ α, compatibility ⟂ x, equilibrium ⟂ u, yield ⟂ z ≥ 0.
pub fn wall(courses: usize, width: usize, friction: f64, associated: bool) -> Linear {
    let (blocks, contacts) = geometry(courses, width);
    let (x0, u0) = (1, 1 + 3 * contacts.len());
    let z0 = u0 + 3 * blocks.len();
    let n = z0 + 4 * contacts.len();
    let mut entries: Vec<(usize, usize, f64)> = Vec::new();
    // Columns: sliding to either side, rocking to either side; rows t, n, m (3), (4).
    let modes = |phi: f64| {
        let (s, c) = phi.sin_cos();
        let (p, o) = FRAC_PI_4.sin_cos();
        [[c, -c, 0.0, 0.0], [-s, -s, -p, -p], [0.0, 0.0, o, -o]]
    };
    let phi = friction.atan();
    let (normals, flows) = (modes(phi), modes(if associated { phi } else { 0.0 }));
    for (i, contact) in contacts.iter().enumerate() {
        let (tangent, normal) = if contact.bed {
            ((1.0, 0.0), (0.0, 1.0))
        } else {
            ((0.0, 1.0), (1.0, 0.0))
        };
        for (block, sign) in [(Some(contact.above), -1.0), (contact.below, 1.0)] {
            let Some(j) = block else { continue };
            let b = &blocks[j];
            let (rx, ry) = (
                contact.x - 0.5 * (b.left + b.right),
                contact.y - b.bottom - 0.5 * HEIGHT,
            );
            for (s, (fx, fy), moment) in [
                (0, tangent, 0.0),
                (1, normal, 0.0),
                (2, (0.0, 0.0), contact.half_length),
            ] {
                for (d, force) in [fx, fy, rx * fy - ry * fx + moment].into_iter().enumerate() {
                    if force != 0.0 {
                        entries.push((u0 + 3 * j + d, x0 + 3 * i + s, sign * force));
                        entries.push((x0 + 3 * i + s, u0 + 3 * j + d, -sign * force));
                    }
                }
            }
        }
        for s in 0..3 {
            for k in 0..4 {
                entries.push((x0 + 3 * i + s, z0 + 4 * i + k, flows[s][k]));
                entries.push((z0 + 4 * i + k, x0 + 3 * i + s, -normals[s][k]));
            }
        }
    }
    let mut q = vec![0.0; n];
    q[0] = -1.0;
    for (j, block) in blocks.iter().enumerate() {
        entries.push((0, u0 + 3 * j, block.weight));
        entries.push((u0 + 3 * j, 0, -block.weight));
        q[u0 + 3 * j + 1] = block.weight;
    }
    entries.retain(|e| e.2 != 0.0);
    entries.sort_by_key(|e| (e.1, e.0));
    let mut col_start = vec![0; n + 1];
    entries.iter().for_each(|e| col_start[e.1 + 1] += 1);
    (0..n).for_each(|j| col_start[j + 1] += col_start[j]);
    Linear {
        data: Data {
            lower: (0..n)
                .map(|i| if i < z0 { f64::NEG_INFINITY } else { 0.0 })
                .collect(),
            upper: vec![f64::INFINITY; n],
            start: vec![0.0; n],
            column_start: col_start,
            rows: entries.iter().map(|e| e.0).collect(),
            is_linear: true,
        },
        values: entries.iter().map(|e| e.2).collect(),
        q,
    }
}

/// The obstacle problem on a string: −u'' ≥ load, u ≥ 0, by n linear elements.
pub fn obstacle(n: usize) -> Linear {
    let h = 1.0 / (n as f64 + 1.0);
    let (mut col_start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..n {
        for i in j.saturating_sub(1)..(j + 2).min(n) {
            rows.push(i);
            values.push(if i == j { 2.0 } else { -1.0 } / h);
        }
        col_start.push(rows.len());
    }
    Linear {
        data: Data {
            lower: vec![0.0; n],
            upper: vec![f64::INFINITY; n],
            start: vec![0.0; n],
            column_start: col_start,
            rows,
            is_linear: true,
        },
        values,
        q: (0..n)
            .map(|i| -h * 10.0 * (9.0 * (i as f64 + 1.0) * h).sin())
            .collect(),
    }
}

impl Problem for Linear {
    fn data(&self) -> &Data {
        &self.data
    }
    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        f.copy_from_slice(&self.q);
        for (j, x) in x.iter().enumerate() {
            for k in self.data.column_start[j]..self.data.column_start[j + 1] {
                f[self.data.rows[k]] += self.values[k] * x;
            }
        }
        Ok(())
    }
    fn jacobian(&mut self, _x: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        values.copy_from_slice(&self.values);
        Ok(())
    }
}
