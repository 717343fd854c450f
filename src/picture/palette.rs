//! Colours of marks that can be seen on what they are drawn on (3 to 1 at least: WCAG 2.2, 1.4.11), and told apart by people who see
//! few colours: those of M. Okabe and K. Ito, 2008, made darker for light paper and lighter for dark.

/// Red, green, blue.
pub type Colour = [u8; 3];

/// On light paper, in the order in which they are given out.
pub const ON_LIGHT: [Colour; 8] = [
    [0x00, 0x72, 0xb2],
    [0xb8, 0x7a, 0x00],
    [0x07, 0x5a, 0x49],
    [0x65, 0x24, 0x03],
    [0x9e, 0x48, 0x82],
    [0x45, 0x95, 0xcb],
    [0x89, 0x89, 0x89],
    [0x73, 0x67, 0x10],
];

/// On dark paper, in the same order.
pub const ON_DARK: [Colour; 8] = [
    [0x53, 0xa7, 0xee],
    [0xfc, 0xbf, 0x2b],
    [0x6d, 0xda, 0x9f],
    [0xb9, 0x5c, 0x12],
    [0xd4, 0x80, 0xa5],
    [0x03, 0x75, 0xc5],
    [0x71, 0x71, 0x71],
    [0xa0, 0xa5, 0x02],
];

/// Each of many lines on white that look alike, and how opaque it is: where several lie upon each other it is darker.
pub const CROWD: (Colour, f64) = ([0x00, 0x3a, 0x6e], 0.58);

/// The colour on light paper of the thing with this number; they come again after eight.
pub fn colour(number: usize) -> Colour {
    ON_LIGHT[number % ON_LIGHT.len()]
}

/// As SVG and CSS write it.
pub fn hex(colour: Colour) -> String {
    let [red, green, blue] = colour;
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The colour of the thing with this number where CSS says which paper it is on: it declares the one list or the other.
pub fn variable(number: usize) -> String {
    format!("var(--c{})", number % ON_LIGHT.len())
}

/// What CSS declares for one kind of paper.
pub fn declared(colours: &[Colour]) -> String {
    let each = colours.iter().enumerate().map(|(k, &colour)| format!("--c{k}: {};", hex(colour)));
    each.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Colour = [0xff; 3];
    /// What graphics need (WCAG 2.2, 1.4.11).
    const ENOUGH: f64 = 3.0;
    /// How opaque the ground of a chart is that shows modes, as `charts.js` draws it.
    const TINT: f64 = 0.16;

    /// The share of each light, from what a screen is told (sRGB).
    fn linear(colour: Colour) -> [f64; 3] {
        colour.map(|part| {
            let part = f64::from(part) / 255.0;
            if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// The ratio of WCAG 2.2.
    fn contrast(a: Colour, b: Colour) -> f64 {
        let luminance = |colour| {
            let [red, green, blue] = linear(colour);
            0.2126 * red + 0.7152 * green + 0.0722 * blue + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    fn mixed(colour: Colour, share: f64, paper: Colour) -> Colour {
        [0, 1, 2].map(|k| {
            let (above, below) = (f64::from(colour[k]), f64::from(paper[k]));
            (below + (above - below) * share).round() as u8
        })
    }

    /// The values that a style sheet gives a property, in order.
    fn values(style: &str, property: &str) -> Vec<Colour> {
        let before = format!("--{property}: #");
        let parts = style.split(&before).skip(1);
        let part = |text: &str, k: usize| u8::from_str_radix(&text[2 * k..2 * k + 2], 16).unwrap();
        parts.map(|text| [0, 1, 2].map(|k| part(text, k))).collect()
    }

    /// The papers of the page and of mode diagrams, light ones and dark ones, and white, that of plots.
    fn papers() -> [Vec<Colour>; 2] {
        let mut papers = [vec![WHITE], Vec::new()];
        for style in [include_str!("page/page.css"), include_str!("modes_svg.rs")] {
            for property in ["paper", "inside"] {
                let found = values(style, property);
                assert!(found.len() >= 2, "{property}");
                papers[0].push(found[0]);
                papers[1].extend(&found[1..]);
            }
        }
        papers
    }

    #[test]
    fn every_mark_can_be_seen_on_its_paper() {
        for (colours, papers) in [ON_LIGHT, ON_DARK].into_iter().zip(papers()) {
            for paper in papers {
                for colour in colours {
                    let found = contrast(colour, paper);
                    assert!(found >= ENOUGH, "{} on {}: {found:.2}", hex(colour), hex(paper));
                    // the line of a single agent over the ground that shows its modes
                    let found = contrast(colours[0], mixed(colour, TINT, paper));
                    assert!(found >= ENOUGH, "the first on {} on {}: {found:.2}", hex(colour), hex(paper));
                }
            }
        }
        let (colour, share) = CROWD;
        assert!(contrast(mixed(colour, share, WHITE), WHITE) >= ENOUGH);
    }

    #[test]
    fn what_is_written_and_marked_besides_can_be_seen_on_its_paper() {
        let style = include_str!("page/page.css");
        let [light, dark] = papers();
        for property in ["ink", "faint", "mark"] {
            let found = values(style, property);
            let themes = [(&found[..1], &light), (&found[1..], &dark)];
            for (colours, papers) in themes {
                for (&colour, &paper) in
                    colours.iter().flat_map(|colour| papers.iter().map(move |paper| (colour, paper)))
                {
                    let ratio = contrast(colour, paper);
                    assert!(ratio >= ENOUGH, "--{property} {} on {}: {ratio:.2}", hex(colour), hex(paper));
                }
            }
        }
    }

    /// What is seen with all three kinds of cones, and without one of them (Machado, Oliveira & Fernandes, 2009).
    const SIGHTS: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ];

    fn times(matrix: [[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
        matrix.map(|[a, b, c]| a * x + b * y + c * z)
    }

    /// Where a colour lies for the eye: distances are how different colours look (Ottosson's Oklab, 2020).
    fn seen(sight: [[f64; 3]; 3], colour: Colour) -> [f64; 3] {
        let light = times(sight, linear(colour)).map(|part| part.clamp(0.0, 1.0));
        let cones = [
            [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
            [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
            [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
        ];
        let lab = [
            [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
            [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
            [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
        ];
        times(lab, times(cones, light).map(f64::cbrt))
    }

    #[test]
    fn people_who_see_few_colours_can_tell_them_apart() {
        for colours in [ON_LIGHT, ON_DARK] {
            for sight in SIGHTS {
                for (k, &a) in colours.iter().enumerate() {
                    for &b in &colours[..k] {
                        let [p, q] = [a, b].map(|colour| seen(sight, colour));
                        let apart = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
                        // those of Okabe and Ito, with a grey, come as near as 0.03
                        assert!(apart > 0.085, "{} and {}: {apart:.3}", hex(a), hex(b));
                    }
                }
            }
        }
    }
}
