//! The points of the mesh: M421 changes one, G42 goes over it.

use super::levelling::{change_heights, units};
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::surface::use_mesh;
use crate::machine::ports::PortSet;
use crate::machine::probe::area::Area;
use crate::machine::reports::mesh_report::NO_MESH;
use crate::machine::state::modal::Modal;
use crate::machine::states::States;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::settings::{HomedAxis, Range, ranges};
use crate::surface::{Heights, Mesh};
use crate::units::Mm;

/// A point of the mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum MeshPoint {
    /// Its column and row.
    Number([Number; 2]),
    /// The point nearest to a place.
    Place([Option<Number>; 2]),
    /// The point nearest to the nozzle.
    Nearest,
}

/// The words of M421 and of G29 W.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct PointWords {
    /// The point.
    pub point: MeshPoint,
    /// Z: its height.
    pub height: Option<Number>,
    /// Q: the change of its height.
    pub change: Option<Number>,
    /// N: it counts as not measured.
    pub forgets: bool,
}

/// The column and row of a point.
fn point_of<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    modal: &Modal,
    mesh: &Mesh,
    point: MeshPoint,
) -> Option<[usize; 2]> {
    let heights = mesh.heights();
    let count = [heights.columns(), heights.rows()];
    // Of the nearest column and row, as many as there were if the mesh went on.
    let near = |at: [Mm; 2]| {
        let ([x, y], [per_x, per_y], [from_x, from_y]) = (at, mesh.cells_per_mm(), mesh.first());
        let cell = |at: Mm, from: Mm, rate: f32| at.saturating_sub(from).to_num::<f32>() * rate + 0.5;
        [cell(x, from_x, per_x), cell(y, from_y, per_y)]
    };
    let numbers = match point {
        MeshPoint::Number(numbers) => numbers.map(|number| usize::try_from(number.to_int()).unwrap_or(usize::MAX)),
        MeshPoint::Place([Some(x), Some(y)]) => {
            near([modal.length(x), modal.length(y)]).map(|cell| if cell < 0.0 { usize::MAX } else { cell as usize })
        }
        MeshPoint::Place(_) => return None,
        MeshPoint::Nearest => {
            let [x, y, ..] = main_loop.motion.end_mm();
            let ([u, v], [columns, rows]) = (near([x, y]), count);
            // Negative numbers become 0.
            [(u as usize).min(columns - 1), (v as usize).min(rows - 1)]
        }
    };
    numbers.iter().zip(count).all(|(number, count)| *number < count).then_some(numbers)
}

/// There is no such point.
fn report_points(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    if let Some(known) = facts.mesh {
        let heights = known.mesh.heights();
        let (i, j) = (heights.columns() - 1, heights.rows() - 1);
        to.say(text!("echo:ignored: points are I0 to I{i}, J0 to J{j}, and X Y inside of them"));
    }
}

/// M421.
pub(in crate::machine) async fn change_point<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    words: &PointWords,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.bed.mesh().is_none() {
        return Ok(Answer::Line(NO_MESH));
    }
    main_loop.finish().await?;
    if let Some(answer) = set_height(main_loop, states, words) {
        return Ok(answer);
    }
    use_mesh(main_loop, main_loop.settings.mesh.is_on).await?;
    Ok(Answer::Nothing)
}

/// The point has its height, or there is this answer.
fn set_height<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
    words: &PointWords,
) -> Option<Answer<'static>> {
    let mesh = &main_loop.bed.mesh()?.mesh;
    let Some([column, row]) = point_of(main_loop, modal, mesh, words.point) else {
        return Some(Answer::words(&report_points));
    };
    let mut heights = *mesh.heights();
    let range = ranges::MESH_HEIGHT;
    let now = heights.get(column, row);
    let height = match (words.height, words.change) {
        (Some(height), _) => clamps.length_of(modal, ["M421", "Z"], height, range, None).map(units),
        (None, Some(change)) => {
            clamps.length_of(modal, ["M421", "Q"], change, range, None).map(|by| now.saturating_add(units(by)))
        }
        (None, None) if words.forgets => {
            let others = |c, r| if [c, r] == [column, row] { None } else { Some(heights.get(c, r)) };
            Heights::filled(heights.columns(), heights.rows(), others).map(|filled| filled.get(column, row))
        }
        (None, None) => {
            return Some(Answer::Line(packed!("echo:M421 ignored: Z is the height of the point, Q its change")));
        }
    };
    let Some(height) = height else { return Some(Answer::Nothing) };
    heights.set(column, row, height);
    change_heights(main_loop, &heights);
    None
}

/// G42: the nozzle, or with P the probe, goes over a point; without I or J along the other axis alone.
pub(in crate::machine) async fn go_to_point<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    numbers: [Option<Number>; 2],
    by_probe: bool,
    feed: Option<Number>,
) -> Result<Answer<'static>, Interrupt> {
    let Some(known) = main_loop.bed.mesh() else { return Ok(Answer::Line(NO_MESH)) };
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Ok(Answer::NotHomed);
    }
    let number = |asked: Option<Number>| asked.map_or(Some(0), |asked| usize::try_from(asked.to_int()).ok());
    let [column, row] = numbers.map(number);
    let place = column.zip(row).and_then(|(column, row)| place_of(&known.mesh, column, row));
    let Some(place) = place else { return Ok(Answer::words(&report_points)) };
    if let Some(speed) = states.clamps.feed(&states.modal, feed) {
        states.modal.feed = speed;
    }
    main_loop.finish().await?;
    let s = &*main_loop.settings;
    let mut position = main_loop.motion.end_mm();
    let offsets = [s.probe.offset.x, s.probe.offset.y];
    for (axis, at) in position.iter_mut().enumerate().take(2) {
        if numbers[axis].is_some() {
            let place = if by_probe { place[axis].saturating_sub(offsets[axis]) } else { place[axis] };
            *at = s.reach(HomedAxis::ALL[axis]).clamp(place);
        }
    }
    let speed = states.modal.feed;
    main_loop.plan(Target { position, speed, has_overrides: true, watch: EndstopSet::NONE }).await?;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    Ok(Answer::Nothing)
}

/// The place of a point of a mesh.
fn place_of(mesh: &Mesh, column: usize, row: usize) -> Option<[Mm; 2]> {
    let ([x, y], [to_x, to_y], heights) = (mesh.first(), mesh.last(), mesh.heights());
    let points = [heights.columns(), heights.rows()];
    let area = Area { x: Range { least: x, most: to_x }, y: Range { least: y, most: to_y }, points };
    (column < heights.columns() && row < heights.rows()).then(|| area.at(column, row))
}
