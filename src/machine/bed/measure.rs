//! G29: the bed is measured at the points of a grid, and from then on z follows it.
//!
//! Heights are relative to the place where z is 0 ([`Settings::probe_home`]), which is touched first. So a mesh changes
//! nothing there, and the height of the first layer stays right.

use super::levelling::{mesh_of, units};
use super::probing::tell_of_home_offsets;
use crate::connectors::Heater;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::homing::homing_axes::{HomeWords, home};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::surface::use_mesh;
use crate::machine::numbers::{Hundredths, Thousandths};
use crate::machine::ports::PortSet;
use crate::machine::probe::area::{Area, LEAST_POINTS};
use crate::machine::probe::reach::{NO_PROBE, OutOfReach, area_reach, has_probe, nozzle_for};
use crate::machine::probe::touch::{AfterTouch, touch_bed};
use crate::machine::reports::mesh_report::report_grid;
use crate::machine::state::level::Level;
use crate::machine::state::modal::Modal;
use crate::machine::states::States;
use crate::port::Wake;
use crate::settings::{Range, Settings};
use crate::storage::StoredMesh;
use crate::surface::{Heights, MOST_POINTS};
use crate::units::Mm;
use core::pin::pin;

/// The words of G29 and its relatives.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct GridWords {
    /// The area from and to x, from and to y; all that the probe reaches without them.
    pub area: [Option<Number>; 4],
    /// H: the side of a square in the middle of the bed.
    pub square: Option<Number>,
    /// O: nothing is measured if a mesh is in use.
    pub only_without: bool,
    /// D: the heights are reported and not kept.
    pub is_dry: bool,
    /// N: homes all axes first.
    pub homes: bool,
    /// E: the probe is taken in between its touches.
    pub takes_in: bool,
    /// V: from 1 on each touch is told.
    pub verbosity: Option<Number>,
    /// Around the objects of the print.
    pub is_adaptive: bool,
    /// The margin around them in mm.
    pub margin: Option<Number>,
    /// Columns and rows; without them as many as its share of the whole mesh has.
    pub counts: [Option<Number>; 2],
    /// The area is in mm, even after G20.
    pub is_in_mm: bool,
}

/// Distance of an adaptive mesh's border from the objects, in mm: Klipper's documentation has 5 in its examples.
const MARGIN: Mm = Mm::const_from_int(5);

/// Sides below this have no slope that a probe could find.
const LEAST_SIDE: Mm = Mm::const_from_int(10);

/// G29.
pub(in crate::machine) async fn measure<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    words: &GridWords,
) -> Result<Answer<'static>, Interrupt> {
    if !has_probe(main_loop) {
        return Ok(NO_PROBE);
    }
    if words.only_without && main_loop.settings.mesh.is_on && main_loop.bed.mesh().is_some() {
        return Ok(Answer::Line(packed!("echo:G29 O: a mesh is in use, nothing is measured")));
    }
    if let Err(place) = nozzle_for(&main_loop.settings, main_loop.settings.probe_home()) {
        return Ok(place.answer(main_loop));
    }
    main_loop.finish().await?;
    if words.homes {
        apart(pin!(home(main_loop, &mut states.notices, HomeWords::default(), None))).await?;
    }
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Ok(Answer::NotHomed);
    }
    if main_loop.homed.level() == Level::Lost {
        // Screws that turn easily may have turned.
        main_loop.say(text!("echo:the motors of z had no power since G34. G34 levels the screws again"));
    }
    let whole = whole_area(&main_loop.settings);
    let area = match area(whole, states, words) {
        Ok(area) => area,
        Err(at) => return Ok(OutOfReach { at, reaches: [whole.x, whole.y] }.answer(main_loop)),
    };
    if words.is_adaptive && states.area.bounds().is_none() {
        let why = if states.area.is_cut() {
            packed!("the outline of an object is too long")
        } else {
            packed!("no objects are known")
        };
        main_loop.say(text!("echo:ADAPTIVE ignored: {why}"));
    }
    if area != whole {
        let Area { x, y, points: [columns, rows] } = area;
        let [[x, to_x], [y, to_y]] = [x, y].map(|side| [side.least, side.most].map(Hundredths::of));
        main_loop.say(text!("echo:measures X{x} to {to_x}, Y{y} to {to_y}, {columns} x {rows} points"));
    }
    if words.area.iter().any(Option::is_some) {
        tell_of_home_offsets(main_loop);
    }
    let heights = touch_grid(main_loop, &area, words).await?;
    let before = main_loop.bed;
    let is_part = (area.x, area.y) != (whole.x, whole.y);
    if !note_mesh(main_loop, &heights, &area, is_part) {
        return Ok(Answer::Nothing);
    }
    main_loop.reply(Answer::words(&report_grid)).await?;
    let on = if words.is_dry {
        main_loop.bed = before;
        main_loop.settings.mesh.is_on
    } else {
        true
    };
    use_mesh(main_loop, on).await?;
    Ok(Answer::Nothing)
}

/// These heights are known of the bed now. False if they make no mesh.
fn note_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    heights: &Heights,
    area: &Area,
    is_part: bool,
) -> bool {
    let (first, last) = ([area.x.least, area.y.least], [area.x.most, area.y.most]);
    let Some(mesh) = mesh_of(main_loop, heights, first, last) else { return false };
    let temperatures = [Heater::Bed, Heater::Hotend]
        .map(|heater| main_loop.heat.believed(heater).map(|celsius| celsius.to_num::<i32>().clamp(-99, 999) as i16));
    let reference = main_loop.settings.probe_home();
    main_loop.bed.know(StoredMesh { mesh, reference, temperatures }, is_part);
    true
}

/// All that the probe reaches.
fn whole_area(s: &Settings) -> Area {
    let [x, y] = area_reach(s);
    Area { x, y, points: [s.mesh.columns, s.mesh.rows].map(usize::from) }
}

/// The part of it that the line means; a place that cannot be reached if nothing of it can.
fn area(whole: Area, states: &mut States, words: &GridWords) -> Result<Area, [Mm; 2]> {
    let margin = words.margin.map_or(MARGIN, |margin| Mm::saturating_from_num(margin.value()).max(Mm::ZERO));
    let of_print = states.area.take_next().filter(|_| !words.is_adaptive);
    let wanted = wanted_area(whole, &states.modal, words).or(of_print);
    let mut area = match wanted {
        Some(wanted) => part(whole, wanted, Mm::ZERO)?,
        None => whole,
    };
    for (points, count) in area.points.iter_mut().zip(words.counts) {
        *points = count.map_or(*points, |count| usize::try_from(count.to_int()).unwrap_or_default());
        *points = (*points).clamp(LEAST_POINTS, MOST_POINTS);
    }
    match states.area.bounds().filter(|_| words.is_adaptive) {
        Some(objects) => part(area, objects, margin),
        None => Ok(area),
    }
}

/// The part of an area around some places. It is wide enough for a slope, unless all of the area is not.
fn part(whole: Area, objects: [Range<Mm>; 2], margin: Mm) -> Result<Area, [Mm; 2]> {
    let mut part = whole.around(objects, margin);
    let [x, y] = objects;
    for (axis, object) in objects.iter().enumerate() {
        let (side, whole) = if axis == 0 { (&mut part.x, whole.x) } else { (&mut part.y, whole.y) };
        let lacks = LEAST_SIDE.saturating_sub(side.most.saturating_sub(side.least));
        if lacks > Mm::ZERO {
            let least = whole.clamp(side.least.saturating_sub(lacks / 2));
            side.most = whole.clamp(least.saturating_add(LEAST_SIDE));
            side.least = whole.clamp(side.most.saturating_sub(LEAST_SIDE));
        }
        let is_apart =
            object.least.saturating_sub(margin) > whole.most || object.most.saturating_add(margin) < whole.least;
        if is_apart || object.least > object.most || side.most.saturating_sub(side.least) < LEAST_SIDE {
            let outside =
                |side: Range<Mm>, whole: Range<Mm>| if whole.holds(side.least) { side.most } else { side.least };
            return Err([outside(x, whole), outside(y, whole)]);
        }
    }
    Ok(part)
}

/// The area of the words, if there is one. Its missing edges are those of the whole.
fn wanted_area(whole: Area, modal: &Modal, words: &GridWords) -> Option<[Range<Mm>; 2]> {
    if let Some(square) = words.square {
        let half = modal.length(square) / 2;
        return Some([whole.x, whole.y].map(|side| {
            let middle = side.least.saturating_add(side.most) / 2;
            Range { least: middle.saturating_sub(half), most: middle.saturating_add(half) }
        }));
    }
    let [left, right, front, back] = words.area;
    let length = |number: Number| {
        if words.is_in_mm { Mm::saturating_from_num(number.value()) } else { modal.length(number) }
    };
    let side = |edges: [Option<Number>; 2], whole: Range<Mm>| match edges.map(|edge| edge.map(length)) {
        // Any two corners name an area.
        [Some(one), Some(other)] => Range { least: one.min(other), most: one.max(other) },
        [least, most] => Range { least: least.unwrap_or(whole.least), most: most.unwrap_or(whole.most) },
    };
    let has_edge = words.area.iter().any(Option::is_some);
    has_edge.then(|| [side([left, right], whole.x), side([front, back], whole.y)])
}

/// The heights of all points, relative to the reference. Rows go to and fro.
async fn touch_grid<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    area: &Area,
    words: &GridWords,
) -> Result<Heights, Interrupt> {
    let between = if words.takes_in { AfterTouch::In } else { AfterTouch::Out };
    let place = main_loop.settings.probe_home();
    let zero = touch_bed(main_loop, Some(place), between).await?;
    let [columns, rows] = area.points;
    let mut heights = Heights::flat(columns, rows).unwrap_or(Heights::NONE);
    let (all, is_told) = (columns * rows, words.verbosity.is_some_and(|verbosity| verbosity > Number::ZERO));
    for number in 0..all {
        let row = number / columns.max(1);
        let along = number % columns.max(1);
        let column = if row % 2 == 0 { along } else { columns - 1 - along };
        let at = area.at(column, row);
        let end = if number + 1 == all { AfterTouch::In } else { between };
        let height = touch_bed(main_loop, Some(at), end).await?.saturating_sub(zero);
        heights.set(column, row, units(height));
        if is_told {
            let ([x, y], number) = (at.map(Hundredths::of), number + 1);
            let height = Thousandths(height);
            main_loop
                .reply(Answer::words(&|to, _| to.say(text!("echo:probe {number}/{all} X{x} Y{y} Z{height}"))))
                .await?;
        }
    }
    Ok(heights)
}
