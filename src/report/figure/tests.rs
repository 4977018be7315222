use super::*;

/// Six courses of running bond, their mechanism, sliding contacts in red: what a wall's figure holds.
fn wall() -> Scene {
    let mut scene = Scene {
        title: Some("α =  0.64286".into()),
        subtitle: Some("collapse mechanism".into()),
        ..Scene::default()
    };
    let mut blocks = Vec::new();
    for course in 0..6 {
        let y = 1.75 * f64::from(course);
        let lengths: &[f64] = if course % 2 == 0 {
            &[2.0, 4.0, 4.0, 4.0, 4.0, 2.0]
        } else {
            &[4.0; 5]
        };
        let mut x = 0.0;
        for &l in lengths {
            blocks.push([[x, y], [x + l, y], [x + l, y + 1.75], [x, y + 1.75]]);
            x += l;
        }
    }
    let moved = |p: [f64; 2]| {
        let lift = if p[1] > 2.0 && p[0] > 20.0 - 1.5 * p[1] {
            1.0
        } else {
            0.0
        };
        [p[0] + 0.12 * p[1] * lift, p[1] + 0.03 * (p[0] - 8.0) * lift]
    };
    let style = |fill: &str, stroke: &str, opacity| Style {
        fill: Paint::parse(fill),
        stroke: Paint::parse(stroke),
        opacity,
        ..Style::default()
    };
    for b in &blocks {
        let shape = Shape::Polygon(b.to_vec());
        scene
            .elements
            .push(Element::new(shape).style(style("#f3f1ec", "#d5d0c4", None)));
    }
    for b in &blocks {
        let c = moved([(b[0][0] + b[1][0]) / 2.0, (b[0][1] + b[2][1]) / 2.0]);
        let c0 = [(b[0][0] + b[1][0]) / 2.0, (b[0][1] + b[2][1]) / 2.0];
        let t = 0.02 * c[1];
        let corners = b.iter().map(|p| {
            let (dx, dy) = (p[0] - c0[0], p[1] - c0[1]);
            [c[0] + dx + t * dy, c[1] + dy - t * dx]
        });
        let shape = Shape::Polygon(corners.collect());
        scene
            .elements
            .push(Element::new(shape).style(style("#e0bd93", "#6b5136", Some(0.85))));
    }
    for b in blocks.iter().skip(11).step_by(3) {
        let red = Style {
            stroke: Paint::parse("#c62828"),
            width: Some(2.5),
            ..Style::default()
        };
        let shape = Shape::Polyline(vec![moved(b[0]), moved(b[1])]);
        scene
            .elements
            .push(Element::new(shape).style(red).name("slides"));
    }
    let ground = Style {
        width: Some(2.0),
        ..Style::default()
    };
    let line = Shape::Polyline(vec![[-1.0, 0.0], [21.0, 0.0]]);
    scene.elements.push(Element::new(line).style(ground));
    scene
}

fn charts() -> Scene {
    let mut scene = Scene {
        title: Some("Production & demand <by month>".into()),
        categories: ["January", "February", "March", "April"]
            .map(String::from)
            .to_vec(),
        y_label: Some("tonnes".into()),
        x_label: Some("month".into()),
        ..Scene::default()
    };
    let bars = |v: [f64; 4]| Shape::Bars((0..4).map(|k| [k as f64 + 1.0, v[k]]).collect());
    scene
        .elements
        .push(Element::new(bars([3.0, 5.5, -1.0, 4.0])).name("plant A"));
    scene
        .elements
        .push(Element::new(bars([2.0, 2.5, 3.0, 1.0])).name("plant B"));
    let line = (0..4)
        .map(|k| [f64::from(k) + 1.0, 4.0 + f64::from(k) * 0.5])
        .collect();
    scene
        .elements
        .push(Element::new(Shape::Line(line)).name("demand"));
    scene
}

fn colors() -> Scene {
    let mut scene = Scene {
        scale_label: Some("weight".into()),
        axes: Some(true),
        ..Scene::default()
    };
    for k in 0..8 {
        let x = f64::from(k);
        let square = vec![[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 3.0], [x, 3.0]];
        scene
            .elements
            .push(Element::new(Shape::Polygon(square)).style(Style {
                fill: Some(Paint::Value(x * 0.25)),
                ..Style::default()
            }));
        let arrow = Shape::Arrow([x + 0.5, 1.0], [0.0, 0.25 * x]);
        scene.elements.push(Element::new(arrow).style(Style {
            stroke: Paint::parse("white"),
            ..Style::default()
        }));
        let text = Shape::Text([x + 0.5, 0.5], format!("b{k}"), Anchor::Middle);
        scene.elements.push(Element::new(text));
    }
    scene
}

#[test]
fn pictures_are_whole_and_repeatable() {
    for (name, scene) in [("wall", wall()), ("charts", charts()), ("colors", colors())] {
        let text = svg(&scene);
        assert_eq!(text, svg(&scene));
        assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let picture = png(&text, 1.0).expect("a picture");
        assert_eq!(&picture[1..4], b"PNG");
        assert_eq!(picture, png(&text, 1.0).expect("a picture"));
        if let Ok(folder) = std::env::var("BMOD_FIGURES") {
            std::fs::write(format!("{folder}/{name}.svg"), &text).expect("written");
            std::fs::write(
                format!("{folder}/{name}.png"),
                png(&text, 2.0).expect("a picture"),
            )
            .expect("written");
        }
    }
}

#[test]
fn texts_render_without_system_fonts() {
    let mut scene = Scene::default();
    let blank = png(&svg(&scene), 1.0).expect("a picture").len();
    scene.title = Some("α = 0.5 ≤ Σ".into());
    assert!(png(&svg(&scene), 1.0).expect("a picture").len() > blank + 200);
}

#[test]
fn hostile_values_are_left_out() {
    let bad = [
        f64::NAN,
        f64::INFINITY,
        -f64::INFINITY,
        1e308,
        -1e308,
        5e-324,
    ];
    let mut scene = Scene {
        title: Some("\u{1}<script>&\"'".into()),
        ..Scene::default()
    };
    for &a in &bad {
        for &b in &bad {
            for shape in [
                Shape::Polygon(vec![[a, b], [0.0, 1.0], [b, a]]),
                Shape::Polyline(vec![[a, b], [0.0, 1.0]]),
                Shape::Points(vec![[a, b]]),
                Shape::Arrow([a, 0.0], [b, 1.0]),
                Shape::Text([a, b], "x".into(), Anchor::End),
            ] {
                scene.elements.push(Element::new(shape).style(Style {
                    fill: Some(Paint::Value(a)),
                    width: Some(b),
                    size: Some(a),
                    opacity: Some(b),
                    ..Style::default()
                }));
            }
        }
    }
    let text = svg(&scene);
    assert!(!text.contains("NaN") && !text.contains("\"inf"));
    png(&text, 1.0).expect("a picture");
    for elements in [vec![], vec![Element::new(Shape::Bars(vec![]))]] {
        let scene = Scene {
            elements,
            ..Scene::default()
        };
        assert!(png(&svg(&scene), 1.0).is_ok());
    }
}

#[test]
fn a_block_lies_where_it_should() {
    let square = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]];
    let scene = Scene {
        elements: vec![Element::new(Shape::Polygon(square))],
        ..Scene::default()
    };
    // 684 pixels for 4.16 units; y upwards.
    assert!(svg(&scene).contains("points=\"31.15,"), "{}", svg(&scene));
    let text = svg(&scene);
    let points = text.split("points=\"").nth(1).expect("a polygon");
    let points: Vec<f64> = points
        .split('"')
        .next()
        .expect("its points")
        .split([' ', ','])
        .map(|n| n.parse().expect("a number"))
        .collect();
    let (wide, high) = (points[2] - points[0], points[1] - points[5]);
    assert!((wide / high - 2.0).abs() < 1e-3 && high > 0.0);
}

#[test]
fn colors_are_checked() {
    assert_eq!(Paint::parse("Red"), Some(Paint::Color("red".into())));
    assert_eq!(
        Paint::parse("#A0b1C2"),
        Some(Paint::Color("#a0b1c2".into()))
    );
    assert_eq!(
        Paint::parse("rgb(255, 0,16)"),
        Some(Paint::Color("#ff0010".into()))
    );
    assert_eq!(Paint::parse("none"), Some(Paint::None));
    for bad in [
        "rad",
        "#12",
        "#gggggg",
        "url(#x)",
        "rgb(1,2)",
        "rgb(1,2,300)",
        "\"/><script>",
    ] {
        assert_eq!(Paint::parse(bad), None, "{bad}");
    }
    assert!(Paint::names().is_sorted());
}
