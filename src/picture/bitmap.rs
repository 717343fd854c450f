//! Pictures as points: what plotters draws on where a PNG is wanted.
//!
//! A path is drawn segment by segment. Each point takes as much of the colour as the segment that comes nearest to its centre covers
//! of it, and takes it once, however often the path comes by: as an SVG with round joins is drawn.

use std::convert::Infallible;

use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingBackend, DrawingErrorKind};

/// Points that are red, green and blue.
pub(super) struct Bitmap<'a> {
    points: &'a mut [u8],
    size: (u32, u32),
    /// How much of each point the path that is being drawn covers, in 255ths, and which of these are not 0.
    covered: Vec<u8>,
    touched: Vec<usize>,
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl<'a> Bitmap<'a> {
    /// A picture of this size; three bytes a point, row by row.
    pub(super) fn new(points: &'a mut [u8], size: (u32, u32)) -> Self {
        let covered = vec![0; size.0 as usize * size.1 as usize];
        Self { points, size, covered, touched: Vec::new() }
    }

    /// The number of a point, if it is in the picture.
    fn place(&self, x: i32, y: i32) -> Option<usize> {
        let (width, height) = (self.size.0 as i32, self.size.1 as i32);
        ((0..width).contains(&x) && (0..height).contains(&y)).then(|| (y * width + x) as usize)
    }

    fn blend(&mut self, place: usize, (red, green, blue): (u8, u8, u8), share: f64) {
        for (point, colour) in self.points[3 * place..3 * place + 3].iter_mut().zip([red, green, blue]) {
            *point = (f64::from(*point) + (f64::from(colour) - f64::from(*point)) * share).round() as u8;
        }
    }

    /// Notes what a segment of this width covers.
    fn cover(&mut self, from: BackendCoord, to: BackendCoord, width: f64) {
        let [(x0, y0), (x1, y1)] = [from, to].map(|(x, y)| (f64::from(x), f64::from(y)));
        let (dx, dy) = (x1 - x0, y1 - y0);
        let (length, reach) = (dx.hypot(dy), width / 2.0 + 1.0);
        let (columns, rows) = (self.size.0 as i32, self.size.1 as i32);
        // row by row, or column by column, along the longer side
        let is_flat = dx.abs() >= dy.abs();
        let (main, across) = if is_flat { (dx, dy) } else { (dy, dx) };
        let (begin, side) = if is_flat { (x0, y0) } else { (y0, x0) };
        let slope = if main == 0.0 { 0.0 } else { across / main };
        let wide = reach * slope.hypot(1.0);
        let (low, high) = (begin.min(begin + main) - reach, begin.max(begin + main) + reach);
        let most = if is_flat { columns } else { rows };
        for a in (low.floor() as i32).max(0)..=(high.ceil() as i32).min(most - 1) {
            let along = (f64::from(a) - begin).clamp(main.min(0.0), main.max(0.0));
            let middle = side + along * slope;
            for b in (middle - wide).floor() as i32..=(middle + wide).ceil() as i32 {
                let (x, y) = if is_flat { (a, b) } else { (b, a) };
                let Some(place) = self.place(x, y) else { continue };
                let (px, py) = (f64::from(x) - x0, f64::from(y) - y0);
                let share = if length > 0.0 { (px * dx + py * dy) / (length * length) } else { 0.0 };
                let share = share.clamp(0.0, 1.0);
                let distance = (px - share * dx).hypot(py - share * dy);
                let covered = ((width / 2.0 + 0.5 - distance).clamp(0.0, 1.0) * 255.0).round() as u8;
                if covered > 0 && self.covered[place] == 0 {
                    self.touched.push(place);
                }
                self.covered[place] = self.covered[place].max(covered);
            }
        }
    }
}

impl DrawingBackend for Bitmap<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        if let Some(place) = self.place(x, y) {
            self.blend(place, colour.rgb, colour.alpha);
        }
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let BackendColor { alpha, rgb } = style.color();
        let mut before: Option<BackendCoord> = None;
        for point in path {
            if let Some(before) = before {
                self.cover(before, point, f64::from(style.stroke_width()));
            }
            before = Some(point);
        }
        let mut touched = std::mem::take(&mut self.touched);
        for place in touched.drain(..) {
            let covered = std::mem::take(&mut self.covered[place]);
            self.blend(place, rgb, alpha * f64::from(covered) / 255.0);
        }
        self.touched = touched;
        Ok(())
    }
}
