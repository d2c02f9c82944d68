//! Chart: curves over axes with round numbers.

use super::{Anchor, COLOURS, Drawing, number};
use corehbot_twin::math::{log10, powi};

/// How a curve looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line.
    Solid,
    /// A line of dashes.
    Dashed,
    /// A ring at each place, without a line: the curve below it stays visible.
    Rings,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Which of the colours it has.
    pub colour: usize,
    /// How it looks.
    pub look: Look,
    /// Its places, from left to right.
    pub places: Vec<[f64; 2]>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// What stands above it.
    pub title: String,
    /// What its axes are, with units.
    pub axes: [String; 2],
    /// The curves.
    pub curves: Vec<Curve>,
}

/// Room for numbers and words on the left, above, on the right and below, in pixels.
const ROOM: [f64; 4] = [52.0, 24.0, 12.0, 40.0];

/// Distance of two names in the legend, in pixels.
const LINE: f64 = 14.0;

/// Intervals between numbers on an axis, about.
const INTERVALS: f64 = 6.0;

impl Chart {
    /// Draws it with its upper left corner at a place. All places of all curves are within; so is the 0 of the upright
    /// axis.
    pub fn draw(&self, drawing: &mut Drawing, corner: [f64; 2], size: [f64; 2]) {
        let all = |axis: usize| self.curves.iter().flat_map(|curve| &curve.places).filter_map(move |at| at.get(axis));
        let (x, y) = (Scale::new(all(0).copied()), Scale::new(all(1).copied().chain([0.0])));
        let [left, top] = [corner[0] + ROOM[0], corner[1] + ROOM[1]];
        let [right, bottom] = [corner[0] + size[0] - ROOM[2], corner[1] + size[1] - ROOM[3]];
        let along = |v: f64| left + x.part(v) * (right - left);
        let up = |v: f64| bottom - y.part(v) * (bottom - top);
        for v in x.marks() {
            drawing.line([along(v), top], [along(v), bottom], "class=\"thin\"");
            drawing.text([along(v), bottom + 13.0], Anchor::Middle, &x.text(v), "class=\"small\"");
        }
        for v in y.marks() {
            drawing.line([left, up(v)], [right, up(v)], "class=\"thin\"");
            drawing.text([left - 4.0, up(v) + 3.5], Anchor::End, &y.text(v), "class=\"small\"");
        }
        drawing.line([left, up(0.0)], [right, up(0.0)], "stroke=\"#222\"");
        drawing.text([corner[0] + 4.0, corner[1] + 13.0], Anchor::Start, &self.title, "font-weight=\"bold\"");
        drawing.text([(left + right) / 2.0, bottom + 29.0], Anchor::Middle, &self.axes[0], "class=\"small\"");
        let upright = format!(
            "class=\"small\" transform=\"rotate(-90 {} {})\"",
            number(corner[0] + 12.0),
            number((top + bottom) / 2.0)
        );
        drawing.text([corner[0] + 12.0, (top + bottom) / 2.0], Anchor::Middle, &self.axes[1], &upright);
        for curve in &self.curves {
            let places: Vec<[f64; 2]> = curve.places.iter().map(|[x, y]| [along(*x), up(*y)]).collect();
            curve.draw(drawing, &places);
        }
    }

    /// Draws the names of its curves below each other, and returns the height that they take.
    pub fn legend(&self, drawing: &mut Drawing, corner: [f64; 2]) -> f64 {
        let mut y = corner[1] + LINE / 2.0;
        for curve in &self.curves {
            let line = [corner[0], corner[0] + 12.0, corner[0] + 24.0].map(|x| [x, y]);
            curve.draw(drawing, &line);
            drawing.text([corner[0] + 30.0, y + 4.0], Anchor::Start, &curve.name, "class=\"small\"");
            y += LINE;
        }
        y - LINE / 2.0 - corner[1]
    }
}

impl Curve {
    /// Draws places in its look.
    fn draw(&self, drawing: &mut Drawing, places: &[[f64; 2]]) {
        let colour = COLOURS.get(self.colour % COLOURS.len()).copied().unwrap_or("#222");
        let stroke = format!("stroke=\"{colour}\" stroke-width=\"1.6\"");
        match self.look {
            Look::Solid => drawing.polyline(places, &stroke),
            Look::Dashed => drawing.polyline(places, &format!("{stroke} stroke-dasharray=\"5 3\"")),
            Look::Rings => {
                places.iter().for_each(|place| drawing.circle(*place, 3.6, &format!("fill=\"none\" {stroke}")));
            }
        }
    }
}

/// An axis from one round number to another.
struct Scale {
    low: f64,
    step: f64,
    intervals: u32,
}

impl Scale {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let high = if high > low { high } else { low + 1.0 };
        let rough = (high - low) / INTERVALS;
        let ten = powi(10.0, log10(rough).floor() as i32);
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|by| by * ten).find(|step| *step >= rough).unwrap_or(ten);
        let low = (low / step).floor() * step;
        Self { low, step, intervals: ((high - low) / step - 1e-9).ceil().max(1.0) as u32 }
    }

    fn marks(&self) -> impl Iterator<Item = f64> + use<> {
        let (low, step) = (self.low, self.step);
        (0..=self.intervals).map(move |i| low + f64::from(i) * step)
    }

    /// Where a value is, of 1.
    fn part(&self, value: f64) -> f64 {
        (value - self.low) / (self.step * f64::from(self.intervals))
    }

    fn text(&self, value: f64) -> String {
        let digits = (-log10(self.step).floor()).max(0.0) as usize;
        let text = format!("{value:.digits$}");
        if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) { "0".to_owned() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_has_round_numbers_about_all_values() {
        let of = |values: &[f64]| {
            let scale = Scale::new(values.iter().copied());
            scale.marks().map(|v| scale.text(v)).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(of(&[0.0, 300.0]), "0 50 100 150 200 250 300");
        assert_eq!(of(&[-3.2, 41.0]), "-10 0 10 20 30 40 50");
        assert_eq!(of(&[0.011, 0.019]), "0.010 0.012 0.014 0.016 0.018 0.020");
        assert_eq!(of(&[]).split(' ').count(), 6);
        assert_eq!(of(&[5.0, f64::NAN]), "5.0 5.2 5.4 5.6 5.8 6.0");
    }

    #[test]
    fn a_curve_is_between_its_axes() {
        let curve = |colour| Curve {
            name: "a".to_owned(),
            colour,
            look: if colour > 0 { Look::Dashed } else { Look::Solid },
            places: vec![[0.0, 0.0], [10.0, 5.0]],
        };
        let chart =
            Chart { title: "t".to_owned(), axes: ["x", "y"].map(str::to_owned), curves: vec![curve(0), curve(1)] };
        let mut drawing = Drawing::new([300.0, 200.0], "t");
        chart.draw(&mut drawing, [0.0, 0.0], [300.0, 200.0]);
        assert_eq!(chart.legend(&mut drawing, [10.0, 10.0]), 28.0);
        let text = drawing.finish();
        assert!(text.contains("M52 160L288 24") && text.contains("stroke-dasharray"), "{text}");
    }
}
