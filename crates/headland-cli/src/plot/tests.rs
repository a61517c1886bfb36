use super::{
    Figure, PlotError, Series,
    curve::{drop_straight, in_pixels, min_max},
    draw,
    font::Font,
    layout::Layout,
    legend::enters,
    range::{Range, ranges},
    scene::{Anchor, Rect, Scene, Shape, Text},
    svg::Escaped,
    ticks::{Step, Ticks, finest, ticks},
};
use skrifa::GlyphId;

fn figure<'a>(series: Vec<Series<'a>>) -> Figure<'a> {
    Figure {
        title: "Speed",
        x_label: "t [s]",
        y_label: "v [m/s]",
        equal_axes: false,
        series,
    }
}

fn one<'a>(x: &'a [f64], y: &'a [f64]) -> Figure<'a> {
    figure(vec![Series { name: "v", x, y }])
}

fn nice(low: f64, high: f64) -> Ticks {
    finest(Range { low, high }, 500.0, 42.0, |_, _| true).1
}

fn texts(scene: &Scene) -> impl Iterator<Item = &Text> {
    scene.shapes.iter().filter_map(|shape| match shape {
        Shape::Text(text) => Some(text),
        _ => None,
    })
}

/// The colourful part: runs of lines longer than those of grid and legend, and dots.
fn curve_points(figure: &Figure) -> (Vec<usize>, usize) {
    let scene = draw::scene(figure);
    let mut lines = Vec::new();
    let mut dots = 0;
    for shape in &scene.shapes {
        match shape {
            Shape::Lines { runs, stroke } if stroke.width > 1.5 => {
                lines.extend(runs.iter().map(Vec::len))
            }
            Shape::Dots { centres, .. } => dots += centres.len(),
            _ => {}
        }
    }
    (lines, dots)
}

#[test]
fn ticks_are_1_2_or_5_times_a_power_of_ten() {
    assert_eq!(
        nice(0.0, 10.0).labels,
        ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10"]
    );
    assert_eq!(
        nice(172.0, 186.0).labels,
        ["172", "174", "176", "178", "180", "182", "184", "186"]
    );
    assert_eq!(
        nice(-0.3, 0.12).labels,
        [
            "−0.30", "−0.25", "−0.20", "−0.15", "−0.10", "−0.05", "0.00", "0.05", "0.10"
        ]
    );
    assert_eq!(nice(-0.3, 0.12).values[6], 0.0);
    assert_eq!(
        ticks(
            Range {
                low: 0.0,
                high: 9.999
            },
            Step {
                mantissa: 5,
                exponent: 0
            }
        )
        .labels,
        ["0", "5", "10"]
    );
}

#[test]
fn ticks_of_a_small_range_have_all_their_digits() {
    let speed = nice(17.9998, 18.0001);
    assert_eq!(speed.labels[0], "17.99980");
    assert_eq!(speed.note, "");
    let all_differ = speed.labels.windows(2).all(|pair| pair[0] != pair[1]);
    assert!(all_differ, "{:?}", speed.labels);
}

#[test]
fn ticks_of_a_tiny_range_count_from_a_round_number() {
    let tiny = nice(18.0 - 1e-9, 18.0 + 1e-9);
    assert_eq!(
        (tiny.labels[0].as_str(), tiny.note.as_str()),
        ("−1.0", "×10⁻⁹ + 18")
    );
    let negative = nice(-1234.5 - 1e-7, -1234.5 + 1e-7);
    assert_eq!(
        (negative.labels[0].as_str(), negative.note.as_str()),
        ("−100", "×10⁻⁹ − 1234.5")
    );
}

#[test]
fn ticks_of_small_and_large_numbers_share_a_power() {
    let small = nice(0.0, 1e-9);
    assert_eq!(
        (small.labels.last().unwrap().as_str(), small.note.as_str()),
        ("1.0", "×10⁻⁹")
    );
    let large = nice(0.0, 4e7);
    assert_eq!(
        (large.labels.last().unwrap().as_str(), large.note.as_str()),
        ("40", "×10⁶")
    );
    assert_eq!(nice(0.0, 1e5).note, "");
}

#[test]
fn every_range_has_ticks_with_different_labels() {
    for exponent in (-280..290).step_by(7) {
        for middle in [0.0, 1.0, -17.3, 1e6] {
            let size = 10_f64.powi(exponent);
            let range = Range {
                low: (middle - 0.71) * size,
                high: (middle + 0.83) * size,
            };
            let ticks = nice(range.low, range.high);
            assert!(
                (2..=13).contains(&ticks.values.len()),
                "{range:?}: {ticks:?}"
            );
            assert!(
                ticks.labels.windows(2).all(|pair| pair[0] != pair[1]),
                "{range:?}: {ticks:?}"
            );
            assert!(
                ticks.labels.iter().all(|label| label.chars().count() <= 9),
                "{range:?}: {ticks:?}"
            );
        }
    }
}

#[test]
fn labels_do_not_overlap() {
    let font = Font::embedded();
    let x: Vec<f64> = (0..100).map(|i| 123_456.0 + 0.01 * f64::from(i)).collect();
    let layout = Layout::new(&one(&x, &x), ranges(&one(&x, &x).series, false), &font, 0.0);
    let ends: Vec<[f64; 2]> = (layout.x.ticks.values.iter().zip(&layout.x.ticks.labels))
        .map(|(&value, label)| {
            let half = 0.5 * font.width(label, super::layout::TICK_SIZE);
            [layout.x.place(value) - half, layout.x.place(value) + half]
        })
        .collect();
    assert!(ends.len() >= 3);
    assert!(
        ends.windows(2).all(|pair| pair[0][1] + 10.0 < pair[1][0]),
        "{ends:?}"
    );
    assert!(ends.last().unwrap()[1] <= layout.width);
}

#[test]
fn min_max_keeps_extremes_and_ends() {
    let mut points: Vec<[f64; 2]> = (0..100_000)
        .map(|i| [f64::from(i) * 0.005, f64::from(i % 7)])
        .collect();
    points[31_417][1] = 900.0;
    points[70_001][1] = -800.0;
    let kept = min_max(&points);
    assert!(kept.len() <= 4 * 1001, "{}", kept.len());
    assert!(kept.contains(&points[31_417]) && kept.contains(&points[70_001]));
    assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
    assert!(kept.is_sorted_by(|a, b| a[0] <= b[0]));
}

#[test]
fn straight_parts_take_two_points() {
    let line: Vec<[f64; 2]> = (0..1000)
        .map(|i| [f64::from(i), 2.0 * f64::from(i)])
        .collect();
    assert_eq!(drop_straight(&line, 0.06), [line[0], line[999]]);
    let back = [[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [5.0, 0.0], [2.0, 0.0]];
    assert_eq!(
        drop_straight(&back, 0.06),
        [[0.0, 0.0], [10.0, 0.0], [2.0, 0.0]]
    );
    assert_eq!(drop_straight(&[[3.0, 3.0]; 50], 0.06), [[3.0, 3.0]]);
    assert!(drop_straight(&[], 0.06).is_empty());
}

#[test]
fn a_thinned_circle_stays_within_the_tolerance() {
    let circle: Vec<[f64; 2]> = (0..=100_000)
        .map(|i| (f64::from(i) * std::f64::consts::TAU / 1e5).sin_cos())
        .map(|(s, c)| [300.0 * c, 300.0 * s])
        .collect();
    let kept = drop_straight(&circle, 0.06);
    assert!((50..400).contains(&kept.len()), "{}", kept.len());
    for pair in kept.windows(2) {
        let middle = [
            0.5 * (pair[0][0] + pair[1][0]),
            0.5 * (pair[0][1] + pair[1][1]),
        ];
        assert!((300.0 - middle[0].hypot(middle[1])).abs() < 0.15);
    }
}

#[test]
fn nan_and_infinity_are_gaps() {
    let x = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, f64::NAN, 8.0, 9.0];
    let y = [
        0.0,
        1.0,
        f64::NAN,
        3.0,
        f64::INFINITY,
        2.0,
        0.0,
        1.0,
        4.0,
        1.0,
    ];
    let series = Series {
        name: "",
        x: &x,
        y: &y,
    };
    let runs = in_pixels(&series, |[x, y]| [100.0 * x, 100.0 * y]);
    assert_eq!(runs.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1, 2, 2]);
    assert_eq!(curve_points(&one(&x, &y)), (vec![2, 2, 2], 1));
}

#[test]
fn figures_without_a_range_are_drawn() {
    let constant = one(&[0.0, 1.0, 2.0], &[9.81; 3]);
    assert_eq!(curve_points(&constant), (vec![2], 0));
    let [_, y] = ranges(&constant.series, false);
    assert!(y.low < 9.0 && y.high > 10.0);
    let rounding = [1.0, 1.0 + f64::EPSILON];
    assert!(ranges(&one(&[0.0, 1.0], &rounding).series, false)[1].span() > 0.1);

    assert_eq!(curve_points(&one(&[3.0], &[4.0])), (vec![], 1));
    assert_eq!(curve_points(&one(&[3.0; 2], &[0.0; 2])), (vec![], 1));
    for nothing in [figure(vec![]), one(&[], &[]), one(&[f64::NAN], &[1.0])] {
        assert!(texts(&draw::scene(&nothing)).any(|text| text.text == "no data"));
    }
}

#[test]
fn extreme_samples_are_drawn() {
    for size in [f64::MIN_POSITIVE, 5e-324, 1e-295, 1e299, f64::MAX] {
        for equal_axes in [false, true] {
            let (x, y) = ([-size, 0.0, size], [size, -size, 0.5 * size]);
            let svg = Figure {
                equal_axes,
                ..one(&x, &y)
            }
            .to_svg()
            .unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{size:e}");
        }
    }
}

#[test]
fn equal_axes_have_one_scale_and_one_step() {
    let (x, y) = ([0.0, 100.0, 250.0], [0.0, 30.0, -20.0]);
    let path = Figure {
        equal_axes: true,
        ..one(&x, &y)
    };
    for beside in [0.0, 150.0] {
        let layout = Layout::new(&path, ranges(&path.series, true), &Font::embedded(), beside);
        let per_x = layout.area.w / layout.x.range.span();
        let per_y = layout.area.h / layout.y.range.span();
        assert!((per_x / per_y - 1.0).abs() < 1e-12);
        let step = |ticks: &Ticks| ticks.values[1] - ticks.values[0];
        assert_eq!(step(&layout.x.ticks), step(&layout.y.ticks));
        assert!(layout.width <= 900.0 && layout.height <= 900.0);
    }
}

#[test]
fn a_straight_path_far_from_the_origin_fills_its_figure() {
    let path = Figure {
        equal_axes: true,
        ..one(&[0.0, 10.0], &[1000.0; 2])
    };
    let layout = Layout::new(&path, ranges(&path.series, true), &Font::embedded(), 0.0);
    assert!(layout.x.range.span() < 12.0, "{:?}", layout.x.range);
}

#[test]
fn legend_only_for_several_curves_and_capped() {
    let (x, y) = ([0.0, 1.0], [0.0, 1.0]);
    let has = |figure: &Figure, name: &str| texts(&draw::scene(figure)).any(|t| t.text == name);
    assert!(!has(&one(&x, &y), "v"));
    let names: Vec<String> = (0..40).map(|i| format!("curve {i}")).collect();
    let many = |n| {
        figure(
            names[..n]
                .iter()
                .map(|name| Series { name, x: &x, y: &y })
                .collect(),
        )
    };
    assert!(has(&many(2), "curve 1"));
    assert!(has(&many(40), "curve 0") && !has(&many(40), "curve 39"));
    assert!(
        texts(&draw::scene(&many(40)))
            .any(|t| t.text.starts_with("… and ") && t.text.ends_with(" more"))
    );
}

#[test]
fn legend_stands_where_no_curve_is() {
    let rect = Rect {
        x: 10.0,
        y: 10.0,
        w: 10.0,
        h: 10.0,
    };
    assert!(enters(&[[0.0, 15.0], [30.0, 15.0]], rect)); // through, no end inside
    assert!(enters(&[[15.0, 15.0]], rect));
    assert!(!enters(&[[0.0, 0.0], [0.0, 30.0], [30.0, 30.0]], rect));
    assert!(!enters(&[[0.0, 19.0], [9.0, 30.0]], rect));
}

#[test]
fn svg_escapes_what_is_markup() {
    assert_eq!(
        Escaped("a<b & \"c\" > d\n\u{0}").to_string(),
        "a&lt;b &amp; &quot;c&quot; &gt; d  "
    );
    let (x, y) = ([0.0, 1.0], [0.0, 1.0]);
    let svg = Figure {
        title: "F < m·a & more",
        ..one(&x, &y)
    }
    .to_svg()
    .unwrap();
    assert!(
        svg.contains("<title>F &lt; m·a &amp; more</title>")
            && svg.contains(">F &lt; m·a &amp; more</text>")
    );
    assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"));
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    let x: Vec<f64> = (0..500).map(|i| 0.1 * f64::from(i)).collect();
    let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
    let figure = figure(vec![
        Series {
            name: "sin",
            x: &x,
            y: &y,
        },
        Series {
            name: "x",
            x: &x,
            y: &x,
        },
    ]);
    assert_eq!(figure.to_svg().unwrap(), figure.to_svg().unwrap());
    assert_eq!(figure.to_png().unwrap(), figure.to_png().unwrap());
}

#[test]
fn png_has_its_signature_and_size() {
    let png = one(&[0.0, 1.0], &[0.0, 1.0]).to_png().unwrap();
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
    assert_eq!(png[16..24], [0, 0, 0x07, 0x08, 0, 0, 0x04, 0xb0]); // 1800 × 1200
}

#[test]
fn the_font_has_the_letters_of_mechanics() {
    let font = Font::embedded();
    let letters = "θψφωΩδΔλμτρπσεαβγΣ∂√∞²³⁻⁴⁹½·×±≤≥≈→°′∫∇₀₁₂₃ₐₓᵢⱼᵀẋẏṡ−–…";
    let missing: String = letters
        .chars()
        .filter(|&c| font.glyph(c) == GlyphId::NOTDEF)
        .collect();
    assert_eq!(missing, "");
    assert_eq!(font.width("q\u{307}", 10.0), font.width("q", 10.0));
    let set = font.set("q\u{307}u", 10.0);
    assert!(set.len() == 3 && (set[2].at[0] - font.width("q", 10.0)).abs() < 1e-9);
}

#[test]
fn long_texts_are_cut() {
    let font = Font::embedded();
    let cut = font.fit("a name far too long for its place", 13.0, 100.0);
    assert!(
        cut.ends_with('…') && font.width(&cut, 13.0) <= 100.0,
        "{cut}"
    );
    let title = "word ".repeat(100);
    let scene = draw::scene(&Figure {
        title: &title,
        ..one(&[0.0, 1.0], &[0.0, 1.0])
    });
    let centred = texts(&scene).filter(|t| t.anchor == Anchor::Middle && !t.upwards);
    for text in centred {
        let half = 0.5 * font.width(&text.text, text.size);
        assert!(
            text.at[0] - half >= 0.0 && text.at[0] + half <= scene.width,
            "{}",
            text.text
        );
    }
}

#[test]
fn errors_name_the_curve_and_the_file() {
    let short = one(&[0.0, 1.0], &[0.0]).to_svg().unwrap_err();
    assert_eq!(
        short.to_string(),
        "curve `v` has 2 abscissas but 1 ordinates; they must be as many"
    );
    let nowhere = std::env::temp_dir().join("no such folder").join("v.svg");
    let error = one(&[0.0], &[0.0]).write_svg(&nowhere).unwrap_err();
    assert!(matches!(&error, PlotError::Write { path, .. } if *path == nowhere));
}
