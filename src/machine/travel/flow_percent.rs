//! M221: the flow of filament in percent.

use crate::gcode::{Entry, Grammar, Mark, Nature, Part, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::modal::PERCENT;
use crate::machine::states::States;
use crate::port::Wake;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[221])
    .nature(Nature::Mode)
    .mark(Mark::SaidOnConnecting)
    .grammar(&Grammar::numbers(b"STD").parts(&[(b'T', Part::Extruder), (b'D', Part::Extruder)]))
    .does("S T D", "flow in percent; T and D name the extruder, 0; or reports")
    .examples(&[
        ("M221 S95", &[]),
        ("M221", &["echo:E0 Flow: 100%"]),
        ("M221 S5000", &["echo:M221 ignored: S5000 is out of range (10 to 999), stays 100"]),
        ("M221 T1 S50", &["echo:M221 ignored: there is no extruder 1"]),
        ("M221 S50 D1", &["echo:M221 ignored: there is no extruder 1"]),
        ("M221 T S50", &["echo:line ignored: T needs a number"]),
        ("M221 T0:1 S95", &[]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.number(b'S') {
        Some(number) => {
            clamps.whole(["M221", "S"], number, PERCENT, &mut modal.flow_percent);
            Answer::Nothing
        }
        None => {
            main_loop.say(text!("echo:E0 Flow: {}%", modal.flow_percent));
            Answer::Said
        }
    }
}
