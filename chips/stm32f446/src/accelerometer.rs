//! The accelerometer on SPI3: set up by the Console, fetched by DMA and two interrupts.
//!
//! [`accelerometer`](corehbot_board_support::accelerometer) has the sensors. This file carries their bytes:
//!
//! | context | does |
//! |---|---|
//! | Console, at the start | some 20 transfers of two bytes, 0.3 ms in all, while all else runs on |
//! | TIM6, every millisecond | begins the transfer of the sensor's status |
//! | DMA1 stream 0, at the end of a transfer | keeps the sample, begins the next transfer |
//! | Console | takes the samples from the queue |
//!
//! Both interrupts are below the step interrupt. At 3200 samples a second they come 5200 times, so they take some 1 %
//! of the processor. A sensor's FIFO holds 10 ms of samples, and the queue 40 ms.
//!
//! **Clock.** 1.4 MHz. An ADXL345 allows 5 MHz. Up to 1.6 MHz its FIFO needs no wait between two samples (datasheet rev
//! E, FIFO: retrieving data from the FIFO), and a long cable carries the clock better. A sample takes 51 us. The
//! clock's pin has the steepest edges. Slow edges would lose the last bit of a byte at this bus clock (errata of the
//! SPI: corrupted last bit of data, received in master mode with delayed SCK feedback).

use core::ops::Range;
use core::sync::atomic::{AtomicU8, Ordering, compiler_fence};

use corehbot::accelerometer::{Sample, SensorFault, SensorKind};
use corehbot::port::Accelerometer;
use corehbot_board_support::accelerometer::{self, Bytes, LONGEST, Raw, Reader, TIMER_HZ, Transfer, Wire, scaled};
use corehbot_cortex_m4::{Handover, finish_stores};
use embassy_stm32::interrupt;
use embassy_stm32::pac::dma::St;
use embassy_stm32::pac::dma::regs::Ixr;
use embassy_stm32::pac::dma::vals::{Dir, Size};
use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Mstr};
use embassy_stm32::pac::{DMA1, Interrupt, RCC, SPI3, TIM6};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use crate::interrupt_storm::{CallRate, count_call};
use crate::ports::{self, Speed};
use crate::resources::{SENSOR_INPUT, SENSOR_OUTPUT, SPI_FUNCTION};
use crate::wiring::SensorPins;

/// Counts of TIM6 in a timer event: of 90 MHz (RM0390, 6.2: clocks of the timers) over 90.
const PRESCALER: u16 = 90 - 1;
const LAST: u16 = (1_000_000 / TIMER_HZ) as u16 - 1;

/// Samples that wait for the Console: 40 ms at 3200 a second.
const WAITING: usize = 128;

/// Looks at a flag that comes within 12 us, each of some 10 cycles at least: a margin of ten.
const LOOKS: usize = 2000;

/// The bytes of the transfer under way. The DMA reads the ones and writes the others.
static SENT: [AtomicU8; LONGEST] = [const { AtomicU8::new(0) }; LONGEST];
static HEARD: [AtomicU8; LONGEST] = [const { AtomicU8::new(0) }; LONGEST];

/// Where the DMA reads and writes.
pub fn buffers() -> [Range<u32>; 2] {
    [&SENT, &HEARD].map(|bytes| bytes.as_ptr() as u32..bytes.as_ptr() as u32 + LONGEST as u32)
}

static SAMPLES: ConstStaticCell<Queue<Raw, WAITING>> = ConstStaticCell::new(Queue::new());

static ENGINE: Handover<Engine> = Handover::new();

/// The interrupts' end.
struct Engine {
    pins: SensorPins,
    reader: Option<Reader>,
    /// Why there is no reader.
    fault: SensorFault,
    samples: Producer<'static, Raw>,
}

/// The Console's end.
pub struct SpiSensor {
    pins: Option<SensorPins>,
    kind: SensorKind,
    samples: Option<Consumer<'static, Raw>>,
}

impl SpiSensor {
    /// The sensor at the board's connector, if it has one. No pin is driven before the sensor is used.
    pub fn new(pins: Option<SensorPins>) -> Self {
        let samples = pins.map(|pins| {
            let (producer, consumer) = SAMPLES.take().split();
            ENGINE.fill(Engine { pins, reader: None, fault: SensorFault::Silent, samples: producer });
            consumer
        });
        Self { pins, kind: SensorKind::Adxl345, samples }
    }
}

impl Accelerometer for SpiSensor {
    fn start(&mut self, kind: SensorKind, rate: u16) {
        let (Some(pins), Some(samples)) = (self.pins, &mut self.samples) else { return };
        self.kind = kind;
        if !is_on() {
            switch_on(pins);
        }
        end_transfers(pins);
        while samples.dequeue().is_some() {}
        let started = accelerometer::start(kind, rate, &mut Polled(pins));
        critical_section::with(|_| {
            ENGINE.with(|engine| match started {
                Ok(()) => {
                    engine.reader = Some(Reader::new(kind));
                    begin_transfers();
                }
                Err(fault) => engine.fault = fault,
            });
        });
    }

    fn take(&mut self, into: &mut [Sample]) -> Result<usize, SensorFault> {
        let Some(samples) = &mut self.samples else { return Err(SensorFault::Absent) };
        let mut taken = 0;
        for (place, raw) in into.iter_mut().zip(core::iter::from_fn(|| samples.dequeue())) {
            *place = scaled(self.kind, raw);
            taken += 1;
        }
        if taken > 0 {
            return Ok(taken);
        }
        critical_section::with(|_| {
            ENGINE.with(|engine| if engine.reader.is_some() { Ok(0) } else { Err(engine.fault) })
        })
    }

    fn stop(&mut self) {
        let Some(pins) = self.pins.filter(|_| is_on()) else { return };
        end_transfers(pins);
        accelerometer::stop(self.kind, &mut Polled(pins));
    }
}

/// Whether the sensor has been used.
fn is_on() -> bool {
    RCC.apb1enr().read().spi3en()
}

/// Clocks the bus and connects the pins, with the sensor not selected.
fn switch_on(pins: SensorPins) {
    // Interrupts change modes of other pins of these ports, and clocks of other peripherals.
    critical_section::with(|_| {
        RCC.ahb1enr().modify(|w| w.set_dma1en(true));
        RCC.apb1enr().modify(|w| {
            w.set_spi3en(true);
            w.set_tim6en(true);
        });
        // They answer two cycles after their clock is on (ES0298, delay after an RCC peripheral clock enabling).
        let _ = RCC.apb1enr().read();
        ports::put(pins.select, true);
        ports::make_output(pins.select);
        for pin in [pins.clock, pins.miso, pins.mosi] {
            ports::make_alternate(pin, SPI_FUNCTION);
        }
        ports::speed_up(pins.clock, Speed::VeryHigh);
    });
    // Mode 3, eight bits, the highest first, and 45 MHz over 32 (RM0390, SPI control register 1).
    SPI3.cr1().write(|w| {
        w.set_cpha(Cpha::SECOND_EDGE);
        w.set_cpol(Cpol::IDLE_HIGH);
        w.set_mstr(Mstr::MASTER);
        w.set_br(Br::DIV32);
        w.set_ssm(true);
        w.set_ssi(true);
    });
    TIM6.psc().write_value(PRESCALER);
    TIM6.arr().write(|w| w.set_arr(LAST));
    TIM6.dier().write(|w| w.set_uie(true));
}

/// Ends a transfer under way and the timer, in the order of RM0390 (SPI: communication using DMA, procedure for
/// disabling the SPI). The sensor is not selected then, and bytes go one by one.
fn end_transfers(pins: SensorPins) {
    critical_section::with(|_| {
        ENGINE.with(|engine| (engine.reader, engine.fault) = (None, SensorFault::Silent));
        TIM6.cr1().write(|_| ());
        TIM6.sr().write(|w| w.0 = 0);
        for channel in [SENSOR_INPUT, SENSOR_OUTPUT] {
            let stream = DMA1.st(channel.stream);
            stream.cr().modify(|w| w.set_en(false));
            wait(|| !stream.cr().read().en());
        }
        forget_flags();
    });
    wait(|| SPI3.sr().read().txe() && !SPI3.sr().read().bsy());
    // Reading both forgets a byte that nobody took, and that another was lost behind it (RM0390, SPI error flags).
    let _ = (SPI3.dr().read(), SPI3.sr().read());
    ports::put(pins.select, true);
    SPI3.cr1().modify(|w| w.set_spe(false));
    SPI3.cr2().write(|_| ());
    SPI3.cr1().modify(|w| w.set_spe(true));
}

/// Lets DMA carry the bytes from now on, and the timer begin transfers.
fn begin_transfers() {
    let set = |stream: St, dir: Dir, memory: &[AtomicU8; LONGEST], is_last: bool| {
        stream.par().write_value(SPI3.dr().as_ptr() as u32);
        stream.m0ar().write_value(memory.as_ptr() as u32);
        stream.cr().write(|w| {
            // Both are requests of channel 0.
            w.set_dir(dir);
            w.set_psize(Size::BITS8);
            w.set_msize(Size::BITS8);
            w.set_minc(true);
            w.set_tcie(is_last);
        });
    };
    set(DMA1.st(SENSOR_INPUT.stream), Dir::PERIPHERAL_TO_MEMORY, &HEARD, true);
    set(DMA1.st(SENSOR_OUTPUT.stream), Dir::MEMORY_TO_PERIPHERAL, &SENT, false);
    SPI3.cr2().write(|w| {
        w.set_rxdmaen(true);
        w.set_txdmaen(true);
    });
    TIM6.cr1().write(|w| w.set_cen(true));
}

const _: () = assert!(SENSOR_INPUT.request == 0 && SENSOR_OUTPUT.request == 0);

/// Every flag of the first stream of four, and of the last (RM0390, DMA low and high interrupt flag clear register).
const FLAGS_OF_FIRST: Ixr = Ixr(0x3D);
const FLAGS_OF_LAST: Ixr = Ixr(0x3D << 22);
const _: () = assert!(SENSOR_INPUT.stream == 0 && SENSOR_OUTPUT.stream == 7);

/// Clears the flags of both streams, or they do not start again (RM0390, DMA: stream configuration procedure).
fn forget_flags() {
    DMA1.ifcr(0).write_value(FLAGS_OF_FIRST);
    DMA1.ifcr(1).write_value(FLAGS_OF_LAST);
}

/// Waits for a flag, with a limit.
fn wait(has_come: impl Fn() -> bool) {
    let _ = (0..LOOKS).any(|_| has_come());
}

/// The wires, with the processor carrying the bytes.
struct Polled(SensorPins);

impl Wire for Polled {
    fn transfer(&mut self, bytes: &mut [u8]) {
        ports::put(self.0.select, false);
        for byte in bytes {
            SPI3.dr().write(|w| w.set_dr(u16::from(*byte)));
            wait(|| SPI3.sr().read().rxne());
            *byte = SPI3.dr().read().dr() as u8;
        }
        ports::put(self.0.select, true);
    }
}

impl Engine {
    /// Begins a transfer, if there is one to begin. The input has to run before the output.
    fn begin(&self, transfer: Option<Transfer>) {
        let Some(Transfer { command, length }) = transfer else { return };
        SENT[0].store(command, Ordering::Relaxed);
        forget_flags();
        ports::put(self.pins.select, false);
        // The command is in memory before the DMA may fetch it.
        compiler_fence(Ordering::SeqCst);
        for channel in [SENSOR_INPUT, SENSOR_OUTPUT] {
            let stream = DMA1.st(channel.stream);
            stream.ndtr().write(|w| w.set_ndt(u16::from(length)));
            stream.cr().modify(|w| w.set_en(true));
        }
    }

    /// It is over.
    fn end(&mut self, fault: SensorFault) {
        (self.reader, self.fault) = (None, fault);
        TIM6.cr1().write(|_| ());
    }

    fn on_timer(&mut self) {
        match self.reader.as_mut().map(Reader::on_timer) {
            Some(Ok(transfer)) => self.begin(transfer),
            Some(Err(fault)) => self.end(fault),
            None => {}
        }
    }

    fn on_transfer(&mut self) {
        // The flag is gone if the transfer was ended (`end_transfers`) with the interrupt pending.
        if !DMA1.isr(SENSOR_INPUT.stream / 4).read().tcif(SENSOR_INPUT.stream % 4) {
            return;
        }
        ports::put(self.pins.select, true);
        forget_flags();
        let Some(reader) = &mut self.reader else { return };
        let bytes: Bytes = core::array::from_fn(|at| HEARD[at].load(Ordering::Acquire));
        match reader.on_transfer(&bytes) {
            Ok((sample, transfer)) => {
                if sample.is_some_and(|sample| self.samples.enqueue(sample).is_err()) {
                    return self.end(SensorFault::Overflow);
                }
                self.begin(transfer);
            }
            Err(fault) => self.end(fault),
        }
    }
}

/// A millisecond has passed.
#[interrupt]
fn TIM6_DAC() {
    static RATE: CallRate = CallRate::new();
    count_call(Interrupt::TIM6_DAC, &RATE);
    TIM6.sr().write(|w| w.0 = 0);
    ENGINE.with(Engine::on_timer);
    finish_stores();
}

/// A transfer has ended.
#[interrupt]
fn DMA1_STREAM0() {
    static RATE: CallRate = CallRate::new();
    count_call(Interrupt::DMA1_STREAM0, &RATE);
    ENGINE.with(Engine::on_transfer);
    finish_stores();
}
