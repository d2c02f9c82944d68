//! The image under test, and how it is run.

use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use corehbot::storage::{LONGEST, record_of};
use corehbot::thermal::test_subject;
use corehbot::units::Watts;
use corehbot_emulator::clock_tree::Defect;
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::eeprom::At24c32;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::flash::FlashSectors;
use corehbot_emulator::heat_pins::Climate;
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::{Request, Seen, serve as serve_at};
use corehbot_emulator::sensor::Sensor;
use corehbot_emulator::terminal::Terminal;
use corehbot_emulator::watch::{Injection, Patience};
use corehbot_emulator::wiring::{NUCLEO, OCTOPUS, Pin, Wiring};
use corehbot_machine_file as machine_file;
use corehbot_sim::belt::BeltSetup;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::wiring_mistakes::Plugs;
use std::path::{Path, PathBuf};

/// A virtual millisecond in ns.
pub const MS: u64 = 1_000_000;

/// The image with the prototype in it.
pub fn firmware() -> Firmware {
    let mut firmware = plain_firmware();
    firmware.put_machine(&mut Settings::prototype()).expect("the image has a place for a machine");
    firmware
}

/// The image as it is built, without a machine: that `COREHBOT_ELF` names, or the one in the checkout's own target
/// directory.
pub fn plain_firmware() -> Firmware {
    image("COREHBOT_ELF", "corehbot-octopus")
}

/// The Nucleo's image: that `COREHBOT_NUCLEO_ELF` names, or the one in the checkout's own target directory.
pub fn nucleo_firmware() -> Firmware {
    image("COREHBOT_NUCLEO_ELF", "corehbot-nucleo")
}

fn image(variable: &str, name: &str) -> Firmware {
    let default = || root().join("target/thumbv7em-none-eabihf/firmware").join(name);
    let path = std::env::var_os(variable).map_or_else(default, PathBuf::from);
    Firmware::read(&path).unwrap_or_else(|e| panic!("build the image first or set {variable}: {e:#}"))
}

/// The checkout.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A file that sets the position to home in place of its homing, which takes eight seconds.
pub fn from_home(path: &Path) -> String {
    let gcode = std::fs::read_to_string(path).unwrap();
    let is_homing = |line: &&str| line.split(';').next().is_some_and(|command| command.trim() == "G28");
    let homing: Vec<_> = gcode.split_inclusive('\n').filter(is_homing).collect();
    let [homing] = homing[..] else { panic!("{} homes {} times", path.display(), homing.len()) };
    gcode.replacen(homing, "G92 X0 Y0 Z0\n", 1)
}

/// Prints `gcode` with the image, and with a fault if there is one.
pub fn print(firmware: &Firmware, gcode: &str, injection: Option<Injection>) -> Seen {
    serve(firmware, gcode, None, Manner::default(), injection)
}

/// Prints `gcode`, and `second` from the other serial port at the same time.
pub fn serve(
    firmware: &Firmware,
    gcode: &str,
    second: Option<&str>,
    manner: Manner,
    injection: Option<Injection>,
) -> Seen {
    print_on(firmware, gcode, &Bench { second, manner, injection, ..Bench::default() })
}

/// Drivers as new in all slots.
pub fn drivers() -> DriverLines {
    DriverLines::new(&OCTOPUS)
}

/// The surroundings of a board, where they differ from the usual ones.
pub struct Bench<'a> {
    /// The file that a host on the other serial port prints at the same time.
    pub second: Option<&'a str>,
    /// How hosts talk.
    pub manner: Manner,
    /// Where a real computer finds the USB port.
    pub network: Option<&'a str>,
    /// A fault.
    pub injection: Option<Injection>,
    /// The board, with its plugged-in parts.
    pub wiring: &'static Wiring,
    /// The motor drivers.
    pub drivers: DriverLines,
    /// The EEPROM.
    pub eeprom: At24c32,
    /// The sectors for settings, on a board that keeps them in flash.
    pub flash: FlashSectors,
    /// Voltages in mV on channels of ADC3.
    pub thermistors: &'a [(u8, u32)],
    /// Whether the heaters are yet to be tested.
    pub is_untested: bool,
    /// The machine: the image's own, or the one that `eeprom` has.
    pub settings: Settings,
    /// The thermal surroundings.
    pub climate: Climate,
    /// The heaters' true values, and their accidents.
    pub heat: HeatSetup,
    /// Mistakes of the wiring.
    pub plugs: Option<Plugs>,
    /// The belt, if the machine is not rigid.
    pub belt: Option<BeltSetup>,
    /// The rate of the slow oscillator in Hz.
    pub slow_oscillator: Option<u64>,
    /// Virtual time to continue after a reset, in ns.
    pub after_reset: u64,
    /// The accelerometer.
    pub sensor: Option<Sensor>,
    /// A pin that is held.
    pub stuck: Option<(Pin, bool)>,
    /// The defect of the clocks.
    pub defect: Defect,
    /// Virtual time after which it is given up, in ns.
    pub whole: u64,
    /// The test checks the broken rules for clocks itself.
    pub may_break_rules: bool,
}

impl Default for Bench<'_> {
    fn default() -> Self {
        Self {
            second: None,
            manner: Manner::default(),
            network: None,
            injection: None,
            wiring: &OCTOPUS,
            drivers: drivers(),
            eeprom: At24c32::default(),
            flash: FlashSectors::default(),
            thermistors: &[],
            is_untested: false,
            settings: Settings::prototype(),
            climate: Climate::default(),
            heat: HeatSetup::default(),
            plugs: None,
            belt: None,
            slow_oscillator: None,
            after_reset: 50 * MS,
            sensor: None,
            stuck: None,
            defect: Defect::None,
            whole: 7_200_000 * MS,
            may_break_rules: false,
        }
    }
}

/// A machine with a hotend of 60 W on HE0 and TH0 and a bed of 500 W on the bed's connectors. The part fan is FAN0, the
/// hotend's FAN1, the controller's FAN2.
pub fn heated() -> Settings {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    settings.thermal.heaters.hotend.power = Watts::const_from_int(60);
    settings
}

/// A board with that machine in its EEPROM.
pub fn heated_bench() -> Bench<'static> {
    bench_of(heated())
}

/// A board with a machine in its EEPROM.
pub fn bench_of(settings: Settings) -> Bench<'static> {
    let mut eeprom = Eeprom::blank();
    eeprom.save(&settings).unwrap();
    Bench { settings, eeprom: At24c32::holding(eeprom.cells().to_vec()), ..Bench::default() }
}

/// The lines that send a machine and have it stored.
pub fn lines_of(machine: &Settings) -> String {
    let mut record = [0; LONGEST];
    let length = record_of(machine, &mut record).unwrap();
    let pieces = record[..length].chunks(24).enumerate().map(|(n, piece)| {
        let hex: String = piece.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("MACHINE_PUT AT={} HEX={hex}\n", 24 * n)
    });
    pieces.chain(["MACHINE_STORE\n".to_owned()]).collect()
}

/// The prototype on the sockets of the Nucleo's shield.
pub fn nucleo_machine() -> Settings {
    let file = "board = \"nucleo\"\n[motors]\nm1 = \"X\"\nm4 = \"Y\"\nm8 = \"A\"\nm11 = \"Z\"\n\
                [endstops]\nx = \"X\"\ny = \"Y\"\nz = \"Z\"\n";
    machine_file::load(file).unwrap()
}

/// A Nucleo with its shield and nothing stored.
pub fn nucleo_bench() -> Bench<'static> {
    Bench { wiring: &NUCLEO, drivers: DriverLines::new(&NUCLEO), settings: nucleo_machine(), ..Bench::default() }
}

/// The subject of a self-test of this machine's heaters with this image.
pub fn self_test_subject(firmware: &Firmware, settings: &Settings) -> u32 {
    test_subject(&settings.thermal, firmware.sum().unwrap())
}

/// The EEPROM of a bench after a self-test that was passed, if the bench has heaters.
fn tested(firmware: &Firmware, bench: &Bench<'_>) -> At24c32 {
    if !bench.settings.thermal.has_heater() {
        return bench.eeprom.clone();
    }
    let mut eeprom = Eeprom::blank();
    eeprom.cells().copy_from_slice(&bench.eeprom.cells);
    eeprom.note_self_test(self_test_subject(firmware, &bench.settings)).unwrap();
    let mut tested = bench.eeprom.clone();
    tested.cells = eeprom.cells().to_vec();
    tested
}

/// Prints `gcode` on `bench`.
pub fn print_on(firmware: &Firmware, gcode: &str, bench: &Bench<'_>) -> Seen {
    talk_on(firmware, gcode, bench, None)
}

/// Prints `gcode` on `bench`, or is there for the host at a terminal.
pub fn talk_on(firmware: &Firmware, gcode: &str, bench: &Bench<'_>, terminal: Option<Terminal>) -> Seen {
    let patience = Patience { whole: bench.whole, silent: 10_000 * MS, after_reset: bench.after_reset };
    let eeprom = if bench.is_untested { bench.eeprom.clone() } else { tested(firmware, bench) };
    let request = Request {
        firmware,
        wiring: bench.wiring,
        settings: &bench.settings,
        gcode,
        second: bench.second,
        manner: bench.manner,
        network: bench.network,
        patience,
        injection: bench.injection,
        drivers: &bench.drivers,
        eeprom: &eeprom,
        flash: &bench.flash,
        thermistors: bench.thermistors,
        climate: bench.climate,
        heat: &bench.heat,
        plugs: bench.plugs.as_ref(),
        belt: bench.belt.as_ref(),
        slow_oscillator: bench.slow_oscillator,
        sensor: bench.sensor.as_ref(),
        stuck: bench.stuck,
        defect: bench.defect,
    };
    let seen = serve_at(&request, terminal).unwrap_or_else(|e| panic!("{e:#}"));
    let breaches: Vec<_> = seen.breaches.iter().map(ToString::to_string).collect();
    assert!(breaches.is_empty() || bench.may_break_rules, "rules for clocks:\n{}", breaches.join("\n"));
    assert_eq!(seen.usb_breaches, []);
    assert_eq!(seen.sensor_breaches, Vec::<&str>::new());
    seen
}
