//! SET_HEATER_TEMPERATURE, TURN_OFF_HEATERS: targets of the heaters in Klipper's words.

use super::heating::order_target;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::connectors::Heater;
use crate::gcode::{Absent, Flaw, Named, Nature, Number, Part, flaw_of_pairs};
use crate::text::is_word;
use crate::units::Celsius;

const NAME: &str = "SET_HEATER_TEMPERATURE";

pub(in crate::machine) const TARGET: Entry = Entry::name("Heat and fans", &[NAME])
    .nature(Nature::Report)
    .works_if(|command| target(command.text()).is_ok_and(|(_, target)| target > Number::ZERO))
    .judge(|_, text| target(text).err().into())
    .does("HEATER= TARGET=", "target of extruder, heater_bed or chamber, off without TARGET")
    .examples(&[
        ("SET_HEATER_TEMPERATURE HEATER=extruder TARGET=200", &["echo:no heaters configured"]),
        ("SET_HEATER_TEMPERATURE HEATER=oven", &["echo:SET_HEATER_TEMPERATURE ignored: there is no heater oven"]),
        ("SET_HEATER_TEMPERATURE TARGET=200", &["echo:line ignored: \"TARGET=200\" is not a name with = and a number"]),
    ]);

pub(in crate::machine) const OFF: Entry = Entry::name("Heat and fans", &["TURN_OFF_HEATERS"])
    .nature(Nature::Report)
    .does("", "all heaters off; fans stay as they are")
    .examples(&[("TURN_OFF_HEATERS", &[])]);

/// The heater that has this name in Klipper, for a command.
pub(super) fn heater_named<'a>(command: &'static str, name: &'a [u8]) -> Result<Heater, Flaw<'a>> {
    // The name of a section's kind may stand before its own: "heater_generic chamber".
    let own = name.rsplit(|byte| *byte == b' ').next().unwrap_or(name);
    let known: [(&[u8], Heater); 3] =
        [(b"extruder", Heater::Hotend), (b"heater_bed", Heater::Bed), (b"chamber", Heater::Chamber)];
    let found = known.into_iter().find(|(its, _)| is_word(own, its)).map(|(_, heater)| heater);
    found.ok_or(Flaw::Absent(Absent { command: Named::Name(command), part: Part::Heater, which: name }))
}

/// The heater, and its target.
#[inline(never)]
fn target(text: &[u8]) -> Result<(Heater, Number), Flaw<'_>> {
    let (mut name, mut numbers) = (None, [None; 1]);
    let flaw = flaw_of_pairs(text, &["TARGET", "HEATER"], &mut |pair| {
        if pair.place == 1 {
            name = Some(pair.value);
        }
        pair.put_number(&mut numbers)
    });
    if let Some(flaw) = flaw {
        return Err(flaw);
    }
    let heater = heater_named(NAME, name.ok_or(Flaw::NoPair(text.trim_ascii()))?)?;
    let [target] = numbers;
    Ok((heater, target.unwrap_or_default()))
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if command.is_named(NAME) {
        let Ok((heater, target)) = target(command.text()) else { return Ok(Answer::Nothing) };
        return order_target(main_loop, states, [NAME, "TARGET="], (heater, Some(target)), None).await;
    }
    for heater in Heater::ALL {
        main_loop.heat.set_target(heater, Celsius::ZERO);
    }
    main_loop.heat.send_orders(&main_loop.settings.thermal);
    // Nothing is printed without heat.
    if main_loop.job.is_printing() {
        main_loop.job.end();
    }
    Ok(Answer::Nothing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heater_has_the_name_of_its_section() {
        let of = |name: &'static str| heater_named(NAME, name.as_bytes()).ok();
        assert_eq!(of("extruder"), Some(Heater::Hotend));
        assert_eq!(of("Heater_Bed"), Some(Heater::Bed));
        assert_eq!([of("chamber"), of("heater_generic chamber")], [Some(Heater::Chamber); 2]);
        assert_eq!([of("extruder1"), of(""), of("heater_generic oven")], [None; 3]);
    }

    #[test]
    fn without_a_target_it_is_off() {
        assert_eq!(target(b" HEATER=extruder"), Ok((Heater::Hotend, Number::ZERO)));
        assert_eq!(target(b" heater=heater_bed target=6e1"), Ok((Heater::Bed, Number::from(60))));
        assert!(matches!(target(b" HEATER=extruder TARGET=hot"), Err(Flaw::NoPair(b"TARGET=hot"))));
        assert!(matches!(target(b""), Err(Flaw::NoPair(b""))));
    }
}
