//! G29, G80, BED_MESH_CALIBRATE: the bed is measured at the points of a mesh. G29 does more, by its words.

use super::levelling::{LevellingWords, forget, level};
use super::measure::{GridWords, measure};
use super::mesh_points::{MeshPoint, PointWords, change_point};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Mark, Nature, Number, flaw_of_pairs};
use crate::machine::apart::apart;
use core::pin::pin;

pub(in crate::machine) const ENTRY: Entry = Entry::g("Bed mesh", &[29])
    .works_if(|command| matches!(Asked::of(command), Asked::Measure(_)))
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"FBLRHIZ"))
    .does(
        "X Y W H P, F B L R H, O A D J N E V S, W I J Z",
        "measures the bed at the points of a mesh, or in an area (M555); O: only if no mesh is on; A: M420 S1; D: \
            only reports; J: forgets, and M500 the kept one too; N: homes first; E: the probe is taken in between; V4: names each point; W: sets one",
    )
    .examples(&[("G29", &["echo:no probe configured, ignored"]), ("G29 J", &[]), ("G29 P9", &["echo:G29 P9 ignored: this firmware does not clean the nozzle"])]);

/// Prusa.
pub(in crate::machine) const WHOLE: Entry = Entry::g("Bed mesh", &[80])
    .nature(Nature::Work)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b""))
    .does("", "measures the bed, as G29 (Prusa)")
    .examples(&[("G80 N3", &["echo:no probe configured, ignored"])]);

pub(in crate::machine) const BY_NAME: Entry = Entry::name("Bed mesh", &["BED_MESH_CALIBRATE"])
    .nature(Nature::Work)
    .mark(Mark::FindsBed)
    .judge(|_, text| by_name(text).err().into())
    .does(
        "MESH_MIN= MESH_MAX= PROBE_COUNT= ADAPTIVE= ADAPTIVE_MARGIN=",
        "measures the bed, from x,y to x,y, with columns,rows; ADAPTIVE=1: around the objects of the print",
    )
    .examples(&[("BED_MESH_CALIBRATE ADAPTIVE=1", &["echo:no probe configured, ignored"])]);

/// What a line asks for.
enum Asked {
    Measure(GridWords),
    Point(PointWords),
    /// M420 S1.
    Use,
    /// P9: cleans the nozzle, which needs a place for it.
    CleanNozzle,
    /// J2: tilts the mesh by some touches (Marlin's UBL), which this firmware cannot.
    Tilt,
    /// J: forgets the mesh; M500 then forgets the kept one, as in Marlin.
    Forget,
}

impl Asked {
    fn of(command: &TableCommand<'_>) -> Self {
        match command.code() {
            29 => Self::by_words(command),
            80 => Self::Measure(GridWords::default()),
            _ => Self::Measure(by_name(command.text()).unwrap_or_default()),
        }
    }

    /// Words of a single point come first; then those of other firmware that mean no measurement: `A` and `P3.2`
    /// (Prusa, UBL), `P9`; an area by X, Y, W and H (Prusa's P1) or by its edges (Marlin).
    fn by_words(command: &TableCommand<'_>) -> Self {
        let flag = |letter: u8| command.has(letter);
        let [x, y, width, depth, phase, i, j, height, verbosity] = command.numbers(b"XYWHPIJZV");
        let phase = phase.map(Number::to_int);
        // Marlin's W writes a single point and has no number; Prusa's is a width.
        if flag(b'W') && (flag(b'I') || width.is_none()) {
            let point = match (i, j) {
                (Some(i), Some(j)) => MeshPoint::Number([i, j]),
                _ => MeshPoint::Place([x, y]),
            };
            return Self::Point(PointWords { point, height, change: None, forgets: false });
        }
        match phase {
            // Points without a measurement have been filled in already.
            Some(3) => return Self::Use,
            Some(9) => return Self::CleanNozzle,
            _ => {}
        }
        match j {
            Some(number) if number > Number::from(1) => return Self::Tilt,
            _ if flag(b'J') => return Self::Forget,
            _ => {}
        }
        if flag(b'A') && phase.is_none() {
            return Self::Use;
        }
        let area = match (x, y, width, depth) {
            (Some(x), Some(y), Some(width), Some(depth)) => {
                let sum = |a: Number, b: Number| Some(Number::saturating(a.value().saturating_add(b.value())));
                [Some(x), sum(x, width), Some(y), sum(y, depth)]
            }
            _ => command.numbers(b"LRFB"),
        };
        Self::Measure(GridWords {
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
}

/// Words that it does not know are for other probes.
#[inline(never)]
fn by_name(text: &[u8]) -> Result<GridWords, Flaw<'_>> {
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
    flaw.map_or(Ok(grid), Err)
}

/// One number, or two with a comma.
fn numbers_of(value: &[u8]) -> [Option<Number>; 2] {
    let mut numbers = value.split(|byte| *byte == b',').map(|text| Number::read(text).map(|(number, _)| number));
    [numbers.next().flatten(), numbers.next().flatten()]
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    match Asked::of(command) {
        Asked::Measure(ref words) => apart(pin!(measure(main_loop, states, words))).await,
        Asked::Point(ref words) => change_point(main_loop, states, words).await,
        Asked::Use => level(main_loop, states, &LevellingWords::USE).await,
        Asked::CleanNozzle => Ok(Answer::Line(packed!("echo:G29 P9 ignored: this firmware does not clean the nozzle"))),
        Asked::Tilt => {
            Ok(Answer::Line(packed!("echo:G29 J ignored: this firmware does not tilt a mesh. G29 measures it again")))
        }
        Asked::Forget => {
            let was_there = forget(main_loop, true).await?;
            Ok(if was_there {
                Answer::Line(packed!("echo:mesh forgotten, and by M500 the stored one too"))
            } else {
                Answer::Nothing
            })
        }
    }
}
