//! Ways of the tool in a pause: filament back, up and to the parking place, and back again. Filament is changed here,
//! too.
//!
//! A way is decided at once and then gone, so that one place waits for its moves.

use super::park_words::ParkWords;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::settings::HomedAxis;
use crate::units::{Mm, MmPerSec};

/// At this distance above the end of the last printing move the tool is off the part: a slicer's z-hop is less (0.2 to
/// 0.8 mm).
const OFF_PART: Mm = Mm::const_from_int(1);

/// Straight moves in machine coordinates, each with its speed. No heapless vector: futures would get code to drop it.
struct Way {
    legs: [([Mm; 4], MmPerSec); 4],
    count: usize,
}

impl Way {
    const fn new() -> Self {
        Self { legs: [([Mm::ZERO; 4], MmPerSec::ZERO); 4], count: 0 }
    }

    /// Then goes there. Inlined, it would be repeated seven times.
    #[inline(never)]
    fn add(&mut self, position: &[Mm; 4], speed: MmPerSec) {
        if let Some(leg) = self.legs.get_mut(self.count) {
            *leg = (*position, speed);
            self.count += 1;
        }
    }
}

/// One straight move in machine coordinates, independent of the program's state.
async fn travel<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    position: [Mm; 4],
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    main_loop.plan(Target { position, speed: speed.into(), has_overrides: false, watch: EndstopSet::NONE }).await
}

/// Plans all of a way. With `parks` the tool counts as parked where it has come.
async fn go_along<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    way: &Way,
    parks: bool,
) -> Result<(), Interrupt> {
    for (position, speed) in way.legs.iter().take(way.count) {
        travel(main_loop, *position, *speed).await?;
        if parks {
            main_loop.commanded.park_at(*position);
        }
    }
    Ok(())
}

/// Filament comes out or goes in, as by a line in the pause. The length is limited to one line's maximum; with a cold
/// hotend it is zero.
pub(in crate::machine) async fn change<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    length: Mm,
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    if length == Mm::ZERO || states.modal.dry_run {
        return Ok(());
    }
    if states.is_too_cold(main_loop) {
        main_loop.say(text!("echo:filament is not moved: the hotend is too cold"));
        return Ok(());
    }
    let most = main_loop.settings.axes.e.length;
    let mut to = main_loop.commanded.position();
    let [.., e] = &mut to;
    *e = e.wrapping_add(length.clamp(most.saturating_neg(), most));
    travel(main_loop, main_loop.commanded.of_machine(to), speed).await?;
    main_loop.commanded.go_to(to);
    main_loop.finish().await
}

/// Filament back, up, and away.
pub(in crate::machine) async fn park<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    words: &ParkWords,
) -> Result<(), Interrupt> {
    go_along(main_loop, &way_to_park(main_loop, states, words), true).await?;
    main_loop.finish().await
}

fn way_to_park<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, states: &States, words: &ParkWords) -> Way {
    let (s, commanded, mut way) = (&main_loop.settings.pause, &main_loop.commanded, Way::new());
    let [.., z_now, e_now] = commanded.position();
    let [lifted, pulled] = commanded.retracted();
    // The lift and retraction by the program itself since it last printed.
    let (lifted, pulled) = match main_loop.job.printed_at() {
        Some([.., z, e]) => {
            let back = e.wrapping_sub(e_now).max(Mm::ZERO);
            (lifted.saturating_add(z_now.saturating_sub(z)), pulled.saturating_add(back))
        }
        None => (lifted, pulled),
    };
    let is_off_part = lifted >= OFF_PART;
    let length = |number| states.modal.length(number);
    let mut machine = commanded.of_machine(commanded.position());
    let back = words.e.map_or(s.retract, |number| length(number).saturating_abs()).saturating_sub(pulled);
    if back > Mm::ZERO && !states.modal.dry_run && !states.is_too_cold(main_loop) {
        let [.., e] = &mut machine;
        *e = e.wrapping_sub(back);
        way.add(&machine, s.retract_speed);
    }
    let [x_homed, y_homed, z_homed] = main_loop.homed.axes();
    let lift = match words.z {
        Some(number) => length(number).max(Mm::ZERO),
        None if is_off_part => Mm::ZERO,
        None => s.lift,
    };
    if lift > Mm::ZERO && z_homed {
        let [_, _, z, _] = &mut machine;
        let top = if main_loop.settings.soft_endstops { z_reach(main_loop).most.max(*z) } else { Mm::MAX };
        *z = z.saturating_add(lift).min(top);
        way.add(&machine, main_loop.settings.axes.z.max_speed);
    }
    let is_named = words.x.is_some() || words.y.is_some();
    if (is_named || s.park && !is_off_part) && x_homed && y_homed && z_homed {
        let [x, y, ..] = &mut machine;
        for (at, word, place, axis) in [(x, words.x, s.x, HomedAxis::X), (y, words.y, s.y, HomedAxis::Y)] {
            if word.is_some() || s.park {
                *at = main_loop.settings.reach(axis).clamp(word.map_or(place, length));
            }
        }
        way.add(&machine, s.travel_speed);
    }
    way
}

/// The tool moves from its present place to the commanded position: first above it, then down. Then the filament goes
/// forward that the pause has pulled back. In a cold hotend it stays back, until a held line that prints continues.
pub(in crate::machine) async fn go_back<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    from: [Mm; 4],
) -> Result<(), Interrupt> {
    let (way, back) = way_back(main_loop, states, from);
    go_along(main_loop, &way, false).await?;
    main_loop.commanded.unpark(back);
    main_loop.finish().await
}

/// The way to the commanded position, and the filament that stays back.
fn way_back<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, states: &States, from: [Mm; 4]) -> (Way, Mm) {
    let (s, commanded, mut way) = (&main_loop.settings.pause, &main_loop.commanded, Way::new());
    let z_speed = main_loop.settings.axes.z.max_speed;
    let ([x, y, z, e], [from_x, from_y, from_z, from_e]) = (commanded.of_print(commanded.position()), from);
    // Move above any part on the bed if a user has lowered the tool.
    let is_beside = (x, y) != (from_x, from_y);
    let top = z_reach(main_loop).most.max(z);
    let over = if is_beside && from_z < z { z.saturating_add(s.lift).min(top) } else { from_z };
    way.add(&[from_x, from_y, over, from_e], z_speed);
    way.add(&[x, y, over, from_e], s.travel_speed);
    way.add(&[x, y, z, from_e], z_speed);
    if e != from_e && states.is_too_cold(main_loop) {
        return (way, from_e.wrapping_sub(e));
    }
    way.add(&[x, y, z, e], s.unretract_speed);
    (way, Mm::ZERO)
}
