//! The reports of the bed's mesh, in Marlin's words. Bed Visualizer reads them: no line before the last `ok` contains
//! the letters "ok", and no other line begins with "Bed X".

use super::report::Hundredths;
use crate::machine::answers::mesh_answer::{MeshAnswer, MeshForm};
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::{Thousandths, exact};
use crate::settings::Settings;
use crate::storage::{MOST_STORED, MeshNotSaved, MeshRejected, StoredMesh};
use crate::surface::{Heights, MOST_POINTS, UNITS_PER_MM};
use crate::units::Mm;
use core::fmt::{self, Display, Formatter};

/// Numbers of the columns.
struct Numbers(usize);

impl Display for Numbers {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        (0..self.0).try_for_each(|number| write!(f, "{number:>7}"))
    }
}

/// A row of heights in mm, with their signs and three decimals.
struct Row<'h> {
    heights: &'h Heights,
    row: usize,
    /// Before each height, but before the first one in a table.
    between: char,
}

impl Display for Row<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for column in 0..self.heights.columns() {
            if column > 0 || self.between == ' ' {
                write!(f, "{}", self.between)?;
            }
            let units = i32::from(self.heights.get(column, self.row));
            // Units are halves of a thousandth; a half rounds away from 0.
            let thousandths = (units.unsigned_abs() * 1000).div_ceil(UNITS_PER_MM.unsigned_abs());
            let sign = if units < 0 { '-' } else { '+' };
            write!(f, "{sign}{}.{:03}", thousandths / 1000, thousandths % 1000)?;
        }
        Ok(())
    }
}

/// The lines of an answer.
pub(in crate::machine) fn report_mesh(
    to: &mut ReplyWriter<'_>,
    answer: &MeshAnswer,
    mesh: Option<&StoredMesh>,
    s: &Settings,
) {
    match *answer {
        MeshAnswer::None => to.say(text!("echo:Invalid mesh. G29 measures one")),
        MeshAnswer::Heights(form) => {
            if let Some(known) = mesh {
                report_heights(to, known.mesh.heights(), form);
            }
        }
        MeshAnswer::State => {
            // The setting may be on without a mesh, and then nothing is levelled.
            let is_on = s.mesh.is_on && mesh.is_some();
            to.say(text!("echo:Bed Leveling {}", if is_on { "ON" } else { "OFF" }));
            let fade = mesh.map_or(s.mesh.fade, |known| known.mesh.fade());
            if fade > Mm::ZERO {
                to.say(text!("echo:Fade Height {}", Hundredths::of(fade)));
            } else {
                to.say(text!("echo:Fade Height OFF"));
            }
        }
        MeshAnswer::Point { number, all, at, height } => {
            let [x, y] = at.map(Hundredths::of);
            to.say(text!("echo:probe {number}/{all} X{x} Y{y} Z{}", Thousandths(height)));
        }
        MeshAnswer::Area { x, y, points: [columns, rows] } => {
            let [[x, to_x], [y, to_y]] = [x, y].map(|side| [side.least, side.most].map(Hundredths::of));
            to.say(text!("echo:measures X{x} to {to_x}, Y{y} to {to_y}, {columns} x {rows} points"));
        }
        MeshAnswer::NotAdaptive { is_cut } => {
            let why =
                if is_cut { packed!("the outline of an object is too long") } else { packed!("no objects are known") };
            to.say(text!("echo:ADAPTIVE ignored: {why}"));
        }
        MeshAnswer::NoPoint => match mesh.map(|known| known.mesh.heights()) {
            Some(heights) => {
                let (i, j) = (heights.columns() - 1, heights.rows() - 1);
                to.say(text!("echo:ignored: points are I0 to I{i}, J0 to J{j}, and X Y inside of them"));
            }
            None => to.say(text!("echo:Invalid mesh. G29 measures one")),
        },
        MeshAnswer::ShortFade(deviation) => {
            let (fade, deviation) = (exact(s.mesh.fade), Thousandths(deviation));
            to.say(text!("echo:Fade height {fade} is short for a mesh of {deviation} mm: layers differ by a tenth"));
        }
        MeshAnswer::NoFade(deviation) => {
            let (fade, deviation) = (exact(s.mesh.fade), Thousandths(deviation));
            to.say(text!("echo:Fade height {fade} is too short for a mesh of {deviation} mm: it does not fade"));
        }
        MeshAnswer::Kept => to.say(text!("echo:Mesh stored")),
        MeshAnswer::Moved(by) => {
            let [x, y] = by.map(exact);
            to.say(text!("echo:Stored mesh moved with the probe: X{x} Y{y}"));
        }
        MeshAnswer::Ends => {
            to.say(text!("echo:Stored mesh ends with the next start: steps or axes are others. Send G29, M500"));
        }
        MeshAnswer::Forgotten => to.say(text!("echo:Stored mesh forgotten")),
        MeshAnswer::Part => {
            to.say(text!("echo:Mesh not stored: it covers a part of the bed. G29 without an area measures all"));
        }
        MeshAnswer::NotKept(MeshNotSaved::TooLarge) => {
            to.say(text!("echo:Mesh not stored: there is room for {MOST_STORED} points; it counts until a reset"));
        }
        MeshAnswer::NotKept(MeshNotSaved::Storage(error)) => to.say(text!("echo:Mesh not stored: {error}")),
        MeshAnswer::NotKept(MeshNotSaved::NotKept) => {
            to.say(text!("echo:Mesh not stored: storage does not keep written data"));
        }
        MeshAnswer::Rejected(why) => to.say(text!(
            "echo:No stored mesh: {}. Prints are not levelled until G29",
            match why {
                MeshRejected::Blank => packed!("none was stored"),
                MeshRejected::Damaged => packed!("it is damaged"),
                MeshRejected::Machine => packed!("it is of a machine with other axes, motors or another probe"),
            }
        )),
    }
}

fn report_heights(to: &mut ReplyWriter<'_>, heights: &Heights, form: MeshForm) {
    match form {
        MeshForm::Grid => {
            to.say(text!("Bilinear Leveling Grid:"));
            to.say(text!("{}", Numbers(heights.columns())));
            for row in 0..heights.rows() {
                to.say(text!("{row:>2}{}", Row { heights, row, between: ' ' }));
            }
            to.say(text!(""));
        }
        MeshForm::Table => {
            to.say(text!("Bed Topography Report for CSV:"));
            to.say(text!(""));
            for row in (0..heights.rows()).rev() {
                to.say(text!("{}", Row { heights, row, between: '\t' }));
            }
            to.say(text!(""));
        }
    }
    const { assert!(MOST_POINTS < 100) };
}
