//! The frame: the motors' torque on it, and the frequencies of tool and frame by its stiffness, as a drawing.

use crate::queries::soft_frame::SoftFrame;
use corehbot_report::svg::chart::{Chart, Curve, Look};
use corehbot_report::svg::{Anchor, Drawing};
use corehbot_twin::routing::Machine;
use std::collections::BTreeMap;

/// Size of a chart, in pixels.
const SIZE: [f64; 2] = [470.0, 260.0];

/// Greatest acceleration of the left chart, in m/s2.
const MOST_M_PER_S2: f64 = 10.0;

/// Draws it.
#[must_use]
pub fn picture(answer: &SoftFrame) -> String {
    let title = "The frame: torque of all motors, and vibration";
    let mut drawing = Drawing::new([960.0, 384.0], title);
    drawing.text([12.0, 20.0], Anchor::Start, title, "class=\"title\"");
    let charts = [torques(answer), frequencies(answer)];
    for (index, chart) in charts.iter().enumerate() {
        let left = 4.0 + (SIZE[0] + 8.0) * index as f64;
        chart.draw(&mut drawing, [left, 30.0], SIZE);
        chart.legend(&mut drawing, [left + 60.0, 30.0 + SIZE[1]]);
    }
    drawing.finish()
}

/// Torque over acceleration along x.
fn torques(answer: &SoftFrame) -> Chart {
    let line = |per_m_per_s2: f64| vec![[0.0, 0.0], [MOST_M_PER_S2, MOST_M_PER_S2 * per_m_per_s2]];
    let ours = answer.torques.iter().enumerate().map(|(colour, torque)| Curve {
        name: Machine::name_of(torque.machine).to_owned(),
        colour,
        // A CoreXY's lies on an H-bot's.
        look: if colour > 1 { Look::Dashed } else { Look::Solid },
        places: line(torque.x.belts_mnm + torque.x.rotors_mnm),
    });
    let printed = answer.torques.first().map(|torque| Curve {
        name: "as printed, each of them without rotors".to_owned(),
        colour: answer.torques.len(),
        look: Look::Dashed,
        places: line(torque.x.printed_mnm),
    });
    Chart {
        title: "Torque of all motors, tool along x".to_owned(),
        axes: ["acceleration, m/s2", "mN m"].map(str::to_owned),
        curves: ours.chain(printed).collect(),
    }
}

/// Frequencies over the stiffness of the frame.
fn frequencies(answer: &SoftFrame) -> Chart {
    let (mut soft, mut places) = (Vec::new(), BTreeMap::<(&str, usize), Vec<[f64; 2]>>::new());
    for frame in &answer.frames {
        for (place, (hz, axis)) in frame.frequencies_hz.iter().zip(&frame.along).enumerate() {
            // The modes of an axis in their order, however those of other axes lie between.
            let before = frame.along.iter().take(place).filter(|other| *other == axis).count();
            places.entry((axis, before)).or_default().push([frame.stiffness_n_per_mm, *hz]);
        }
    }
    for (colour, ((axis, before), places)) in places.into_iter().enumerate() {
        let which = if before == 0 { "lower" } else { "upper" };
        soft.push(Curve { name: format!("along {axis}, {which}"), colour, look: Look::Solid, places });
    }
    let count = soft.len();
    let ends = [answer.frames.first(), answer.frames.last()].map(|frame| frame.map_or(0.0, |at| at.stiffness_n_per_mm));
    let rigid = answer.rigid_hz.iter().map(|hz| Curve {
        name: format!("rigid frame, {hz:.1} Hz"),
        colour: count,
        look: Look::Dashed,
        places: ends.map(|stiffness| [stiffness, *hz]).to_vec(),
    });
    Chart {
        title: "Frequencies of tool and frame".to_owned(),
        axes: ["stiffness of the frame, N/mm", "Hz"].map(str::to_owned),
        curves: soft.into_iter().chain(rigid).collect(),
    }
}
