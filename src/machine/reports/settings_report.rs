//! Settings as they are shown: as the lines that set them, one each for the command without words, all of them for
//! M503.

use super::heat_settings_report::report_heat_settings;
use super::plain_setting::PlainSetting;
use super::setting_line::SettingLine;
use crate::gcode::Number;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::{SHAPERS, exact, shortest};
use crate::machine::reports::driver_value::DriverValue;
use crate::machine::reports::setting::Setting;
use crate::machine::state::retraction::RetractionSettings;
use crate::motion::advance_window;
use crate::settings::{AxisEnd, Bed, Belt, HomedAxis, Pause, Range, Settings, Shaper, WholePlace};
use crate::units::Mm;
use core::fmt::{self, Display, Formatter};

/// M503: every setting that G-code can set, and as comments some that only a machine file sets.
pub(in crate::machine) fn report_settings(
    to: &mut ReplyWriter<'_>,
    s: &Settings,
    retraction: &RetractionSettings,
    has_drivers: bool,
) {
    to.setting(text!("G21"));
    for setting in Setting::all() {
        report_setting(to, setting, s);
    }
    to.setting(text!("{}", SettingLine::of_retraction(retraction)));
    to.setting(text!("{}", SettingLine::of_recovery(retraction)));
    if has_drivers {
        report_driver_settings(to, s);
    }
    report_heat_settings(to, s);
    report_space(to, s);
    let soft = u8::from(s.soft_endstops);
    to.setting(text!("M211 S{soft} ; {}", if s.soft_endstops { "ON" } else { "OFF" }));
    to.named_setting(text!("SET_GCODE_OFFSET Z={}", exact(s.bed.z_offset)));
    // M851 means nothing without a probe.
    for setting in Setting::others().filter(|setting| s.probe.is_fitted() || *setting != Setting::Plain(851)) {
        report_setting(to, setting, s);
    }
    let lookahead = shortest(s.lookahead_time);
    to.remark(text!("Look-ahead: {lookahead} s"));
}

/// The line or lines of one setting.
pub(in crate::machine) fn report_setting(to: &mut ReplyWriter<'_>, setting: Setting, s: &Settings) {
    match setting {
        Setting::Plain(code) => to.setting(text!("{}", PlainSetting { code, s })),
        Setting::VelocityLimit => {
            let ratio = shortest(s.minimum_cruise_ratio);
            to.named_setting(text!("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO={ratio}"));
        }
        Setting::Shapers => {
            report_shaper(to, 'X', s.shapers.x);
            report_shaper(to, 'Y', s.shapers.y);
        }
        Setting::Advance => {
            to.setting(text!("M900 K{}", shortest(s.advance.time)));
            match s.advance.window {
                Some(window) => to.setting(text!("M572 W{}", shortest(window))),
                None => to.setting(text!("M572 W0 ; auto: {} s", shortest(advance_window(s)))),
            }
        }
        // A single screw needs no place.
        Setting::Screws if s.screw_motors().len() > 1 => {
            for (number, screw) in s.screws.iter().take(s.screw_motors().len()).enumerate() {
                let places = [('S', screw.point), ('W', screw.place)];
                for (letter, WholePlace { x, y }) in places.into_iter().filter(|(_, place)| place.is_known()) {
                    to.setting(text!("M422 {letter}{} X{x} Y{y}", number + 1));
                }
            }
        }
        Setting::Screws => {}
        Setting::Levelling => {
            let is_on = s.mesh.is_on;
            let (on, state) = (u8::from(is_on), if is_on { "ON" } else { "OFF" });
            to.setting(text!("M420 S{on} Z{} ; Leveling {state}", exact(s.mesh.fade)));
        }
    }
}

/// Says the line of a command that takes a number for each axis.
fn report_axes(to: &mut ReplyWriter<'_>, code: &'static str, values: [Number; 4]) {
    to.setting(text!("{}", SettingLine::of_axes(code, values)));
}

/// Where an axis can be: one number if it begins at 0.
struct Reach(Range<Mm>);

impl Display for Reach {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Range { least, most } = self.0;
        if least != Mm::ZERO {
            write!(f, "{}..", exact(least))?;
        }
        write!(f, "{}", exact(most))
    }
}

/// M503, the part that only a machine file sets, as comments: the reachable space, and how its axes are homed.
fn report_space(to: &mut ReplyWriter<'_>, s: &Settings) {
    to.remark(text!("machine: {}", s.name));
    let [x, y, z] = HomedAxis::ALL.map(|axis| Reach(s.reach(axis)));
    to.remark(text!("reachable: X{x} Y{y} Z{z} mm"));
    let Bed { width, depth, left, front, z_offset: _ } = s.bed;
    let (width, depth, left, front) = (exact(width), exact(depth), exact(left), exact(front));
    let Belt {
        is_closed,
        settling_ms,
        max_speed,
        max_acceleration,
        homing_advance,
        alignment,
        preload,
        phases,
        limp_lift,
    } = s.belt;
    let (alignment, preload) = (alignment.name(), exact(preload));
    to.remark(text!(
        "motors of one belt get power {settling_ms} ms apart; alignment {alignment}, preload {preload} mm"
    ));
    if limp_lift > Mm::ZERO {
        let lift = exact(limp_lift);
        to.remark(text!("if a motor of a belt fails, z is raised by {lift} mm and the tool parked"));
    } else {
        to.remark(text!("if a motor of a belt fails, all power is cut"));
    }
    for phase in phases.into_iter().filter(|phase| *phase < Belt::NO_PHASE) {
        to.remark(text!("aligned at a phase of {phase}/1024 of an electrical turn"));
    }
    if is_closed {
        let (speed, acceleration) = (shortest(max_speed), shortest(max_acceleration));
        let advance = exact(homing_advance);
        to.remark(text!(
            "closed belt: C up to {speed} mm/s, {acceleration} mm/s2; it runs on by {advance} mm after homing"
        ));
    }
    to.remark(text!("bed: {width} x {depth} mm from X{left} Y{front}"));
    report_pause(to, &s.pause);
    for axis in s.homing_order {
        let (homing, endstop) = (s.homing.of(axis), s.endstops.of(axis));
        let (fast, slow, back) = (shortest(homing.fast), shortest(homing.slow), exact(homing.back_off));
        let direction = match endstop.end {
            AxisEnd::Min => "down",
            AxisEnd::Max => "up",
        };
        if axis == HomedAxis::Z && s.homes_z_by_probe() {
            to.remark(text!("homing Z: by the probe"));
            continue;
        }
        let (axis, at) = (axis.letter(), exact(endstop.position));
        to.remark(text!("homing {axis}: {direction} to {at} mm, {fast} mm/s, {back} mm back, {slow} mm/s"));
    }
    report_z_home(to, s);
    to.remark(text!("serial lines: {} baud", s.baud));
    let needed = if s.require_homing { packed!("needed before moves") } else { packed!("not needed before moves") };
    to.remark(text!("homing is {needed}"));
}

/// M503, where Z is homed by its switch, and what comes before and after.
fn report_z_home(to: &mut ReplyWriter<'_>, s: &Settings) {
    let home = s.safe_z_home;
    for (axis, at) in ['X', 'Y'].into_iter().zip(home.place).filter(|_| s.homes_z_at_place()) {
        if let Some(at) = at {
            to.remark(text!("homing Z: at {axis}{}", exact(at)));
        }
    }
    if home.z_hop > Mm::ZERO {
        to.remark(text!("homing: Z rises to {} mm before and after", exact(home.z_hop)));
    }
    if home.move_to_previous {
        to.remark(text!("homing Z: X and Y return"));
    }
}

/// M503, the settings of a pause.
fn report_pause(to: &mut ReplyWriter<'_>, pause: &Pause) {
    let [retract, lift, x, y] = [pause.retract, pause.lift, pause.x, pause.y].map(exact);
    let [back, forth, travel] = [pause.retract_speed, pause.unretract_speed, pause.travel_speed].map(shortest);
    let minutes = pause.heat_off_min;
    to.remark(text!(
        "pause: {retract} mm of filament back at {back} mm/s, forth at {forth} mm/s, lift {lift} mm, \
         heat off after {minutes} min"
    ));
    if pause.park {
        to.remark(text!("pause: parked at X{x} Y{y}, {travel} mm/s"));
    } else {
        to.remark(text!("pause: not parked"));
    }
}

/// M503, the part of the drivers.
fn report_driver_settings(to: &mut ReplyWriter<'_>, s: &Settings) {
    let groups = s.drivers;
    // Marlin's heading; with it a BTT TFT requests M569.
    to.remark(text!("Driver stepping mode:"));
    for (group, axes) in [(groups.belt, "X Y"), (groups.z, "Z"), (groups.e, "E")] {
        to.setting(text!("M569 S{} {axes}", u8::from(group.stealth)));
    }
    for value in [DriverValue::Current, DriverValue::HybridThreshold, DriverValue::StallThreshold] {
        let [belt, z, e] = [groups.belt, groups.z, groups.e].map(|group| value.number(&group));
        report_axes(to, value.code(), [belt, belt, z, e]);
        report_own_values(to, value, s);
    }
}

/// M503, the values of single motors: as lines with I, or as comments where no line sets them.
fn report_own_values(to: &mut ReplyWriter<'_>, value: DriverValue, s: &Settings) {
    let code = value.code();
    for (motor, number) in value.of_motors(s) {
        let axis = s.mechanism.axis_of(motor).unwrap_or_default();
        let place = s.single_drivers(axis).iter().position(|single| single == motor);
        match (place, "XYZE".chars().nth(axis)) {
            (Some(place), Some(letter)) => to.setting(text!("{code} I{place} {letter}{number}")),
            _ => to.remark(text!("{code} of motor {}: {number}", s.name_of(motor))),
        }
    }
}

/// M503, a line of M593.
pub(in crate::machine) fn report_shaper(to: &mut ReplyWriter<'_>, axis: char, shaper: Shaper) {
    let (frequency, damping) = (shortest(shaper.frequency), shortest(shaper.damping));
    match SHAPERS.into_iter().position(|kind| kind == shaper.kind) {
        Some(number) => to.setting(text!("M593 {axis} F{frequency} D{damping} T{number}")),
        None => to.setting(text!("M593 {axis} F0")),
    }
}
