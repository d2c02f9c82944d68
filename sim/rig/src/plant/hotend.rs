//! The hotend: three lumps of heat, and the flows between them.
//!
//! Heat that leaves one lump enters another in the same step, so no energy is lost or made by the arithmetic.

use super::constants::HotendConstants;

/// The inputs of a hotend.
pub(super) struct HotendLoad {
    pub watt: f64,
    pub flow_mm3_s: f64,
    /// 0..=1.
    pub part_fan: f64,
    /// 0..=1.
    pub hotend_fan: f64,
    pub ambient_celsius: f64,
    /// So many times as much goes to the air.
    pub draught: f64,
    /// The part of the cartridge's contact with the block that is left.
    pub contact: f64,
}

/// Its temperatures, C.
pub(super) struct Hotend {
    pub cartridge: f64,
    pub block: f64,
    pub sink: f64,
}

impl Hotend {
    /// In a steady state with the block at `celsius`, the hotend fan on and the part fan off.
    pub(super) fn at(c: &HotendConstants, celsius: f64, ambient: f64) -> Self {
        let above = celsius - ambient;
        let sink_to_air = c.sink_to_air_watt_per_kelvin + c.hotend_fan_watt_per_kelvin;
        let sink = above * c.block_to_sink_watt_per_kelvin / (c.block_to_sink_watt_per_kelvin + sink_to_air);
        let to_air = c.block_to_air_watt_per_kelvin + c.block_to_air_rise_watt_per_kelvin_sq * above.max(0.0);
        let watt = to_air * above + c.block_to_sink_watt_per_kelvin * (above - sink);
        Self { cartridge: celsius + watt / c.cartridge_to_block_watt_per_kelvin, block: celsius, sink: ambient + sink }
    }

    /// One explicit Euler step; short against the shortest time constant, which is the cartridge's second.
    pub(super) fn step(&mut self, c: &HotendConstants, load: &HotendLoad, seconds: f64) {
        let above = self.block - load.ambient_celsius;
        let still = c.block_to_air_watt_per_kelvin + c.block_to_air_rise_watt_per_kelvin_sq * above.max(0.0);
        let to_air = still * load.draught + c.part_fan_watt_per_kelvin * load.part_fan;
        let filament = c.filament_joule_per_mm3_kelvin * load.flow_mm3_s.max(0.0);
        let sink_to_air = c.sink_to_air_watt_per_kelvin + c.hotend_fan_watt_per_kelvin * load.hotend_fan;

        let into_block = c.cartridge_to_block_watt_per_kelvin * load.contact * (self.cartridge - self.block);
        let into_sink = c.block_to_sink_watt_per_kelvin * (self.block - self.sink);
        let out_of_block = (to_air + filament) * above;
        let out_of_sink = sink_to_air * (self.sink - load.ambient_celsius);

        self.cartridge += seconds * (load.watt - into_block) / c.cartridge_joule_per_kelvin;
        self.block += seconds * (into_block - into_sink - out_of_block) / c.block_joule_per_kelvin;
        self.sink += seconds * (into_sink - out_of_sink) / c.sink_joule_per_kelvin;
    }
}
