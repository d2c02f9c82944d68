//! The bed: probe, mesh and screws.

use super::words::{reduced, switch, word, write_text};
use core::fmt::{self, Formatter};
use corehbot::gcode::{BedCommand, Forgets, GridWords, LevelWords, MeshPoint, Number, ProbeCommand};

pub(super) fn probe(f: &mut Formatter<'_>, command: ProbeCommand, line: &[u8]) -> fmt::Result {
    match command {
        ProbeCommand::Touch { at: [x, y], stays_out } => {
            f.write_str("G30")?;
            word(f, 'X', x)?;
            word(f, 'Y', y)?;
            f.write_str(if stays_out { " E0" } else { "" })
        }
        ProbeCommand::Deploy => f.write_str("M401"),
        ProbeCommand::Quick(Some(is_quick)) => f.write_str(if is_quick { "M401 S1" } else { "M401 S0" }),
        ProbeCommand::Quick(None) => f.write_str("M401 H"),
        ProbeCommand::Stow => f.write_str("M402"),
        _ => reduced(f, line),
    }
}

pub(super) fn level(f: &mut Formatter<'_>, words: LevelWords) -> fmt::Result {
    f.write_str("G34")?;
    word(f, 'I', words.rounds)?;
    word(f, 'T', words.within)?;
    word(f, 'A', words.share)?;
    f.write_str(if words.keeps_out { " E" } else { "" })
}

pub(super) fn bed(f: &mut Formatter<'_>, command: BedCommand<'_>, line: &[u8]) -> fmt::Result {
    match command {
        BedCommand::Measure(GridWords { is_adaptive, margin, area, counts, is_in_mm: true, .. }) => {
            write!(f, "BED_MESH_CALIBRATE ADAPTIVE={}", u8::from(is_adaptive))?;
            margin.map_or(Ok(()), |margin| write!(f, " ADAPTIVE_MARGIN={margin}"))?;
            if let [Some(x), Some(y)] = counts {
                write!(f, " PROBE_COUNT={x},{y}")?;
            }
            let [x, to_x, y, to_y] = area;
            for (name, place) in [("MESH_MIN", x.zip(y)), ("MESH_MAX", to_x.zip(to_y))] {
                place.map_or(Ok(()), |(x, y)| write!(f, " {name}={x},{y}"))?;
            }
            Ok(())
        }
        BedCommand::Measure(words) => {
            f.write_str("G29")?;
            for (letter, edge) in ['L', 'R', 'F', 'B'].into_iter().zip(words.area) {
                word(f, letter, edge)?;
            }
            word(f, 'H', words.square)?;
            word(f, 'V', words.verbosity)?;
            let all = [(words.only_without, " O"), (words.is_dry, " D"), (words.homes, " N"), (words.takes_in, " E")];
            all.into_iter().filter(|(is_set, _)| *is_set).try_for_each(|(_, letter)| f.write_str(letter))
        }
        BedCommand::Levelling(words) => {
            switch(f, "M420", words.on.map(|on| Number::from(i32::from(on))))?;
            word(f, 'T', words.form)?;
            word(f, 'Z', words.fade)?;
            let all = [(words.reports, " V"), (words.centres, " C"), (words.loads, " L")];
            all.into_iter().filter(|(is_set, _)| *is_set).try_for_each(|(_, letter)| f.write_str(letter))
        }
        BedCommand::Point(words) => {
            f.write_str("M421")?;
            let (letters, numbers) = match words.point {
                MeshPoint::Number(numbers) => (['I', 'J'], numbers.map(Some)),
                MeshPoint::Place(numbers) => (['X', 'Y'], numbers),
                MeshPoint::Nearest => (['C', 'C'], [None; 2]),
            };
            if words.point == MeshPoint::Nearest {
                f.write_str(" C")?;
            }
            letters.into_iter().zip(numbers).try_for_each(|(letter, number)| word(f, letter, number))?;
            word(f, 'Z', words.height)?;
            word(f, 'Q', words.change)?;
            f.write_str(if words.forgets { " N" } else { "" })
        }
        BedCommand::Object { outline } => {
            f.write_str("EXCLUDE_OBJECT_DEFINE POLYGON=")?;
            write_text(f, outline)
        }
        BedCommand::Forget(which) => f.write_str(match which {
            Forgets::Present => "BED_MESH_CLEAR",
            Forgets::PresentThenKept => "G29 J",
            Forgets::Kept => "BED_MESH_PROFILE REMOVE=1",
        }),
        BedCommand::CleanNozzle => f.write_str("G29 P9"),
        BedCommand::Tilt => f.write_str("G29 J2"),
        BedCommand::Report => f.write_str("BED_MESH_OUTPUT"),
        BedCommand::Save => f.write_str("BED_MESH_PROFILE SAVE=1"),
        BedCommand::NoObjects => f.write_str("EXCLUDE_OBJECT_DEFINE RESET=1"),
        _ => reduced(f, line),
    }
}
