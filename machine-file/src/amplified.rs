//! Temperature sensors behind a chip of their own, for thermocouples and PT100: no board reads these chips.

/// The chips, as Klipper and RepRapFirmware name them.
const CHIPS: [&str; 6] = ["MAX6675", "MAX31855", "MAX31856", "MAX31865", "AD595", "AD8495"];

/// Whether the name of a sensor has such a chip: `MAX31865`, `rtdmax31865`.
pub fn is_behind_a_chip(name: &str) -> bool {
    let name = name.to_ascii_uppercase();
    CHIPS.iter().any(|chip| name.contains(chip))
}

/// Says that no board reads one.
pub const ABSENT: &str = "no such sensor on this board";

/// What an owner of such a sensor has to do.
pub fn advice(path: &str) -> String {
    format!("{ABSENT}: connect a thermistor or a PT1000, and write it into {path}")
}
