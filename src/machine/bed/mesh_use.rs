//! M420 and Klipper's commands about the mesh: whether z follows it, its report, and the kept one.

use super::levelling::{LevellingWords, forget, level, report};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Number, flaw_of_pairs};
use crate::machine::reports::mesh_report::{NO_MESH, report_levelling};
use crate::machine::setup::kept_mesh::{forget_kept_mesh, keep_mesh};

/// Without words it reports.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Bed mesh", &[420])
    .grammar(&Grammar::numbers(b"Z"))
    .does(
        "S, V T, Z, C, L",
        "uses the mesh (S1) or not (S0); V reports it, T1 as a table; Z: the height up to which it fades; C: \
            centres it on its mean; L0: takes the kept one",
    )
    .examples(&[
        ("M420", &["echo:Bed Leveling OFF", "echo:Fade Height 10.00"]),
        ("M420 S1", &["echo:Invalid mesh. G29 measures one", "echo:Bed Leveling OFF", "echo:Fade Height 10.00"]),
        ("M420 Z0", &["echo:Bed Leveling OFF", "echo:Fade Height OFF"]),
        ("M420 Z200", &["echo:M420 ignored: Z200 is out of range (1 to 100), stays 10"]),
    ]);

pub(in crate::machine) const CLEAR: Entry = Entry::name("Bed mesh", &["BED_MESH_CLEAR"])
    .does("", "forgets the mesh; M500 leaves the kept one")
    .examples(&[("BED_MESH_CLEAR", &[])]);

pub(in crate::machine) const OUTPUT: Entry = Entry::name("Bed mesh", &["BED_MESH_OUTPUT"])
    .does("", "reports the mesh, as M420 V")
    .examples(&[("BED_MESH_OUTPUT", &["echo:Invalid mesh. G29 measures one"])]);

pub(in crate::machine) const PROFILE: Entry = Entry::name("Bed mesh", &["BED_MESH_PROFILE"])
    .judge(|_, text| profile(text).err().into())
    .does("LOAD= SAVE= REMOVE=", "takes the kept mesh, keeps the present one, forgets both; there is one")
    .examples(&[("BED_MESH_PROFILE SAVE=default", &["echo:Invalid mesh. G29 measures one"])]);

/// What a line asks for.
enum Asked {
    Level(LevellingWords),
    Clear,
    Output,
    Save,
    Remove,
}

impl Asked {
    fn of(command: &TableCommand<'_>) -> Self {
        if command.code() == 420 {
            let [verbosity, form, fade] = command.numbers(b"VTZ");
            Self::Level(LevellingWords {
                on: command.switch(),
                reports: command.has(b'V') && verbosity != Some(Number::ZERO),
                form,
                fade,
                centres: command.has(b'C'),
                loads: command.has(b'L'),
            })
        } else if command.is_named("BED_MESH_CLEAR") {
            Self::Clear
        } else if command.is_named("BED_MESH_OUTPUT") {
            Self::Output
        } else {
            profile(command.text()).unwrap_or(Self::Output)
        }
    }
}

/// BED_MESH_PROFILE, with any name: there is one mesh. The first of its words counts.
#[inline(never)]
fn profile(text: &[u8]) -> Result<Asked, Flaw<'_>> {
    const NAMES: [&str; 3] = ["LOAD", "SAVE", "REMOVE"];
    let mut first = NAMES.len();
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        first = pair.place;
        // The words behind it do not count.
        if first < NAMES.len() { Some(pair.flaw()) } else { None }
    });
    match (first, flaw) {
        (0, _) => Ok(Asked::Level(LevellingWords { loads: true, ..LevellingWords::USE })),
        (1, _) => Ok(Asked::Save),
        (2, _) => Ok(Asked::Remove),
        (_, Some(flaw)) => Err(flaw),
        (_, None) => Ok(Asked::Level(LevellingWords::default())),
    }
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    Ok(match Asked::of(command) {
        Asked::Level(ref words) => return level(main_loop, states, words).await,
        Asked::Clear => {
            forget(main_loop, false).await?;
            Answer::Nothing
        }
        Asked::Output => report(main_loop, false),
        Asked::Save if main_loop.bed.mesh().is_none() => Answer::Line(NO_MESH),
        Asked::Save => match keep_mesh(main_loop).await? {
            Some(news) => news.answer(main_loop),
            None => Answer::words(&report_levelling),
        },
        Asked::Remove => {
            forget(main_loop, false).await?;
            forget_kept_mesh(main_loop).await?.answer(main_loop)
        }
    })
}
