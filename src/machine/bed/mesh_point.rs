//! M421 and G42: a point of the mesh is changed, or gone over.

use super::mesh_points::{MeshPoint, PointWords, change_point, go_to_point};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature};

pub(in crate::machine) const CHANGE: Entry = Entry::m("Bed mesh", &[421])
    .grammar(&Grammar::numbers(b"IJXYZQ"))
    .does(
        "I J, X Y, C, Z, Q, N",
        "sets (Z) or changes (Q) the height of a point by its number or place; C: the nearest to the probe",
    )
    .examples(&[("M421 I0 J0 Z0.1", &["echo:Invalid mesh. G29 measures one"])]);

pub(in crate::machine) const GO_OVER: Entry = Entry::g("Bed mesh", &[42])
    .nature(Nature::Work)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"IJF"))
    .does("I J P F", "goes over a point of the mesh; P: with the probe")
    .examples(&[("G42 I1 J1", &["echo:Invalid mesh. G29 measures one"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let [i, j, x, y, height, change] = command.numbers(b"IJXYZQ");
    if command.code() == 42 {
        return go_to_point(main_loop, states, [i, j], command.has(b'P'), command.number(b'F')).await;
    }
    let point = match (i, j) {
        _ if command.has(b'C') => MeshPoint::Nearest,
        (Some(i), Some(j)) => MeshPoint::Number([i, j]),
        _ => MeshPoint::Place([x, y]),
    };
    change_point(main_loop, states, &PointWords { point, height, change, forgets: command.has(b'N') }).await
}
