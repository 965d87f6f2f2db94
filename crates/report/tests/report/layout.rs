//! Checks of the layout of a figure: no content is cut off or hidden, and every axis has a label.
use roxmltree::{Document, Node};
use stochc_report::figures::Medium;
use ttf_parser::Face;

pub const MEDIA: [Medium; 4] = [
    Medium::Screen,
    Medium::Print(80.0),
    Medium::Print(89.0),
    Medium::Print(183.0),
];

/// Returns the left, top, right and bottom edge of a text, in units of its drawing. Uses the widths
/// of Helvetica.
fn bounds(node: Node, face: &Face) -> [f64; 4] {
    const HEIGHT: f64 = 12.0;
    let text = node.text().unwrap_or_default();
    let ems = text.chars().map(|sign| {
        let glyph = face.glyph_index(sign).unwrap_or_default();
        f64::from(face.glyph_hor_advance(glyph).unwrap()) / f64::from(face.units_per_em())
    });
    let width = HEIGHT * ems.sum::<f64>();
    let number = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let (x, y) = (number("x"), number("y"));
    let left = match node.attribute("text-anchor") {
        None => x,
        Some("middle") => x - width / 2.0,
        Some("end") => x - width,
        Some(other) => panic!("{other}"),
    };
    // The height of a capital letter above the baseline.
    [left, y - 0.72 * HEIGHT, left + width, y]
}

pub fn classes<'a>(node: &Node<'a, '_>) -> &'a str {
    node.attribute("class").unwrap_or_default()
}

fn texts<'a>(document: &'a Document) -> impl Iterator<Item = Node<'a, 'a>> {
    let nodes = document.descendants();
    nodes.filter(|node| node.tag_name().name() == "text")
}

/// Returns descriptions of the layout faults of a figure.
fn faults(svg: &str, medium: Medium, face: &Face) -> Vec<String> {
    let document = Document::parse(svg).unwrap();
    let root = document.root_element();
    let size: Vec<f64> = (root.attribute("viewBox").unwrap().split(' '))
        .map(|number| number.parse().unwrap())
        .collect();
    let unit = match medium {
        Medium::Screen => 1.0,
        Medium::Print(width) => {
            assert_eq!(root.attribute("width"), Some(&*format!("{width}mm")));
            assert!((size[2] - width / 25.4 * 72.0).abs() < 0.01);
            7.0 / 12.0
        }
    };
    let (width, height) = (size[2] / unit, size[3] / unit);
    let mut found = Vec::new();
    let words = |node: &Node| node.text().unwrap_or_default().to_owned();
    let all: Vec<_> = texts(&document)
        .map(|node| (node, bounds(node, face)))
        .collect();
    for (node, [left, top, right, bottom]) in &all {
        if *left < -0.1 || *top < -0.1 || *right > width + 0.1 || *bottom > height + 0.1 {
            found.push(format!("`{}` is cut", words(node)));
        }
    }
    // Labels of marks may cover other content a little, because they have a rim.
    let fixed: Vec<_> = all
        .iter()
        .filter(|(node, _)| !classes(node).contains("halo"))
        .collect();
    for (i, (one, a)) in fixed.iter().enumerate() {
        for (other, b) in &fixed[i + 1..] {
            if a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3] {
                found.push(format!("`{}` lies on `{}`", words(one), words(other)));
            }
        }
    }
    let axes: Vec<_> = document
        .descendants()
        .filter(|node| classes(node) == "of")
        .collect();
    if axes.is_empty() {
        found.push("it has no axis".into());
    }
    for axis in axes {
        let lines = axis
            .children()
            .filter(|node| classes(node) == "axis")
            .count();
        let label: Vec<String> = (axis.children())
            .filter(|node| classes(node) == "ink")
            .map(|node| words(&node))
            .collect();
        let (name, unit) = match label.join(" ").split_once(" [") {
            Some((name, unit)) => (name.to_owned(), unit.to_owned()),
            None => (label.join(" "), String::new()),
        };
        if lines != 1 || name.is_empty() || unit.len() < 2 || !unit.ends_with(']') {
            found.push(format!("an axis is `{name}` in `{unit}`"));
        }
    }
    found
}

/// Panics if a figure has a fault.
pub fn check(what: &str, svg: &str, medium: Medium) {
    let font = include_bytes!("../../fonts/LiberationSans-Regular.ttf");
    let face = Face::parse(font, 0).unwrap();
    let faults = faults(svg, medium, &face);
    assert!(faults.is_empty(), "{what} for {medium}: {faults:#?}\n{svg}");
}
