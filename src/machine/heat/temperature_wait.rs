//! TEMPERATURE_WAIT: waits until a heater is as warm as a line says, which need not be its target.

use super::heaters_by_name::heater_named;
use super::heating::{LINE_MS, UNREAD_MS, await_readings, note_no_heat, report_wait, tell_stuck};
use super::reached::{Cooling, NEAR, Rising};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::connectors::Heater;
use crate::gcode::{Flaw, Nature, Number, flaw_of_pairs};
use crate::machine::state::job::JobEnd;
use crate::machine::state::waiting::Waiting;
use crate::settings::Range;
use crate::units::Celsius;

const NAME: &str = "TEMPERATURE_WAIT";

pub(in crate::machine) const ENTRY: Entry = Entry::name("Heat and fans", &[NAME])
    .nature(Nature::Work)
    .judge(|_, text| Wait::read(text).err().into())
    .does(
        "SENSOR= MINIMUM= MAXIMUM=",
        "waits until extruder, heater_bed or chamber is so warm; refused if its target is out of these",
    )
    .examples(&[
        (
            "TEMPERATURE_WAIT SENSOR=extruder MINIMUM=150",
            &["echo:TEMPERATURE_WAIT ignored: its heater does not go there"],
        ),
        (
            "TEMPERATURE_WAIT SENSOR=extruder MAXIMUM=50",
            &["echo:TEMPERATURE_WAIT ignored: its heater does not go there"],
        ),
        ("TEMPERATURE_WAIT SENSOR=oven MINIMUM=40", &["echo:TEMPERATURE_WAIT ignored: there is no heater oven"]),
        (
            "TEMPERATURE_WAIT SENSOR=extruder",
            &["echo:line ignored: \"SENSOR=extruder\" is not a name with = and a number"],
        ),
    ]);

/// What is waited for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Wait {
    heater: Heater,
    range: Range<Celsius>,
}

impl Wait {
    #[inline(never)]
    fn read(text: &[u8]) -> Result<Self, Flaw<'_>> {
        let (mut name, mut numbers) = (None, [None; 2]);
        let flaw = flaw_of_pairs(text, &["MINIMUM", "MAXIMUM", "SENSOR"], &mut |pair| {
            if pair.place == 2 {
                name = Some(pair.value);
            }
            pair.put_number(&mut numbers)
        });
        if let Some(flaw) = flaw {
            return Err(flaw);
        }
        let [least, most] =
            numbers.map(|number| number.map(|number: Number| Celsius::saturating_from_num(number.value())));
        let name = name.filter(|_| least.or(most).is_some()).ok_or(Flaw::NoPair(text.trim_ascii()))?;
        let range = Range { least: least.unwrap_or(Celsius::MIN), most: most.unwrap_or(Celsius::MAX) };
        Ok(Self { heater: heater_named(NAME, name)?, range })
    }
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let Ok(mut wait) = Wait::read(command.text()) else { return Ok(Answer::Nothing) };
    let target = main_loop.heat.target(wait.heater);
    if !main_loop.settings.thermal.heater(wait.heater).is_fitted || !wait.range.holds(target) {
        return Ok(Answer::Line(packed!("echo:TEMPERATURE_WAIT ignored: its heater does not go there")));
    }
    // As near to the target is as good as there (M109): a heater may stay a tenth below it.
    wait.range.least = wait.range.least.min(target.saturating_sub(NEAR));
    wait.range.most = wait.range.most.max(target.saturating_add(NEAR));
    main_loop.pauses.begin(Waiting::Heat);
    follow(main_loop, wait).await?;
    main_loop.pauses.end();
    Ok(Answer::Nothing)
}

/// Tells the temperatures until the heater is there, or M108. It ends the job as M109 does.
async fn follow<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, wait: Wait) -> Result<(), Interrupt> {
    let Wait { heater, range } = wait;
    let place = heater as usize;
    await_readings(main_loop, Heater::ALL.map(|other| other == heater)).await?;
    let (begun, measured, target) = (main_loop.now(), main_loop.heat.measured(), main_loop.heat.target(heater));
    let (mut rising, mut cooling) = (Rising::new(measured, begun), Cooling { looked: (begun, measured) });
    let (mut read, mut next_line, mut moves) = (begun, begun, true);
    main_loop.come_again();
    while !main_loop.pauses.is_over() {
        let (now, measured) = (main_loop.now(), main_loop.heat.measured());
        let refusal = main_loop.heat.refusal(heater, &main_loop.settings.thermal);
        if let Some(why) = refusal.filter(|_| target > Celsius::ZERO || measured[place].is_none()) {
            note_no_heat(main_loop, heater, why);
            return Err(Interrupt::EndJob);
        }
        match measured[place] {
            Some(at) if range.holds(at) => break,
            Some(_) => read = now,
            None if now >= read.after_ms(UNREAD_MS) => {
                main_loop.job.note_end(JobEnd::Unread { heater });
                return Err(Interrupt::EndJob);
            }
            None => {}
        }
        if now >= next_line {
            next_line = next_line.after_ms(LINE_MS);
            main_loop.reply(Answer::words(&|to, facts| report_wait(to, facts, None))).await?;
        }
        let is_this = |other: Heater| other == heater;
        let below = Heater::ALL.map(|other| {
            measured[place].filter(|at| is_this(other) && *at < range.least).map(|at| range.least.saturating_sub(at))
        });
        let are_hot = Heater::ALL.map(|other| is_this(other) && measured[place].is_some_and(|at| at > range.most));
        if cooling.has_ended(are_hot, measured, now) {
            break;
        }
        tell_stuck(main_loop, &mut rising, (below, measured), now)?;
        // The look-ahead would keep the last moves for later ones, and these wait for this line.
        moves = moves && main_loop.motion.let_end(&main_loop.settings, main_loop.now());
        main_loop.poll().await?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wait_has_a_sensor_and_a_limit() {
        let celsius = |degrees: i32| Celsius::from_num(degrees);
        let read = |text: &'static str| Wait::read(text.as_bytes()).ok();
        assert_eq!(
            read(" SENSOR=extruder MINIMUM=198 MAXIMUM=204"),
            Some(Wait { heater: Heater::Hotend, range: Range { least: celsius(198), most: celsius(204) } })
        );
        assert_eq!(
            read(" minimum=58 sensor=heater_bed"),
            Some(Wait { heater: Heater::Bed, range: Range { least: celsius(58), most: Celsius::MAX } })
        );
        for text in ["", " SENSOR=extruder", " MINIMUM=40", " SENSOR=extruder MINIMUM=warm"] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
