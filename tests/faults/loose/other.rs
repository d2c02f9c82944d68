//! A second plant for guards of heat, with equations of its own: five masses of a hotend, natural convection,
//! radiation, a bead with wires that cool it, and a converter with another noise. Nothing of it is the simulator's.

use super::machine::{Breaks, Outside, Spec};
use corehbot::connectors::{FANS, OUTPUTS, Output, OutputSet, Sensor};
use corehbot::port::ThermalPort;
use std::cell::RefCell;
use std::rc::Rc;

/// Stefan and Boltzmann, W/(m2 K4).
const SIGMA: f64 = 5.67e-8;

/// A part of a step, s.
const PART: f64 = 0.005;

/// Temperatures of the hotend in C: cartridge, block, nozzle, bead, sink.
type Hotend = [f64; 5];

/// The plant.
pub struct Other {
    spec: Spec,
    pub outside: Outside,
    pub hotend: Hotend,
    /// Mat and plate of the bed.
    bed: [f64; 2],
    breaks: Option<(Breaks, f64)>,
    pub duties: [f64; OUTPUTS],
    pub fan: f64,
    pub is_supplied: bool,
    random: u64,
}

impl Other {
    pub fn new(spec: &Spec) -> Self {
        Self {
            spec: *spec,
            outside: Outside { room: spec.room, ..Outside::USUAL },
            hotend: [spec.room; 5],
            bed: [spec.room; 2],
            breaks: None,
            duties: [0.0; OUTPUTS],
            fan: 0.0,
            is_supplied: true,
            random: spec.seed | 1,
        }
    }

    pub const fn break_it(&mut self, breaks: Breaks) {
        self.breaks = Some((breaks, 0.0));
    }

    /// The bead's conductances to the block and to the room, W/K.
    fn seat(&self) -> [f64; 2] {
        let block = 0.3 / self.spec.sensor_lag;
        let share = match self.breaks {
            Some((Breaks::SensorLeaves { share, seconds }, since)) => 1.0 - (1.0 - share) * (since / seconds).min(1.0),
            _ => 0.997,
        };
        [block * share, block * (1.0 - share)]
    }

    /// Changes of the hotend's temperatures, K/s.
    fn slopes(&self, t: &Hotend, watt: f64, flow: f64) -> Hotend {
        let Spec { cartridge, block, nozzle, loss, fan_loss, heater_lag, .. } = self.spec;
        let [e, b, n, s, k] = *t;
        let room = self.outside.room;
        let kelvin = |celsius: f64| celsius + 273.15;
        // At 190 K above the room: 55 % goes into the air, 20 % is radiated, 25 % goes up the throat.
        let air = 0.55 * loss / 190_f64.powf(0.25) * self.outside.draught;
        let area = 0.2 * loss * 190.0 / (SIGMA * (kelvin(215.0).powi(4) - kelvin(25.0).powi(4)));
        let above = b - room;
        let convected = air * above.abs().powf(1.25) * above.signum();
        let radiated = SIGMA * area * (kelvin(b).powi(4) - kelvin(room).powi(4));
        let blown = fan_loss * self.fan.sqrt() * above;
        let contact =
            if matches!(self.breaks, Some((Breaks::CartridgeOut, _))) { 0.05 } else { cartridge / heater_lag };
        let into_block = contact * (e - b);
        let into_nozzle = 1.2 * (b - n);
        let into_sink = 0.25 * loss * (b - k);
        let [to_bead, to_wires] = self.seat();
        let into_bead = to_bead * (b - s);
        let melted = 0.0023 * flow * (n - room);
        [
            (watt - into_block - SIGMA * 6e-4 * (kelvin(e).powi(4) - kelvin(b).powi(4)).max(0.0)) / cartridge,
            (into_block - into_nozzle - into_sink - into_bead - convected - radiated - blown) / block,
            (into_nozzle - melted - 0.004 * (n - room)) / nozzle,
            (into_bead - to_wires * (s - room)) / 0.3,
            (into_sink - 0.4 * (k - room)) / 20.0,
        ]
    }

    /// Time passes.
    pub fn step(&mut self, flow: f64, seconds: f64) {
        if let Some((_, since)) = &mut self.breaks {
            *since += seconds;
        }
        let [mut hotend, mut bed] = [Output::He0, Output::Bed].map(|output| self.duties[output as usize]);
        match self.breaks {
            Some((Breaks::Leak(part), _)) => hotend = hotend.max(part),
            Some((Breaks::Power(part), _)) => hotend *= part,
            Some((Breaks::BedPower(part), _)) => bed *= part,
            _ => {}
        }
        if !self.is_supplied {
            (hotend, bed) = (0.0, 0.0);
        }
        let watt = hotend * self.spec.watt * self.outside.supply;
        let parts = (seconds / PART).round() as u32;
        for _ in 0..parts {
            // The midpoint rule.
            let first = self.slopes(&self.hotend, watt, flow);
            let middle: Hotend = std::array::from_fn(|n| self.hotend[n] + first[n] * PART / 2.0);
            let second = self.slopes(&middle, watt, flow);
            for (celsius, slope) in self.hotend.iter_mut().zip(second) {
                *celsius += slope * PART;
            }
            let [mat, plate] = self.bed;
            let above = plate - self.outside.room;
            let up = 45.0 * (mat - plate);
            self.bed[0] += (500.0 * bed - up) / 220.0 * PART;
            let air = 1.4 * self.spec.bed_loss;
            self.bed[1] += (up - air * above.abs().powf(1.2) * above.signum()) / (1480.0 * self.spec.bed_mass) * PART;
        }
    }

    /// Numbers from 0 to 1 (xorshift).
    fn uniform(&mut self) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Sixteen conversions of 12 bits, of an NTC under 4.7 kOhm.
    fn convert(&mut self, ohm: f64) -> u16 {
        let share = ohm / (ohm + 4700.0);
        let mut sum = 0;
        for _ in 0..8 {
            // Box and Muller give two.
            let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * self.spec.noise;
            let angle = std::f64::consts::TAU * self.uniform();
            for noise in [radius * angle.cos(), radius * angle.sin()] {
                sum += (share * 4096.0 + noise).round().clamp(0.0, 4095.0) as u16;
            }
        }
        sum
    }
}

/// 104-GT2 through the three points of its sheet (25 C, 150 C, 250 C), by divided differences of 1/T over ln R.
fn semitec(celsius: f64) -> f64 {
    let points = [(25.0, 100_000.0_f64), (150.0, 1641.9), (250.0, 226.15)];
    let [a, b, c] = points.map(|(celsius, ohm): (f64, f64)| (ohm.ln(), 1.0 / (celsius + 273.15)));
    let cubic = |x: f64| x.powi(3);
    let (u, v) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - a.1) / (c.0 - a.0));
    let third = (v - u) / ((cubic(c.0) - cubic(a.0)) / (c.0 - a.0) - (cubic(b.0) - cubic(a.0)) / (b.0 - a.0));
    let second = u - third * (cubic(b.0) - cubic(a.0)) / (b.0 - a.0);
    let first = a.1 - second * a.0 - third * cubic(a.0);
    let wanted = 1.0 / (celsius + 273.15);
    // Newton: 1/T grows with ln R.
    let mut x = b.0;
    for _ in 0..30 {
        let value = first + second * x + third * cubic(x);
        x -= (value - wanted) / (second + 3.0 * third * x * x);
    }
    x.exp()
}

/// The firmware's port to it.
pub struct OtherPort(pub Rc<RefCell<Other>>);

impl ThermalPort for OtherPort {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        let mut plant = self.0.borrow_mut();
        let [bead, plate] = [plant.hotend[3], plant.bed[1]];
        match sensor {
            Sensor::Hotend0 => {
                let series = match plant.breaks {
                    Some((Breaks::Series { ohm, seconds }, since)) => ohm * (since / seconds).min(1.0),
                    _ => 0.0,
                };
                Some(plant.convert(semitec(bead) + series))
            }
            Sensor::Bed => {
                let plate = match plant.breaks {
                    Some((Breaks::BedSensorLeaves { share, seconds }, since)) => {
                        plate - (1.0 - share) * (since / seconds).min(1.0) * (plate - plant.outside.room)
                    }
                    _ => plate,
                };
                let ohm = 100_000.0 * (3950.0 * (1.0 / (plate + 273.15) - 1.0 / 298.15)).exp();
                Some(plant.convert(ohm))
            }
            _ => None,
        }
    }

    fn outputs(&self) -> OutputSet {
        OutputSet::NONE.with(Output::Bed).with(Output::He0)
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.0.borrow_mut().duties = duties.map(|duty| f64::from(duty) / 65_535.0);
    }

    fn fans(&self) -> usize {
        FANS
    }

    fn set_fan(&mut self, fan: usize, duty: u16) {
        if fan == 0 {
            self.0.borrow_mut().fan = f64::from(duty) / 65_535.0;
        }
    }

    fn has_supply_switch(&self) -> bool {
        true
    }

    fn switch_supply(&mut self, on: bool) {
        self.0.borrow_mut().is_supplied = on;
    }
}
