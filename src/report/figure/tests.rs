use super::*;

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

// (Pictures of walls: tests/scenes.rs.)
#[test]
fn pictures_are_whole_and_repeatable() {
    for scene in [charts(), colors()] {
        let text = svg(&scene);
        assert_eq!(text, svg(&scene));
        assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let picture = png(&text, 1.0).expect("a picture");
        assert_eq!(&picture[1..4], b"PNG");
        assert_eq!(picture, png(&text, 1.0).expect("a picture"));
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
