//! The bed's mesh: measuring it, switching it on and off, changing a point; and the area that a print needs.

use super::Command;
use super::grammar::{Grammar, WORDS};
use super::pairs::flaw_of_pairs;
use super::row::Described;
use crate::gcode::lexer::{has, numbers, switch};
use crate::gcode::number::Number;
use crate::gcode::parts::{GridWords, LevellingWords, MeshPoint, PointWords};

/// The bed's mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum BedCommand<'a> {
    /// G29, G80, BED_MESH_CALIBRATE: measures the bed.
    Measure(GridWords),
    /// Forgets the mesh.
    Forget(Forgets),
    /// G29 P9: cleans the nozzle, which needs a place for it.
    CleanNozzle,
    /// G29 J2: tilts the mesh by some touches (Marlin's UBL), which this firmware cannot.
    Tilt,
    /// M420, G29 A: uses the mesh or not, or reports.
    Levelling(LevellingWords),
    /// BED_MESH_OUTPUT: reports the mesh.
    Report,
    /// BED_MESH_PROFILE SAVE=: keeps the mesh.
    Save,
    /// M421, G29 W: a point of the mesh.
    Point(PointWords),
    /// G42: goes over a point of the mesh.
    GoTo {
        /// Its column and row.
        point: [Option<Number>; 2],
        /// P: with the probe instead of the nozzle.
        by_probe: bool,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// EXCLUDE_OBJECT_DEFINE: an object of the print, by its outline.
    Object {
        /// The text of POLYGON, or of CENTER without one.
        outline: &'a [u8],
    },
    /// EXCLUDE_OBJECT_DEFINE RESET=1: no object is known.
    NoObjects,
}

/// Which mesh is forgotten.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Forgets {
    /// BED_MESH_CLEAR: the present one.
    Present,
    /// G29 J: the present one; M500 then forgets the kept one, as in Marlin.
    PresentThenKept,
    /// BED_MESH_PROFILE REMOVE=: the present one and the kept one.
    Kept,
}

pub(super) const ROWS: &[Described] = &[
    Described::g(&[29], |_, text| bed(grid(text))).grammar(&Grammar::numbers(b"FBLRHIZ")).does(
        "X Y W H P, F B L R H, O A D J N E V S, W I J Z",
        "measures the bed at the points of a mesh, or in an area (M555); O: only if no mesh is on; A: M420 S1; D: \
            only reports; J: forgets, and M500 the kept one too; N: homes first; E: the probe is taken in between; V4: names each point; W: sets one",
    ),
    Described::g(&[42], |_, text| {
        let [i, j, feed] = numbers(text, b"IJF");
        bed(BedCommand::GoTo { point: [i, j], by_probe: has(text, b'P'), feed })
    })
    .grammar(&Grammar::numbers(b"IJF"))
    .does("I J P F", "goes over a point of the mesh; P: with the probe"),
    Described::g(&[80], |_, _| bed(BedCommand::Measure(GridWords::default())))
        .grammar(WORDS)
        .does("", "measures the bed, as G29 (Prusa)"),
    Described::m(&[420], |_, text| bed(BedCommand::Levelling(levelling(text)))).grammar(&Grammar::numbers(b"Z")).does(
        "S, V T, Z, C, L",
        "uses the mesh (S1) or not (S0); V reports it, T1 as a table; Z: the height up to which it fades; C: \
            centres it on its mean; L0: takes the kept one",
    ),
    Described::m(&[421], |_, text| bed(BedCommand::Point(point(text)))).grammar(&Grammar::numbers(b"IJXYZQ")).does(
        "I J, X Y, C, Z, Q, N",
        "sets (Z) or changes (Q) the height of a point by its number or place; C: the nearest to the probe",
    ),
    Described::name(&["BED_MESH_CALIBRATE"], |_, text| Some(calibrate(text)))
        .does(
            "MESH_MIN= MESH_MAX= PROBE_COUNT= ADAPTIVE= ADAPTIVE_MARGIN=",
            "measures the bed, from x,y to x,y, with columns,rows; ADAPTIVE=1: around the objects of the print",
        ),
    Described::name(&["BED_MESH_CLEAR"], |_, _| bed(BedCommand::Forget(Forgets::Present)))
        .does("", "forgets the mesh; M500 leaves the kept one"),
    Described::name(&["BED_MESH_OUTPUT"], |_, _| bed(BedCommand::Report)).does("", "reports the mesh, as M420 V"),
    Described::name(&["BED_MESH_PROFILE"], |_, text| Some(profile(text)))
        .does("LOAD= SAVE= REMOVE=", "takes the kept mesh, keeps the present one, forgets both; there is one"),
    Described::name(&["EXCLUDE_OBJECT_DEFINE"], |_, text| Some(object(text))).does(
        "NAME= CENTER= POLYGON= RESET=",
        "an object of the print: a mesh can be measured around them; none is skipped",
    ),
];

const fn bed(command: BedCommand<'static>) -> Option<Command<'static>> {
    Some(Command::Bed(command))
}

/// G29. Words of a single point come first; then those of other firmware that mean no measurement: `A` and `P3.2`
/// (Prusa, UBL), `P9`; an area by X, Y, W and H (Prusa's P1) or by its edges (Marlin).
fn grid(text: &[u8]) -> BedCommand<'static> {
    let flag = |letter: u8| has(text, letter);
    let [x, y, width, depth, phase, i, j, height, verbosity] = numbers(text, b"XYWHPIJZV");
    let phase = phase.map(Number::to_int);
    // Marlin's W writes a single point and has no number; Prusa's is a width.
    if flag(b'W') && (flag(b'I') || width.is_none()) {
        let point = match (i, j) {
            (Some(i), Some(j)) => MeshPoint::Number([i, j]),
            _ => MeshPoint::Place([x, y]),
        };
        return BedCommand::Point(PointWords { point, height, change: None, forgets: false });
    }
    match phase {
        // Points without a measurement have been filled in already.
        Some(3) => return BedCommand::Levelling(LevellingWords { on: Some(true), ..LevellingWords::default() }),
        Some(9) => return BedCommand::CleanNozzle,
        _ => {}
    }
    match j {
        Some(number) if number > Number::from(1) => return BedCommand::Tilt,
        _ if flag(b'J') => return BedCommand::Forget(Forgets::PresentThenKept),
        _ => {}
    }
    if flag(b'A') && phase.is_none() {
        return BedCommand::Levelling(LevellingWords { on: Some(true), ..LevellingWords::default() });
    }
    let area = match (x, y, width, depth) {
        (Some(x), Some(y), Some(width), Some(depth)) => {
            let sum = |a: Number, b: Number| Some(Number::saturating(a.value().saturating_add(b.value())));
            [Some(x), sum(x, width), Some(y), sum(y, depth)]
        }
        _ => numbers(text, b"LRFB"),
    };
    BedCommand::Measure(GridWords {
        area,
        // H without W is Marlin's square of that size.
        square: if width.is_none() { depth } else { None },
        only_without: flag(b'O'),
        is_dry: flag(b'D'),
        homes: flag(b'N'),
        takes_in: flag(b'E'),
        verbosity,
        ..GridWords::default()
    })
}

/// M420. Without words it reports.
fn levelling(text: &[u8]) -> LevellingWords {
    let [verbosity, form, fade] = numbers(text, b"VTZ");
    LevellingWords {
        on: switch(text),
        reports: has(text, b'V') && verbosity != Some(Number::ZERO),
        form,
        fade,
        centres: has(text, b'C'),
        loads: has(text, b'L'),
    }
}

/// M421.
fn point(text: &[u8]) -> PointWords {
    let [i, j, x, y, height, change] = numbers(text, b"IJXYZQ");
    let point = match (i, j) {
        _ if has(text, b'C') => MeshPoint::Nearest,
        (Some(i), Some(j)) => MeshPoint::Number([i, j]),
        _ => MeshPoint::Place([x, y]),
    };
    PointWords { point, height, change, forgets: has(text, b'N') }
}

/// BED_MESH_CALIBRATE. Words that it does not know are for other probes.
fn calibrate(text: &[u8]) -> Command<'_> {
    const NAMES: [&str; 5] = ["ADAPTIVE", "ADAPTIVE_MARGIN", "PROBE_COUNT", "MESH_MIN", "MESH_MAX"];
    let mut values = [[None; 2]; NAMES.len()];
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        let slot = values.get_mut(pair.place)?;
        *slot = numbers_of(pair.value);
        let [first, second] = *slot;
        // A count for both sides may stand alone.
        let needs_both = pair.place >= 3;
        if first.is_none() || needs_both && second.is_none() { Some(pair.flaw()) } else { None }
    });
    let [[adaptive, _], [margin, _], [columns, rows], [x, y], [to_x, to_y]] = values;
    let grid = GridWords {
        is_in_mm: true,
        is_adaptive: adaptive.is_some_and(|number| number != Number::ZERO),
        margin,
        counts: [columns, rows.or(columns)],
        area: [x, to_x, y, to_y],
        ..GridWords::default()
    };
    flaw.map_or(Command::Bed(BedCommand::Measure(grid)), Command::Malformed)
}

/// One number, or two with a comma.
fn numbers_of(value: &[u8]) -> [Option<Number>; 2] {
    let mut numbers = value.split(|byte| *byte == b',').map(|text| Number::read(text).map(|(number, _)| number));
    [numbers.next().flatten(), numbers.next().flatten()]
}

/// BED_MESH_PROFILE, with any name: there is one mesh. The first of its words counts.
fn profile(text: &[u8]) -> Command<'_> {
    const NAMES: [&str; 3] = ["LOAD", "SAVE", "REMOVE"];
    let mut first = NAMES.len();
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        first = pair.place;
        // The words behind it do not count.
        if first < NAMES.len() { Some(pair.flaw()) } else { None }
    });
    match (first, flaw) {
        (0, _) => {
            let words = LevellingWords { on: Some(true), loads: true, ..LevellingWords::default() };
            Command::Bed(BedCommand::Levelling(words))
        }
        (1, _) => Command::Bed(BedCommand::Save),
        (2, _) => Command::Bed(BedCommand::Forget(Forgets::Kept)),
        (_, Some(flaw)) => Command::Malformed(flaw),
        (_, None) => Command::Bed(BedCommand::Levelling(LevellingWords::default())),
    }
}

/// EXCLUDE_OBJECT_DEFINE. A polygon has no blanks, or stands last.
fn object(text: &[u8]) -> Command<'_> {
    let behind = |name: &[u8]| {
        let at = text.windows(name.len()).position(|part| part.eq_ignore_ascii_case(name))?;
        text.get(at + name.len()..)
    };
    match (behind(b"RESET="), behind(b"POLYGON=").or_else(|| behind(b"CENTER="))) {
        (_, Some(outline)) => Command::Bed(BedCommand::Object { outline }),
        (Some(_), None) => Command::Bed(BedCommand::NoObjects),
        (None, None) => Command::Bed(BedCommand::Object { outline: b"" }),
    }
}

/// The pairs of numbers in the outline of an object: `[[5,5],[15,5]]`, or `10,10`. It ends at a blank outside of
/// brackets.
pub fn places(outline: &[u8]) -> impl Iterator<Item = [Number; 2]> + '_ {
    let mut left = outline;
    let mut depth = 0;
    let mut next = move || {
        loop {
            let (&byte, rest) = left.split_first()?;
            match byte {
                b'[' => depth += 1,
                b']' => depth -= 1,
                b' ' | b'\t' if depth <= 0 => return None,
                b'-' | b'+' | b'.' | b'0'..=b'9' => {
                    let (number, behind) = Number::read(left)?;
                    left = behind;
                    return Some(number);
                }
                _ => {}
            }
            left = rest;
        }
    };
    core::iter::from_fn(move || Some([next()?, next()?]))
}
