//! The emulated board: an STM32F427 model in place of the F446, with the parts that the board connects to its pins.
//!
//! The F427 is the same family with more of everything; `unmodelled_accesses` lists the differences that are used.
//! [`Firmware`](crate::firmware::Firmware) makes sure that nothing is placed in memory that the F446 lacks.

use crate::cable::Plug;
use crate::chip::Chip;
use crate::clock_tree::Defect;
use crate::eeprom::At24c32;
use crate::flash::FlashSectors;
use crate::line::HostLine;
use crate::sensor::Sensor;
use crate::translation_cache;
use crate::usb_habits::UsbHabits;
use crate::usb_line::UsbLine;
use crate::usbip::UsbIp;
use crate::wiring::{HostPort, Load, PORTS, Pin, RAIL, ROOM, SettingsMemory, Wiring};
use anyhow::{Context, Result, ensure};
use rigless::cpu::armv7m::windows;
use rigless::device::Level;
use rigless::emulator::CoreSpec;
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::stm32f427::generated::gpioa::Register;
use rigless::soc::stm32f427::peripherals::spi::Select;
use rigless::soc::stm32f427::peripherals::{adc, gpio};
use rigless::time::VirtualNanos;
use std::collections::VecDeque;
use std::num::{NonZeroU32, NonZeroU64};

/// The core's clock: 180 MHz with over-drive.
const CLOCK_HZ: NonZeroU64 = NonZeroU64::new(180_000_000).unwrap();

/// Instructions a second of virtual time: 180 MHz at 1.39 cycles an instruction, measured over 20,000 step
/// interrupts with the cycle table of the Cortex-M4 manual. An assumption, no measurement on a board.
pub const INSTRUCTIONS_PER_SECOND: NonZeroU64 = NonZeroU64::new(129_500_000).unwrap();

/// The core's own timer runs on the core's clock over eight (PM0214 rev 10, section 4.5).
const SYSTICK_DIVIDER: NonZeroU32 = NonZeroU32::new(8).unwrap();

/// STM32F446: four priority bits (PM0214 rev 10, section 4.3).
const PRIORITY_BITS: u8 = 4;

/// Places of the converters of the thermistors (ADC3) and of the internal reference (ADC1).
const THERMISTORS: usize = 2;
const REFERENCE: usize = 0;

/// The place of SPI3.
const SENSOR_BUS: usize = 2;

/// The ports by the names that the crate has for them.
const GPIO_NAMES: [&str; PORTS] = ["GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG", "GPIOH"];

/// Full scale of a conversion, its reference: the inputs of ADC3 are given in these steps.
const FULL_SCALE: u32 = 4095;

/// JTDO and NJTRST, which belong to the debug port after a reset. Without a JTAG probe they are not driven; the chip
/// pulls up the second (RM0390 rev 6, section 7.3.1).
const JTAG: [Pin; 2] = [Pin::new('B', 3), Pin::new('B', 4)];

/// The chip's temperature in C.
pub const CHIP_CELSIUS: u8 = 40;

/// Address of the factory's readings of ADC1 at 3.3 V (STM32F446 datasheet, VREFIN_CAL, TS_CAL1 and TS_CAL2). A usual
/// chip has 1.21 V, and 0.76 V at 25 C with 2.5 mV/K more, read at 30 and at 110 C.
pub const FACTORY_WORDS: u64 = 0x1FFF_7A2A;
/// See [`FACTORY_WORDS`].
pub const FACTORY: [[u8; 2]; 3] = [1501_u16.to_le_bytes(), 958_u16.to_le_bytes(), 1207_u16.to_le_bytes()];

/// The board.
#[derive(Debug)]
pub struct Emulated {
    /// The chip.
    pub mcu: Chip,
    wiring: &'static Wiring,
}

/// The state of a port's outputs.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Port {
    /// Pins that are outputs, push-pull or not.
    pub outputs: u16,
    /// Pins that a peripheral of the chip drives.
    pub alternate: u16,
    /// The alternate pins that are driven high now, or will be before the next register write, as far as that is known.
    /// These are a heater's timer pin with a pulse in progress or to come, and every pin of another peripheral.
    pub live: u16,
    /// The output data register.
    pub data: u16,
}

impl Port {
    /// Pins driven high by the firmware.
    #[must_use]
    pub const fn high(self) -> u16 {
        self.outputs & self.data
    }

    /// Pins driven low by the firmware.
    #[must_use]
    pub const fn low(self) -> u16 {
        self.outputs & !self.data
    }
}

impl Emulated {
    /// A board out of reset with hosts on its serial ports, as many as there are, and its settings in `eeprom` on I2C1
    /// or in `flash`.
    ///
    /// # Errors
    /// If the model contradicts itself.
    pub fn new(wiring: &'static Wiring, hosts: Vec<HostLine>, eeprom: At24c32, flash: FlashSectors) -> Result<Self> {
        let mut mcu = Chip::new().context("the model of the chip")?;
        mcu.fit(wiring.hse.hz(), Defect::None);
        mcu.set_supply(RAIL);
        for converter in &mut mcu.adc {
            converter.set_reference(RAIL);
        }
        mcu.adc[THERMISTORS].set_reference(FULL_SCALE);
        mcu.adc[REFERENCE].set_temperature(i32::from(CHIP_CELSIUS) * 100);
        for (port, host) in wiring.host_ports.iter().zip(hosts) {
            let usart = &mut mcu.usart[port.place];
            host.damage(usart.errors_mut());
            usart.attach(host);
        }
        match wiring.settings {
            SettingsMemory::Eeprom => mcu.i2c[0].attach(eeprom),
            SettingsMemory::Flash => mcu.keep_settings(flash).context("the model of flash")?,
        }
        let mut board = Self { mcu, wiring };
        let cold: Vec<_> = wiring.thermistors.iter().map(|(_, channel)| (*channel, ROOM)).collect();
        board.heat(&cold)?;
        for &(pin, high) in wiring.resistors {
            board.drive(VirtualNanos(0), pin, high);
        }
        Ok(board)
    }

    /// Breaks something of the clocks.
    pub fn weaken(&mut self, defect: Defect) {
        self.mcu.fit(self.wiring.hse.hz(), defect);
    }

    /// Gives channels of ADC3 voltages in mV.
    ///
    /// # Errors
    /// If the channel is missing.
    pub fn heat(&mut self, channels: &[(u8, u32)]) -> Result<()> {
        for &(channel, millivolts) in channels {
            ensure!(adc::Channel::new(channel).is_some(), "no ADC channel {channel}");
            self.show(channel, millivolts * FULL_SCALE / RAIL);
        }
        Ok(())
    }

    /// Sets the next conversion result of a channel of ADC3, 0 to 4095.
    pub fn show(&mut self, channel: u8, reading: u32) {
        if let Some(channel) = adc::Channel::new(channel) {
            self.mcu.adc[THERMISTORS].set_input(channel, reading);
        }
    }

    /// Sets the converters' supply in mV. The thermistors share that supply, so only the internal reference shows it.
    pub fn set_analog_supply(&mut self, millivolts: u32) {
        self.mcu.adc[REFERENCE].set_reference(millivolts);
    }

    /// What the firmware drives on port `n` now.
    pub fn port(&mut self, n: usize) -> Port {
        let (_, registers) = self.mcu.port(n);
        let mode = registers.get(Register::Moder);
        let mut port = Port { data: registers.get(Register::Odr) as u16, ..Port::default() };
        for bit in 0..16 {
            match mode >> (2 * bit) & 3 {
                1 => port.outputs |= 1 << bit,
                2 => port.alternate |= 1 << bit,
                _ => {}
            }
        }
        port.live = port.alternate;
        for &(_, Load { pin, timer }) in self.wiring.heaters.iter().filter(|(_, load)| load.pin.port == n) {
            let function = self.function(pin);
            let is_idle = match timer {
                _ if function == 0 => JTAG.contains(&pin),
                Some((timer, channel)) if function == timer.function() => self.pulse(timer, channel).is_none(),
                _ => false,
            };
            if port.alternate & pin.mask() != 0 && is_idle {
                port.live &= !pin.mask();
            }
        }
        port
    }

    /// The pins of port `n` that are outputs or a peripheral's. Function 0 is the debug port's, as after a reset.
    pub fn driven(&mut self, n: usize) -> u16 {
        let port = self.port(n);
        let functions = (0..16).filter(|bit| self.function_of(n, *bit) != 0).fold(0, |pins, bit| pins | 1 << bit);
        port.outputs | port.alternate & functions
    }

    /// Whether the chip pulls `pin` up.
    pub fn is_pulled_up(&mut self, pin: Pin) -> bool {
        let (_, registers) = self.mcu.port(pin.port);
        registers.get(Register::Pupdr) >> (2 * pin.bit) & 3 == 1
    }

    /// The world drives `pin` from now on.
    pub fn drive(&mut self, at: VirtualNanos, pin: Pin, high: bool) {
        self.put(at, pin, Some(high));
    }

    /// The world drives `pin`, or lets go of it.
    pub fn put(&mut self, at: VirtualNanos, pin: Pin, high: Option<bool>) {
        let level = high.map(|high| if high { Level::High } else { Level::Low });
        if let Some(bit) = gpio::Pin::new(pin.bit) {
            self.mcu.drive_port(at, pin.port, |gpio, registers, context| {
                gpio.drive(bit, level, registers, context);
            });
        }
    }

    /// Plugs an accelerometer into the board's connector for one.
    ///
    /// # Errors
    /// If there is no such connector.
    pub fn plug_sensor(&mut self, sensor: Sensor) -> Result<()> {
        let pins = self.wiring.sensor.context("this board has no connector for an accelerometer")?;
        let pin = gpio::Pin::new(pins.select.bit).context("a port has 16 pins")?;
        let port = GPIO_NAMES[pins.select.port];
        self.mcu.spi[SENSOR_BUS].attach_selected(sensor, Select { port, pin, active: Level::Low });
        Ok(())
    }

    /// The accelerometer.
    pub fn sensor(&mut self) -> Option<&mut Sensor> {
        self.mcu.spi[SENSOR_BUS].chip_mut::<Sensor>(0)
    }

    /// The EEPROM.
    pub fn eeprom(&mut self) -> Option<&mut At24c32> {
        self.mcu.i2c[0].chip_mut::<At24c32>(0)
    }

    /// Clock of the bus that `port` is on.
    pub fn bus_hz(&mut self, port: &HostPort) -> u64 {
        let [_, apb1, apb2] = self.mcu.rates();
        if port.is_on_apb2 { apb2 } else { apb1 }
    }

    /// Plugs the USB cable of a computer in, which has one conversation after the other.
    pub fn plug(&mut self, habits: UsbHabits, conversations: VecDeque<HostLine>) {
        self.mcu.usb.cable = UsbLine::new(habits, conversations).map(|line| Plug::Line(Box::new(line)));
    }

    /// Lets a real computer plug itself in by USB/IP at this address.
    ///
    /// # Errors
    /// If the address is taken.
    pub fn plug_network(&mut self, address: &str) -> Result<()> {
        let network = UsbIp::listen(address).with_context(|| format!("USB/IP at {address}"))?;
        self.mcu.usb.cable = Some(Plug::Network(Box::new(network)));
        Ok(())
    }

    /// The cable to a real computer.
    #[must_use]
    pub fn network(&self) -> Option<&UsbIp> {
        match &self.mcu.usb.cable {
            Some(Plug::Network(network)) => Some(network),
            Some(Plug::Line(_)) | None => None,
        }
    }

    /// The far ends of the ports that have one, USB first.
    pub fn hosts(&mut self) -> impl Iterator<Item = &mut HostLine> {
        // In the order of the wiring, which differs from the chip's order.
        let (on_usb, usarts) = self.mcu.lines();
        let mut hosts: Vec<_> = usarts.iter_mut().map(|usart| usart.chip_mut::<HostLine>()).collect();
        on_usb.into_iter().chain(self.wiring.host_ports.iter().filter_map(move |port| hosts[port.place].take()))
    }
}

impl Store for Emulated {}

/// The core as the board runs it.
fn core(mcu: &Chip) -> CoreSpec {
    let lines = u32::from(mcu.cpu().interrupt_lines);
    let core = armv7m::Core {
        variant: armv7m::Variant::M4,
        clock_hz: CLOCK_HZ,
        interrupt_lines: NonZeroU32::new(lines).unwrap_or(NonZeroU32::MIN),
        priority_bits: PRIORITY_BITS,
        refclk_divider: SYSTICK_DIVIDER,
        instructions_per_second: INSTRUCTIONS_PER_SECOND,
        boot: "flash",
    };
    let mut spec = core.spec_with_parts(&windows(mcu.bus()), armv7m::Fpu::FpV4Sp, armv7m::MpuRegions::Eight);
    translation_cache::share_translations(&mut spec);
    spec
}

impl Board for Emulated {
    fn name(&self) -> &'static str {
        self.wiring.name
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let core = core(&self.mcu);
        vec![Target::new("stm32f446", &mut self.mcu, core)]
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec!["stm32f446"]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.mcu)
    }
}
