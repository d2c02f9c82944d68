//! SVG: drawings as text, which browsers and the pages of a repository show without scripts, fonts or a network.
//!
//! Places are in pixels, x to the right and y down. Numbers have one decimal, so that a drawing has the same bytes on
//! every computer. [`chart`] draws curves with axes.

pub mod chart;

use corehbot_twin::math::hypot;
use std::fmt::Write as _;

/// Colours that can be told apart, also by people who see no red: Okabe and Ito, "Color Universal Design", 2008.
pub const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// The style of all drawings.
const STYLE: &str = "text{font:12px sans-serif;fill:#222}.small{font-size:10px}.title{font-size:14px;font-weight:bold}.thin{stroke:#999;stroke-width:.7;fill:none}";

/// Where a text stands about its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

impl Anchor {
    const fn key(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// A drawing under construction.
#[derive(Clone, Debug)]
pub struct Drawing {
    text: String,
}

impl Drawing {
    /// An empty one of this size, with a title for those who cannot see it.
    #[must_use]
    pub fn new([width, height]: [f64; 2], title: &str) -> Self {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" role=\"img\">\n\
             <title>{}</title>\n<style>{STYLE}</style>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>",
            number(width),
            number(height),
            number(width),
            escaped(title)
        );
        Self { text }
    }

    /// A straight line. `style` has attributes, such as `stroke="#000"`, in this and all that follow.
    pub fn line(&mut self, a: [f64; 2], b: [f64; 2], style: &str) {
        let [x1, y1, x2, y2] = [a[0], a[1], b[0], b[1]].map(number);
        let _ = writeln!(self.text, "<path d=\"M{x1} {y1}L{x2} {y2}\" {style}/>");
    }

    /// Lines from place to place.
    pub fn polyline(&mut self, places: &[[f64; 2]], style: &str) {
        let ends: Vec<String> = places.iter().map(|place| place.map(number).join(" ")).collect();
        let _ = writeln!(self.text, "<path d=\"M{}\" fill=\"none\" {style}/>", ends.join("L"));
    }

    /// A path in the words of SVG.
    pub fn path(&mut self, words: &str, style: &str) {
        let _ = writeln!(self.text, "<path d=\"{words}\" {style}/>");
    }

    /// A circle.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        let [x, y, radius] = [x, y, radius].map(number);
        let _ = writeln!(self.text, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {style}/>");
    }

    /// A rectangle between two corners.
    pub fn rectangle(&mut self, a: [f64; 2], b: [f64; 2], style: &str) {
        let [x, y] = [a[0].min(b[0]), a[1].min(b[1])].map(number);
        let [width, height] = [(b[0] - a[0]).abs(), (b[1] - a[1]).abs()].map(number);
        let _ = writeln!(self.text, "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" {style}/>");
    }

    /// An arrow: a line with a head at its end, in one colour.
    pub fn arrow(&mut self, from: [f64; 2], to: [f64; 2], colour: &str) {
        self.line(from, to, &format!("stroke=\"{colour}\" stroke-width=\"1.5\""));
        self.head(to, [to[0] - from[0], to[1] - from[1]], colour);
    }

    /// The head of an arrow: a triangle with its tip at a place.
    pub fn head(&mut self, [x, y]: [f64; 2], [dx, dy]: [f64; 2], colour: &str) {
        /// Its length and half its width, in pixels.
        const SIZE: [f64; 2] = [7.0, 2.8];
        let length = hypot(dx, dy);
        if length > 0.0 {
            let (u, v) = (dx / length, dy / length);
            let end = |side: f64| [x - SIZE[0] * u - side * SIZE[1] * v, y - SIZE[0] * v + side * SIZE[1] * u];
            let [[x1, y1], [x2, y2], [x, y]] = [end(1.0), end(-1.0), [x, y]].map(|place| place.map(number));
            let _ = writeln!(self.text, "<path d=\"M{x1} {y1}L{x} {y}L{x2} {y2}Z\" fill=\"{colour}\"/>");
        }
    }

    /// A text on one line.
    pub fn text(&mut self, [x, y]: [f64; 2], anchor: Anchor, text: &str, style: &str) {
        let ([x, y], anchor, text) = ([x, y].map(number), anchor.key(), escaped(text));
        let _ = writeln!(self.text, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" {style}>{text}</text>");
    }

    /// Small notes below a drawing, from `top` on, `line` apart.
    pub fn notes(&mut self, top: f64, line: f64, notes: &[&str]) {
        for (number, note) in (0..).zip(notes) {
            self.text([12.0, top + line * f64::from(number)], Anchor::Start, note, "class=\"small\"");
        }
    }

    /// The whole.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// A number of pixels, without needless zeros.
#[must_use]
pub fn number(value: f64) -> String {
    let tenths = (value * 10.0).round() / 10.0;
    // No -0.
    let tenths = if tenths == 0.0 { 0.0 } else { tenths };
    tenths.to_string()
}

/// Text of others must not become elements.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_is_whole_and_takes_any_text() {
        let mut drawing = Drawing::new([100.0, 50.5], "a < b");
        drawing.arrow([0.0, 0.0], [-0.04, 10.0], "#000");
        drawing.arrow([1.0, 1.0], [1.0, 1.0], "#000");
        drawing.text([1.0 / 3.0, 2.0], Anchor::End, "T & <dT>", "class=\"small\"");
        let text = drawing.finish();
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n") && text.contains("viewBox=\"0 0 100 50.5\""));
        assert!(text.contains("a &lt; b") && text.contains("T &amp; &lt;dT&gt;") && text.contains("M0 0L0 10"));
        assert!(text.contains("x=\"0.3\"") && !text.contains("NaN"), "{text}");
    }
}
