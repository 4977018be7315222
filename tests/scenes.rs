//! Scenes of `models/block_limit.blk`: pictures that show what the rates say, and scenes that cannot be
//! meant.

use std::collections::BTreeMap;
use std::path::Path;

use crate::common::{self, Memory};
use bmod::check::symbols::attribute;
use bmod::run::{Machine, Options};
use bmod::session::{self, Finished};

/// Runs a file below `models/`, or a text as if it stood there.
fn run(
    folder: &str,
    file: &str,
    text: Option<String>,
    after: &mut dyn FnMut(&mut Machine),
) -> (Memory, Finished) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = text.map(|t| ("scene.blk".to_string(), t));
    let files = scene.into_iter().collect();
    let mut desk = Memory::new(files, Some(root.join("models").join(folder)));
    let options = Options {
        time_limit: 600.0,
        ..Options::default()
    };
    let finished = session::run(&mut desk, file, common::blk(), options, false, after);
    (desk, finished)
}

type Polygon = Vec<[f64; 2]>;

/// The points of all elements of a kind, group by group; a group is known by its attributes.
fn groups(svg: &str, kind: &str) -> Vec<(String, Vec<Polygon>)> {
    let mut out: Vec<(String, Vec<Polygon>)> = Vec::new();
    let mut group = String::new();
    for line in svg.lines().map(str::trim) {
        if line.starts_with("<g ") {
            group = line.to_string();
        }
        let Some(points) = line
            .strip_prefix(&format!("<{kind} "))
            .and_then(|l| l.split("points=\"").nth(1))
            .and_then(|l| l.split('"').next())
        else {
            continue;
        };
        let polygon = points
            .split_whitespace()
            .map(|p| {
                let (x, y) = p.split_once(',').expect("a point");
                [x.parse().expect("x"), y.parse().expect("y")]
            })
            .collect();
        match out.last_mut() {
            Some((g, list)) if *g == group => list.push(polygon),
            _ => out.push((group.clone(), vec![polygon])),
        }
    }
    out
}

/// Signed area.
fn area(p: &[[f64; 2]]) -> f64 {
    (0..p.len())
        .map(|k| {
            let (a, b) = (p[k], p[(k + 1) % p.len()]);
            (a[0] * b[1] - b[0] * a[1]) / 2.0
        })
        .sum()
}

/// The common part of two convex polygons (Sutherland & Hodgman 1974).
fn common(p: &[[f64; 2]], q: &[[f64; 2]]) -> f64 {
    let turn = area(q).signum();
    let mut left = p.to_vec();
    for k in 0..q.len() {
        let (a, b) = (q[k], q[(k + 1) % q.len()]);
        let inside =
            |c: [f64; 2]| turn * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        let mut next = Vec::new();
        for i in 0..left.len() {
            let (c, d) = (left[i], left[(i + 1) % left.len()]);
            let (s, t) = (inside(c), inside(d));
            if s >= 0.0 {
                next.push(c);
            }
            if (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0) {
                let part = s / (s - t);
                next.push([c[0] + part * (d[0] - c[0]), c[1] + part * (d[1] - c[1])]);
            }
        }
        left = next;
    }
    area(&left).abs()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The picture of a mechanism: blocks moved as rigid bodies, hardly any overlap, the contacts that
/// move marked and no others.
fn picture_is_right(what: &str, svg: &str, marked: Option<usize>) {
    let polygons = groups(svg, "polygon");
    let before = polygons.iter().find(|g| g.0.contains("#f3f1ec"));
    let after = polygons.iter().find(|g| g.0.contains("#e0bd93"));
    let (before, after) = (&before.expect("blocks").1, &after.expect("moved blocks").1);
    assert_eq!(before.len(), after.len(), "{what}");
    let mut moved = 0.0f64;
    for (p, q) in before.iter().zip(after) {
        assert_eq!(p.len(), q.len(), "{what}");
        assert!(area(p) * area(q) > 0.0, "{what}: a block turned over");
        for i in 0..p.len() {
            moved = moved.max(distance(p[i], q[i]));
            for j in 0..i {
                let change = distance(p[i], p[j]) - distance(q[i], q[j]);
                assert!(
                    change.abs() < 0.03,
                    "{what}: a block is not rigid, {change}"
                );
            }
        }
    }
    assert!(
        moved > 12.0,
        "{what}: nobody sees a motion of {moved} pixels"
    );
    for (i, p) in after.iter().enumerate() {
        for q in &after[..i] {
            let part = common(p, q) / area(p).abs().min(area(q).abs());
            assert!(part < 0.01, "{what}: blocks overlap by {part:.4}");
        }
    }
    let marks: usize = groups(svg, "polyline")
        .iter()
        .filter(|g| {
            ["#c62828", "#1565c0", "#9e9e9e"]
                .iter()
                .any(|c| g.0.contains(c))
        })
        .map(|g| g.1.len())
        .sum();
    assert!(marks > 0, "{what}: no contact is marked");
    if let Some(marked) = marked {
        assert_eq!(marks, marked, "{what}: contacts marked");
    }
}

/// Contacts of which some rate is more than 1e-6 of the greatest.
fn moving(m: &Machine) -> usize {
    let z = m.symbols.find("z").expect("z");
    let table = m.store.table(m.symbols.get(z).table + attribute::L);
    let mut rates: BTreeMap<u32, f64> = BTreeMap::new();
    for (key, rate) in table.iter() {
        let most = rates.entry(key[0]).or_default();
        *most = most.max(rate);
    }
    let small = 1e-6 * rates.values().fold(0.0f64, |a, &b| a.max(b));
    rates.values().filter(|&&r| r > small).count()
}

#[test]
fn mechanisms_are_drawn_as_they_move() {
    for (folder, file) in [
        ("walls", "example1"),
        ("walls", "example2"),
        ("walls", "example3"),
        ("walls", "example4"),
        ("walls", "example5"),
        ("walls", "example6"),
        ("structures", "arch_semicircular"),
        ("structures", "arch_segmental"),
        ("structures", "arch_buttresses"),
        ("structures", "wall_arch"),
    ] {
        let mut marked = 0;
        let (desk, finished) = run(folder, &format!("{file}.blk"), None, &mut |m| {
            marked = moving(m);
        });
        assert_eq!(finished.end.exit(), 0, "{file}");
        let last = [format!("{file}_collapse.svg"), format!("{file}.svg")];
        let svg = last.iter().find_map(|f| desk.files.get(f));
        picture_is_right(file, svg.expect("a picture"), Some(marked));
    }
}

#[test]
fn the_pictures_of_the_documentation_are_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/figures");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("docs/figures") {
        let path = entry.expect("an entry").path();
        let svg = std::fs::read_to_string(&path).expect("a picture");
        if svg.contains("collapse mechanism") {
            picture_is_right(&path.display().to_string(), &svg, None);
            seen += 1;
        }
    }
    assert!(seen >= 11, "{seen} mechanisms");
}

/// Every scene that cannot be meant, and what is said about it.
const BAD: &[(&str, &str, &str)] = &[
    (
        "overlapping blocks",
        "Sets bodies / g, p, q /, b(bodies) / p, q /, corner / 1*4 /;
         Table vx(bodies,corner)
              1  2  3  4
         g   -9  9  9 -9
         p    0  2  2  0
         q    1  3  3  1;
         Table vy(bodies,corner)
              1  2  3  4
         g   -1 -1
         p          1  1
         q          1  1;",
        "bodies that overlap",
    ),
    (
        "a block in the air",
        "Sets course / k1*k3 /, pos / p1*p3 /;
         Table len(course,pos)
              p1 p2 p3
         k3       1
         k2   -1
         k1    1;",
        "blocks in the air",
    ),
    (
        "two blocks in the air that hold each other",
        "Sets course / k1*k3 /, pos / p1*p3 /;
         Table len(course,pos)
              p1 p2 p3
         k3   -2  1  1
         k1    1;",
        "blocks in the air",
    ),
    (
        "a contact of zero length",
        "Sets bodies / p /, b(bodies) / p /, contacts / c1 /, c(contacts) / c1 /, e / e1, e2 /;
         Parameters cx(bodies), cy(bodies) / p 1 /, weight(bodies) / p 1 /, side(contacts,bodies) / c1.p -1 /,
            ex(contacts,e) / c1.e1 1, c1.e2 1 /, ey(contacts,e);
         cx(bodies) = 0;  ey(c,e) = 0;",
        "contacts without length",
    ),
    (
        "a contact that joins nothing",
        "Sets bodies / p /, b(bodies) / p /, contacts / c1, c2 /, c(contacts) / c1, c2 /, e / e1, e2 /;
         Parameters cx(bodies), cy(bodies) / p 1 /, weight(bodies) / p 1 /, side(contacts,bodies) / c1.p -1 /,
            ex(contacts,e) / (c1,c2).e1 -1, (c1,c2).e2 1 /, ey(contacts,e);
         cx(bodies) = 0;  ey(c,e) = 0;",
        "contacts that join no block",
    ),
    (
        "a block of negative weight",
        "Sets course / k1 /, pos / p1*p2 /;
         Table len(course,pos)
              p1 p2
         k1    1  1;
         Parameter density(course,pos) / k1.p1 1, k1.p2 -1 /;",
        "blocks of negative weight",
    ),
    (
        "friction below zero",
        "Sets course / k1 /, pos / p1 /;
         Parameter len(course,pos) / k1.p1 1 /;
$set friction -0.1
         ",
        "friction below zero",
    ),
    (
        "no live load",
        "Sets course / k1 /, pos / p1 /;
         Parameter len(course,pos) / k1.p1 1 /;
$set push 0
         ",
        "no live load",
    ),
    (
        "a hollow polygon",
        "Sets bodies / g, p /, b(bodies) / p /, corner / 1*4 /;
         Table vx(bodies,corner)
              1  2  3  4
         g   -9  9  9 -9
         p    0  3  1  0;
         Table vy(bodies,corner)
              1  2  3  4
         g   -1 -1
         p          1  3;",
        "no convex polygons",
    ),
    (
        "no block",
        "Sets course / k1 /, pos / p1 /;
         Parameter len(course,pos) / k1.p1 -1 /;",
        "there is no block",
    ),
    (
        "a course without height",
        "Sets course / k1 /, pos / p1 /;
         Parameters len(course,pos) / k1.p1 1 /, rise(course);
         rise(course) = 0;",
        "heights of blocks are positive",
    ),
];

/// How the included scene goes on.
const SOLVES: &str = "
$include block_limit.blk
solve static    using lp maximizing alpha;
solve kinematic using lp minimizing rate;
solve collapse  using mcp;
";

#[test]
fn scenes_that_cannot_be_meant_stop_with_a_message() {
    for (what, scene, says) in BAD {
        let (_, finished) = run(
            "",
            "scene.blk",
            Some(format!("{scene}{SOLVES}")),
            &mut |_| {},
        );
        let messages: Vec<&str> = finished
            .diagnostics
            .iter()
            .map(|d| d.message.as_str())
            .collect();
        assert_eq!(finished.end.exit(), 3, "{what}: {messages:?}");
        assert!(
            messages.iter().any(|m| m.contains(says)),
            "{what}: {messages:?}"
        );
        assert!(finished.report.solves.is_empty(), "{what} was solved");
    }
}

/// The upper block of two stands out to the right so far that it falls.
const FALLS: &str = "
Sets course / k1*k2 /, pos / p1*p2 /;
Table len(course,pos)
       p1    p2
  k2  -0.8    1
  k1   1;
$include block_limit.blk
";

#[test]
fn what_does_not_stand_has_no_load_factor() {
    // It would take a push to the left to hold it: a load factor below zero, or one of the wrong push.
    for scene in [
        format!("{FALLS}solve static using lp maximizing alpha;\n$include mechanism.blk\n"),
        format!("{FALLS}solve collapse using mcp;\n$include mechanism.blk\n"),
        format!("{FALLS}$include stands.blk\n"),
        format!("$set push -1\n{FALLS}$include stands.blk\n"),
    ] {
        let (_, finished) = run("", "scene.blk", Some(scene), &mut |_| {});
        let messages: Vec<&str> = finished
            .diagnostics
            .iter()
            .map(|d| d.message.as_str())
            .collect();
        assert_eq!(finished.end.exit(), 3, "{messages:?}");
        let says = "does not stand under its own weight";
        assert!(messages.iter().any(|m| m.contains(says)), "{messages:?}");
    }
}

/// System (7) of the paper's six walls, from zero: without dilatancy at most the load factor of the linear program,
/// with dilatancy tan φ that load factor.
#[test]
fn the_six_walls_as_complementarity_problems() {
    for k in 1..=6 {
        let text = format!(
            "$set scene wall
$include example{k}.blk
Scalar limit;
solve static using lp maximizing alpha;
limit = alpha.l;
option clear = alpha, clear = x, clear = u, clear = z;
solve collapse using mcp;
abort$(alpha.l > limit + 1e-9) 'above the linear program', alpha.l, limit;
option clear = alpha, clear = x, clear = u, clear = z;
coulomb(%friction%, %friction%)
solve collapse using mcp;
abort$(abs(alpha.l - limit) > 1e-9) 'not the linear program', alpha.l, limit;
"
        );
        let (desk, finished) = run("walls", "scene.blk", Some(text), &mut |_| {});
        assert_eq!(
            finished.end.exit(),
            0,
            "{:?} {:?}",
            finished.diagnostics,
            desk.printed
        );
        let solves = &finished.report.solves;
        let [_, free, associated] = solves.as_slice() else {
            panic!("{} solves", solves.len());
        };
        for solve in [free, associated] {
            let residual = solve.residual.natural.expect("a natural residual");
            assert!(
                solve.model_status.code == 1 && residual <= 1e-10,
                "example {k}: status {}, residual {residual:e}",
                solve.model_status.code
            );
        }
    }
}
