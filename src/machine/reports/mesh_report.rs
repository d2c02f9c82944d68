//! The reports of the bed's mesh, in Marlin's words. Bed Visualizer reads them: no line before the last `ok` contains
//! the letters "ok", and no other line begins with "Bed X".

use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::numbers::Hundredths;
use crate::surface::{Heights, MOST_POINTS, UNITS_PER_MM};
use crate::text::Packed;
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

/// There is none.
pub(in crate::machine) const NO_MESH: Packed = packed!("echo:Invalid mesh. G29 measures one");

/// Whether the mesh is used, and its fade height.
pub(in crate::machine) fn report_levelling(to: &mut ReplyWriter<'_>, Facts { settings: s, mesh, .. }: &Facts<'_>) {
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

/// Its heights for people, as Marlin's bilinear grid.
pub(in crate::machine) fn report_grid(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    let Some(known) = facts.mesh else { return };
    let heights = known.mesh.heights();
    to.say(text!("Bilinear Leveling Grid:"));
    to.say(text!("{}", Numbers(heights.columns())));
    for row in 0..heights.rows() {
        to.say(text!("{row:>2}{}", Row { heights, row, between: ' ' }));
    }
    to.say(text!(""));
    const { assert!(MOST_POINTS < 100) };
}

/// The same for programs: a line a row with tabs, the back of the bed first.
pub(in crate::machine) fn report_table(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    let Some(known) = facts.mesh else { return };
    let heights = known.mesh.heights();
    to.say(text!("Bed Topography Report for CSV:"));
    to.say(text!(""));
    for row in (0..heights.rows()).rev() {
        to.say(text!("{}", Row { heights, row, between: '\t' }));
    }
    to.say(text!(""));
}
