//! A heater: its output, its sensor, its model, and the limits of normal behaviour.

use super::Thermistor;
use crate::connectors::{Output, Sensor};
use crate::settings::ranges;
use crate::settings::rows::{Choice, Spec, ValueKind, numbers, rows};
use crate::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use serde::{Deserialize, Serialize};

/// The model of a heater: M303 measures it and M306 sets it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct HeaterModel {
    /// Heat that it takes to warm it.
    pub capacity: JoulesPerKelvin,
    /// Heat that it loses to the room.
    pub loss: WattsPerKelvin,
    /// Heat that it loses in addition with the part fan at full speed.
    pub fan_loss: WattsPerKelvin,
    /// Time constant from the heating element to the thing heated.
    pub heater_lag: Seconds,
    /// Time constant from the thing heated to the sensor's reading.
    pub sensor_lag: Seconds,
    /// How its resistance grows with temperature, in 1/K: a PTC heater has less power when it is hot. 0 for others.
    pub ptc: Ratio,
}

/// The temperature at which a PTC heater has its nominal power.
const NOMINAL: Celsius = Celsius::const_from_int(25);

impl HeaterModel {
    /// From the heating element to the sensor's reading.
    #[must_use]
    pub const fn lag(&self) -> Seconds {
        self.heater_lag.saturating_add(self.sensor_lag)
    }

    /// The part of its nominal power that it has at a temperature: 1 / (1 + ptc (T - 25 C)).
    #[must_use]
    pub fn power_left(&self, at: Celsius) -> Ratio {
        if self.ptc == Ratio::ZERO {
            return Ratio::ONE;
        }
        let grown = i64::from(self.ptc.to_bits()) * i64::from(at.saturating_sub(NOMINAL).to_bits());
        // Legal values and readings keep it above a half.
        let resistance = ((1 << Ratio::FRAC_NBITS) + (grown >> Celsius::FRAC_NBITS)).max(1 << 15);
        Ratio::from_bits((1 << 31) / (u32::try_from(resistance).unwrap_or(u32::MAX) >> 1).max(1))
    }
}

/// A PID controller in Marlin's terms: its output is a duty of 0 to 255.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Pid {
    /// Duty a K.
    pub p: Ratio,
    /// Duty a K and second.
    pub i: Ratio,
    /// Duty for each K/s.
    pub d: Ratio,
}

/// How the power is found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum Control {
    /// From the model, which looks ahead.
    Model,
    /// By PID.
    Pid,
}

/// When a heater's behaviour is a fault. No value switches a guard off.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Guards {
    /// It has to warm up by at least this part of its model's prediction.
    pub heating: Ratio,
    /// This far from its target, once reached, ...
    pub lost: Celsius,
    /// ... for so long, in s.
    pub lost_s: u8,
    /// Rise while it is off.
    pub off_rise: Celsius,
    /// This far above its target without power.
    pub overshoot: Celsius,
}

/// A heater.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct HeaterSettings {
    /// Whether there is one.
    pub is_fitted: bool,
    /// Its output.
    pub output: Output,
    /// Its sensor.
    pub sensor: Sensor,
    /// The sensor's kind.
    pub thermistor: Thermistor,
    /// The highest target.
    pub most: Celsius,
    /// Power at full duty and nominal voltage.
    pub power: Watts,
    /// The highest duty.
    pub max_duty: Ratio,
    /// Period of its switching in ms, for relays; 0 is the fast pulse-width modulation of the board.
    pub period_ms: u16,
    /// How the power is found.
    pub control: Control,
    /// Its model.
    pub model: HeaterModel,
    /// The gains for PID control.
    pub pid: Pid,
    /// The limits of its guards.
    pub guards: Guards,
}

impl HeaterSettings {
    /// A hotend with a block of aluminium and a cartridge of 40 W.
    #[must_use]
    pub const fn hotend(output: Output, sensor: Sensor) -> Self {
        Self {
            is_fitted: false,
            output,
            sensor,
            thermistor: Thermistor::SEMITEC_104GT2,
            most: Celsius::const_from_int(285),
            power: Watts::const_from_int(40),
            max_duty: Ratio::ONE,
            period_ms: 0,
            control: Control::Model,
            model: HeaterModel {
                capacity: const { JoulesPerKelvin::lit("10.8") },
                loss: const { WattsPerKelvin::lit("0.075") },
                fan_loss: const { WattsPerKelvin::lit("0.05") },
                heater_lag: const { Seconds::lit("1.2") },
                sensor_lag: const { Seconds::lit("1.2") },
                ptc: Ratio::ZERO,
            },
            pid: Pid {
                p: const { Ratio::lit("22.2") },
                i: const { Ratio::lit("1.08") },
                d: Ratio::const_from_int(114),
            },
            guards: Guards::hotend(),
        }
    }

    /// A plate of aluminium of 430 x 400 x 4 mm with a mat of 500 W.
    #[must_use]
    pub const fn bed(output: Output, sensor: Sensor) -> Self {
        Self {
            is_fitted: false,
            output,
            sensor,
            thermistor: Thermistor::NTC_3950,
            most: Celsius::const_from_int(120),
            power: Watts::const_from_int(500),
            max_duty: Ratio::ONE,
            period_ms: 1000,
            control: Control::Model,
            model: HeaterModel {
                capacity: JoulesPerKelvin::const_from_int(1700),
                loss: const { WattsPerKelvin::lit("3.5") },
                fan_loss: WattsPerKelvin::ZERO,
                heater_lag: Seconds::const_from_int(10),
                sensor_lag: Seconds::const_from_int(5),
                ptc: Ratio::ZERO,
            },
            pid: Pid { p: Ratio::const_from_int(120), i: Ratio::const_from_int(1), d: Ratio::const_from_int(600) },
            guards: Guards::bed(),
        }
    }

    /// A chamber with a heater of 300 W that blows.
    #[must_use]
    pub const fn chamber(output: Output, sensor: Sensor) -> Self {
        Self {
            most: Celsius::const_from_int(70),
            power: Watts::const_from_int(300),
            model: HeaterModel {
                capacity: JoulesPerKelvin::const_from_int(6000),
                loss: WattsPerKelvin::const_from_int(5),
                fan_loss: WattsPerKelvin::ZERO,
                heater_lag: Seconds::const_from_int(20),
                sensor_lag: Seconds::const_from_int(20),
                ptc: Ratio::ZERO,
            },
            ..Self::bed(output, sensor)
        }
    }

    /// The highest legal reading: far enough above the highest target that a small overshoot is no fault (Marlin's
    /// HOTEND_OVERSHOOT is 15 C).
    #[must_use]
    pub const fn too_hot(&self) -> Celsius {
        self.most.saturating_add(Celsius::const_from_int(15))
    }
}

impl Guards {
    /// For a hotend: lost by 10 C for 5 s, where RepRapFirmware has 15 C for 5 s.
    #[must_use]
    pub const fn hotend() -> Self {
        Self {
            // 18 V instead of 24 give 0.56 of the power, and a model may be off by 0.7.
            heating: const { Ratio::lit("0.35") },
            lost: Celsius::const_from_int(10),
            lost_s: 5,
            off_rise: Celsius::const_from_int(8),
            overshoot: Celsius::const_from_int(20),
        }
    }

    /// For a bed, which is slower and may cool through an open door: lost by 10 C for 20 s as with Prusa.
    #[must_use]
    pub const fn bed() -> Self {
        Self {
            lost_s: 20,
            off_rise: Celsius::const_from_int(5),
            overshoot: Celsius::const_from_int(15),
            ..Self::hotend()
        }
    }
}

impl Choice for Output {
    const ALL: &'static [(Self, &'static str)] = &Self::ALL;

    numbers!(Bed He0 He1 He2 He3);
}

impl Choice for Sensor {
    const ALL: &'static [(Self, &'static str)] = &Self::ALL;

    numbers!(Bed Hotend0 Hotend1 Hotend2 Hotend3);
}

impl Choice for Control {
    const ALL: &'static [(Self, &'static str)] = &[(Self::Model, "model"), (Self::Pid, "pid")];

    numbers!(Model Pid);
}

rows! {
    for heater in |s, part| s.thermal.heaters.get_mut(part),
        named &["heaters.hotend", "heaters.bed", "heaters.chamber"];

    /// Whether the machine has it.
    70 "is_fitted" = &mut heater.is_fitted, "", [Spec::SWITCH];
    /// The output that it is connected to.
    71 "output" = &mut heater.output, "", [Spec::choice::<Output>()];
    /// The input of its temperature sensor.
    72 "sensor" = &mut heater.sensor, "", [Spec::choice::<Sensor>()];
    /// The kind of sensor; or an NTC by three points (C, Ohm), or by Ohm at 25 C, B in K and a cubic term.
    73 "thermistor" = &mut heater.thermistor, "", [Spec::packed((1 << 47) - 1, ValueKind::Thermistor).from_zero()];
    /// Highest target.
    74 "most" = &mut heater.most, "C", [ranges::HOTEND.spec(), ranges::BED.spec(), ranges::BED.spec()];
    /// Power at full duty.
    75 "power" = &mut heater.power, "W", [ranges::POWER.spec()];
    /// Highest duty, of 1.
    76 "max_duty" = &mut heater.max_duty, "", [ranges::MAX_DUTY.spec()];
    /// Period of a relay; 0 is the board's own modulation.
    77 "period_ms" = &mut heater.period_ms, "ms", [ranges::RELAY_MS.spec()];
    /// Whether its model or PID finds the power.
    78 "control" = &mut heater.control, "", [Spec::choice::<Control>()];
    /// Heat capacity (M306 C). M303 finds out the model.
    79 "model.capacity" = &mut heater.model.capacity, "J/K", [ranges::CAPACITY.spec()];
    /// Heat lost to the room (M306 A).
    80 "model.loss" = &mut heater.model.loss, "W/K", [ranges::LOSS.spec()];
    /// Heat lost in addition with the part fan at full speed (M306 F).
    81 "model.fan_loss" = &mut heater.model.fan_loss, "W/K", [ranges::LOSS.spec().from_zero()];
    /// Time constant from the heating element to the heated part (M306 L).
    82 "model.heater_lag" = &mut heater.model.heater_lag, "s", [ranges::LAG.spec()];
    /// Time constant from the heated part to the sensor's reading (M306 R).
    83 "model.sensor_lag" = &mut heater.model.sensor_lag, "s", [ranges::LAG.spec()];
    /// Duty of 255 for each K.
    84 "pid.p" = &mut heater.pid.p, "1/K", [ranges::GAIN.spec()], "M301" "P", "M304" "P";
    /// Duty of 255 for each K and second.
    85 "pid.i" = &mut heater.pid.i, "1/(K s)", [ranges::GAIN.spec()], "M301" "I", "M304" "I";
    /// Duty of 255 for each K/s.
    86 "pid.d" = &mut heater.pid.d, "s/K", [ranges::GAIN.spec()], "M301" "D", "M304" "D";
    /// It has to warm up by at least this part of the warming that its model predicts.
    87 "guards.heating" = &mut heater.guards.heating, "", [ranges::HEATING.spec()];
    /// A reached target is lost when the temperature is so far from it for lost_s.
    88 "guards.lost" = &mut heater.guards.lost, "K", [ranges::LOST.spec()];
    /// Time for which a reached target may be missed by more than lost.
    89 "guards.lost_s" = &mut heater.guards.lost_s, "s", [ranges::LOST_S.spec()];
    /// Rise without power that is a fault.
    90 "guards.off_rise" = &mut heater.guards.off_rise, "K", [ranges::OFF_RISE.spec()];
    /// Overshoot without power that is a fault.
    91 "guards.overshoot" = &mut heater.guards.overshoot, "K", [ranges::OVERSHOOT.spec()];
    /// Growth of its resistance for each K, from its power at 25 C on: a PTC heater has some 0.002 to 0.0045 (M306 K).
    159 "model.ptc" = &mut heater.model.ptc, "1/K", [ranges::PTC.spec()];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ptc_heater_has_less_power_when_it_is_hot() {
        let model = HeaterSettings::hotend(Output::He0, Sensor::Hotend0).model;
        assert_eq!(model.power_left(Celsius::const_from_int(250)), Ratio::ONE);
        let ptc = HeaterModel { ptc: Ratio::lit("0.004"), ..model };
        for (celsius, left) in [(25, 1.0), (225, 1.0 / 1.8), (150, 1.0 / 1.5), (-15, 1.0 / 0.84)] {
            let found = ptc.power_left(Celsius::const_from_int(celsius)).to_num::<f64>();
            assert!((found / left - 1.0).abs() < 0.003, "{celsius} C: {found}");
        }
        let steepest = HeaterModel { ptc: ranges::PTC.most, ..model };
        assert_eq!(steepest.power_left(Celsius::MIN), Ratio::const_from_int(2));
        assert!(steepest.power_left(Celsius::MAX) > Ratio::ZERO);
    }
}
