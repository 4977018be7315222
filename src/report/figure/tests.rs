use super::*;

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
