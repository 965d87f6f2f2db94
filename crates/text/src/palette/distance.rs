//! Colour differences for all kinds of vision: CIEDE2000 after a simulation of colour blindness at
//! full severity.
//!
//! # Source
//!
//! G. Sharma, W. Wu and E. N. Dalal (2005); G. M. Machado, M. M. Oliveira and L. A. F. Fernandes
//! (2009).
use super::{DARK, LIGHT, MIN, PHASES, Rgb, Theme, sequential};

type ColourMatrix = [[f64; 3]; 3];

/// Kinds of vision, as matrices on red, green and blue light.
const SIGHTS: [(&str, ColourMatrix); 4] = [
    (
        "normal sight",
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ),
    (
        "protanopia",
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
    ),
    (
        "deuteranopia",
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
    ),
    (
        "tritanopia",
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ),
];

/// Linear sRGB to CIE XYZ.
const XYZ: ColourMatrix = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// White point of sRGB (D65).
const WHITE: [f64; 3] = [0.950_47, 1.0, 1.088_83];

fn product(matrix: &ColourMatrix, vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
}

/// Returns the CIELAB coordinates of a colour with a kind of vision.
fn lab(colour: Rgb, sight: &ColourMatrix) -> [f64; 3] {
    let seen = product(sight, colour.linear()).map(|part| part.clamp(0.0, 1.0));
    let xyz = product(&XYZ, seen);
    let [x, y, z] = [0, 1, 2].map(|i| match xyz[i] / WHITE[i] {
        high if high > 216.0 / 24389.0 => high.cbrt(),
        low => (24389.0 / 27.0 * low + 16.0) / 116.0,
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Returns the CIEDE2000 difference of two colours in CIELAB.
fn distance([l1, a1, b1]: [f64; 3], [l2, a2, b2]: [f64; 3]) -> f64 {
    let weight = |chroma: f64| (chroma.powi(7) / (chroma.powi(7) + 25f64.powi(7))).sqrt();
    let g = 0.5 * (1.0 - weight(f64::midpoint(a1.hypot(b1), a2.hypot(b2))));
    let (a1, a2) = (a1 * (1.0 + g), a2 * (1.0 + g));
    let (c1, c2) = (a1.hypot(b1), a2.hypot(b2));
    let hue = |a: f64, b: f64| b.atan2(a).to_degrees().rem_euclid(360.0);
    let (h1, h2) = (hue(a1, b1), hue(a2, b2));
    let is_grey = c1 * c2 == 0.0;
    let turn = match h2 - h1 {
        _ if is_grey => 0.0,
        turn if turn > 180.0 => turn - 360.0,
        turn if turn < -180.0 => turn + 360.0,
        turn => turn,
    };
    let between = match h1 + h2 {
        sum if is_grey => sum,
        sum if (h1 - h2).abs() <= 180.0 => sum / 2.0,
        sum if sum < 360.0 => (sum + 360.0) / 2.0,
        sum => (sum - 360.0) / 2.0,
    };
    let (light, chroma) = (f64::midpoint(l1, l2), f64::midpoint(c1, c2));
    let cos = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cos(between - 30.0)
        + 0.24 * cos(2.0 * between)
        + 0.32 * cos(3.0 * between + 6.0)
        - 0.20 * cos(4.0 * between - 63.0);
    let from_grey = (light - 50.0).powi(2);
    let lightness = (l2 - l1) / (1.0 + 0.015 * from_grey / (20.0 + from_grey).sqrt());
    let colourfulness = (c2 - c1) / (1.0 + 0.045 * chroma);
    let half = (turn / 2.0).to_radians().sin();
    let hues = 2.0 * (c1 * c2).sqrt() * half / (1.0 + 0.015 * chroma * t);
    let rotation = 60.0 * (-((between - 275.0) / 25.0).powi(2)).exp();
    let mixed = -rotation.to_radians().sin() * 2.0 * weight(chroma) * colourfulness * hues;
    (lightness.powi(2) + colourfulness.powi(2) + hues.powi(2) + mixed).sqrt()
}

/// Returns all pairs of colours in a theme that must be distinguishable.
fn pairs(theme: &Theme) -> Vec<(String, Rgb, Rgb)> {
    let phases = (0..)
        .zip(PHASES)
        .map(|(n, colour)| (format!("phase {n}"), colour));
    let phases: Vec<_> = phases.collect();
    let series = (0..)
        .zip(theme.series)
        .map(|(n, colour)| (format!("series {n}"), colour));
    let series: Vec<_> = series.chain([("hot".to_owned(), theme.hot)]).collect();
    let mut pairs = Vec::new();
    let mut each = |all: &[(String, Rgb)], others: &[(&str, Rgb)]| {
        for (i, (name, colour)) in all.iter().enumerate() {
            for (other, second) in &all[i + 1..] {
                pairs.push((format!("{name} and {other}"), *colour, *second));
            }
            for (other, second) in others {
                pairs.push((format!("{name} and {other}"), *colour, *second));
            }
        }
    };
    // Block colours, and their possible backgrounds.
    let behind = [
        ("the background", theme.background),
        ("the ground", theme.ground),
        ("paper", theme.paper),
    ];
    let blocks = [
        ("a free block", theme.free),
        ("a seed", theme.seed),
        ("the plate", theme.plate),
        ("a lit face", theme.lit),
    ];
    each(&phases, &[&blocks[..], &behind].concat());
    let named = |parts: &[(&str, Rgb)]| -> Vec<(String, Rgb)> {
        (parts.iter())
            .map(|(name, colour)| ((*name).to_owned(), *colour))
            .collect()
    };
    each(&named(&blocks[3..]), &[&blocks[..3], &behind].concat());
    each(&named(&blocks[1..3]), &behind[..2]);
    let groups: Vec<_> = (0..)
        .zip(theme.groups)
        .map(|(n, colour)| (format!("group {n}"), colour))
        .collect();
    each(&groups, &[&blocks[..], &behind[..2]].concat());
    each(
        &series,
        &[
            ("the rest", theme.rest),
            ("ink", theme.ink),
            ("paper", theme.paper),
        ],
    );
    pairs
}

#[test]
fn colours_are_distinguishable_with_any_vision() {
    let mut close = Vec::new();
    for (name, theme) in [("dark", &DARK), ("light", &LIGHT)] {
        for (pair, one, other) in pairs(theme) {
            for (sight, matrix) in &SIGHTS {
                let apart = distance(lab(one, matrix), lab(other, matrix));
                if apart < MIN {
                    close.push(format!("{name}: {pair} with {sight}: {apart:.1}"));
                }
            }
        }
    }
    assert_eq!(close, [""; 0]);
}

#[test]
fn the_scale_of_groups_is_ordered_with_any_vision() {
    for theme in [DARK, LIGHT] {
        for (sight, matrix) in &SIGHTS {
            let lightness = |colour: Rgb| lab(colour, matrix)[0];
            let behind = lightness(theme.background);
            let apart = theme
                .groups
                .map(|colour| (lightness(colour) - behind).abs());
            assert!(
                apart.is_sorted_by(|a, b| a + MIN <= *b),
                "{sight}: {apart:?}"
            );
        }
    }
}

#[test]
fn lines_and_words_of_a_figure_stand_out() {
    for theme in [DARK, LIGHT] {
        for colour in theme.series.into_iter().chain([theme.hot, theme.ink]) {
            let contrast = colour.contrast(theme.paper);
            assert!(
                contrast >= 4.5,
                "{colour} on {}: {contrast:.2}",
                theme.paper
            );
        }
    }
    for colour in PHASES {
        let contrast = colour.contrast(colour.ink());
        assert!(
            contrast >= 4.5,
            "{} on {colour}: {contrast:.2}",
            colour.ink()
        );
    }
}

/// Lightness increases with any vision, and in about equal steps with normal vision.
#[test]
fn larger_values_are_lighter_with_any_vision() {
    const STEPS: usize = 64;
    for (sight, matrix) in &SIGHTS {
        let lightness = |i: usize| lab(sequential(i as f64 / STEPS as f64), matrix)[0];
        let steps: Vec<f64> = (0..STEPS)
            .map(|i| lightness(i + 1) - lightness(i))
            .collect();
        let all: f64 = steps.iter().sum();
        assert!(all > 60.0, "{sight}: {all}");
        // Simulated colours may lie outside the range of a screen and are clipped.
        let least = match *sight {
            "normal sight" => 0.5 * all / STEPS as f64,
            _ => 0.0,
        };
        for (i, step) in steps.iter().enumerate() {
            assert!(*step > least, "{sight}, step {i}: {step}");
        }
    }
    assert_eq!(sequential(f64::NAN), sequential(0.0));
    assert_eq!(sequential(7.0), Rgb(0xfd, 0xe7, 0x25));
}

/// Compares colour differences with the table of Sharma, Wu and Dalal.
#[test]
fn distances_agree_with_the_standard() {
    let table = [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
        (
            [60.2574, -34.0099, 36.2677],
            [60.4626, -34.1751, 39.4387],
            1.2644,
        ),
        (
            [2.0776, 0.0795, -1.1350],
            [0.9033, -0.0636, -0.5514],
            0.9082,
        ),
    ];
    for (one, other, expected) in table {
        let apart = distance(one, other);
        assert!(
            (apart - expected).abs() < 5e-5,
            "{apart} instead of {expected}"
        );
    }
}
