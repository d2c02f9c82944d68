//! The last resort, measured: how many instructions the image of the Octopus executes from a fault to pins that are
//! safe. No heater is on here; the stores are the same that take a pin from its timer.
//!
//! QEMU has a board with an STM32F405 (`netduinoplus2`), with flash, RAM and ports where the F446 has them. It runs the
//! image's own vector table and handlers; a few instructions in place of the bootloader cause the fault. QEMU logs
//! every instruction, and every access to a port, which it does not model. The image ends each fault with a reset, and
//! QEMU exits at that.

use crate::build::{Elf, binary};
use crate::qemu::PROGRAM;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot_boards::Package;
use object::{Object as _, ObjectSymbol as _};
use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Flash, and where the image begins behind BTT's bootloader.
const FLASH: u32 = 0x0800_0000;

/// Where the instructions are that bring the fault about, from the begin of flash on: behind a vector table.
const CAUSE: usize = 0x400;

/// Vectors of an STM32F446: 16 of the core and 97 interrupts (RM0390 rev 6, table 38).
const VECTORS: usize = 16 + 97;

/// Ports A to G; the registers MODER and BSRR of each (RM0390 rev 6, sections 2.2.2, 7.4.1 and 7.4.7).
const PORTS: usize = 7;
const MODER: &str = "0x000";
const BSRR: &str = "0x018";

/// Longest time for QEMU: a hundred times its usual time.
const PATIENCE: Duration = Duration::from_secs(30);

/// Instructions from the entry of a fault's handler.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// To heaters that are low.
    pub heaters: usize,
    /// To drivers that are off.
    pub drivers: usize,
}

/// The cause of a fault.
enum Fault {
    /// An undefined instruction, at once (HardFault).
    Undefined,
    /// Stores to the system's registers, as address and value.
    Stores(Vec<[u32; 2]>),
    /// A jump, for a case that no register can cause (a panic).
    Jump(u32),
}

impl Fault {
    /// Its instructions (ARM DDI 0403E, A7.7.43 `ldr`, A7.7.158 `str`, A7.7.20 `bx`), and the words that they load.
    fn code(&self) -> Vec<u8> {
        const LOAD: [u16; 2] = [0x4800, 0x4900];
        const STORE: u16 = 0x6001;
        const JUMP: u16 = 0x4708;
        const STAY: u16 = 0xE7FE;
        let (pairs, act) = match self {
            Self::Undefined => return 0xDE00_u16.to_le_bytes().to_vec(),
            Self::Stores(stores) => (stores.clone(), STORE),
            // A panic looks for its message in RAM, which is zero.
            Self::Jump(to) => (vec![[0x2001_0000, to | 1]], JUMP),
        };
        let words = (pairs.len() * 3 + 2) / 2 * 4;
        let mut code = Vec::new();
        for number in 0..pairs.len() {
            for (place, load) in LOAD.into_iter().enumerate() {
                let pc = (code.len() + 4) & !3;
                let distance = (words + (2 * number + place) * 4 - pc) / 4;
                code.extend((load | distance as u16).to_le_bytes());
            }
            code.extend(act.to_le_bytes());
        }
        code.extend(STAY.to_le_bytes());
        code.resize(words, 0);
        code.extend(pairs.iter().flatten().flat_map(|word| word.to_le_bytes()));
        code
    }
}

/// The most that any fault takes, in an image of the Octopus.
///
/// # Errors
/// If the image cannot be run, or if a fault leaves a pin as it was.
pub fn measure(image: &[u8], folder: &Path) -> Result<Counts> {
    let elf = Elf::parse(image)?;
    let (start, bytes) = binary::extract(&elf, Package::ALIGNMENT)?;
    let vector = |number: usize| {
        let word = bytes.get(4 * number..4 * number + 4).and_then(|word| word.try_into().ok());
        word.map(u32::from_le_bytes).context("the image has no vector table")
    };
    let default = symbol(&elf, "DefaultHandler", |name| name == "DefaultHandler")?;
    let stray = (16..VECTORS).find(|irq| vector(*irq).is_ok_and(|entry| entry & !1 == default));
    let stray = stray.context("the image has a handler for every interrupt")?;
    // ICSR.NMIPENDSET; ISER and ISPR of an interrupt (ARM DDI 0403E, B3.2.4, B3.4.4 and B3.4.6).
    let interrupt = |number: usize| {
        let (register, bit) = (4 * (number as u32 / 32), 1 << (number % 32));
        Fault::Stores(vec![[0xE000_E100 + register, bit], [0xE000_E200 + register, bit]])
    };
    let panic = symbol(&elf, "panic handler", |name| name.contains("rust_begin_unwind"))?;
    let faults = [
        ("HardFault", Fault::Undefined, vector(3)?),
        ("NMI", Fault::Stores(vec![[0xE000_ED04, 1 << 31]]), vector(2)?),
        ("a stray interrupt", interrupt(stray - 16), vector(stray)?),
        // The detector of the supply is interrupt 1 (RM0390 rev 6, table 38).
        ("the supply falls", interrupt(1), vector(17)?),
        ("a panic", Fault::Jump(panic), panic | 1),
    ];
    // Where the image keeps the safe level of each port.
    let words = symbol(&elf, "safe levels", |name| name.contains("safe_levels5WORDS"))?;
    let mut most = Counts::default();
    for (name, fault, entry) in faults {
        let mut flash = vec![0xFF; (start - FLASH) as usize];
        flash.extend(&bytes);
        flash.copy_within((start - FLASH) as usize..(start - FLASH) as usize + 4 * VECTORS, 0);
        flash[4..8].copy_from_slice(&((FLASH + CAUSE as u32) | 1).to_le_bytes());
        let code = fault.code();
        flash[CAUSE..CAUSE + code.len()].copy_from_slice(&code);
        let counts = run(&flash, words, entry & !1, folder).with_context(|| format!("{name}: not safe"))?;
        println!("{name}: heaters low after {} instructions, drivers off after {}", counts.heaters, counts.drivers);
        most = Counts { heaters: most.heaters.max(counts.heaters), drivers: most.drivers.max(counts.drivers) };
    }
    Ok(most)
}

/// The address of a symbol, without the bit that says Thumb.
fn symbol(elf: &Elf<'_>, what: &str, is_it: impl Fn(&str) -> bool) -> Result<u32> {
    let found = elf.symbols().find(|symbol| symbol.name().is_ok_and(&is_it));
    let found = found.with_context(|| format!("the image has no {what}"))?;
    Ok(found.address() as u32 & !1)
}

/// The safe level of a port, here just a number to be known again.
const fn level(port: usize) -> u32 {
    0x00A5_0001 + port as u32
}

/// Runs flash until its reset and counts from the first instruction of a handler.
fn run(flash: &[u8], words: u32, entry: u32, folder: &Path) -> Result<Counts> {
    let (image, log) = (folder.join("last-resort.bin"), folder.join("last-resort.log"));
    std::fs::write(&image, flash).with_context(|| format!("cannot write {}", image.display()))?;
    let mut command = Command::new(PROGRAM);
    command.args(["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "none", "-no-reboot"]);
    command.args(["-singlestep", "-d", "exec,nochain,unimp", "-D"]).arg(&log).arg("-kernel").arg(&image);
    for port in 0..PORTS {
        let address = words + 4 * port as u32;
        command.args(["-device", &format!("loader,addr={address:#x},data={:#x},data-len=4", level(port))]);
    }
    let mut process = command.stdin(Stdio::null()).stderr(Stdio::null()).spawn().context("cannot run QEMU")?;
    let begin = Instant::now();
    while process.try_wait()?.is_none() {
        if begin.elapsed() > PATIENCE {
            process.kill()?;
            process.wait()?;
            std::fs::remove_file(&log)?;
            bail!("no reset");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let counts = count(BufReader::new(File::open(&log)?).lines().map_while(Result::ok), entry);
    std::fs::remove_file(log)?;
    std::fs::remove_file(image)?;
    counts
}

/// Counts in QEMU's log.
fn count(log: impl Iterator<Item = String>, entry: u32) -> Result<Counts> {
    let mut executed = None;
    let (mut heaters, mut drivers) = (None, None);
    let mut written = [false; PORTS];
    for line in log {
        if let Some(at) = instruction(&line) {
            executed = if at == entry && executed.is_none() { Some(1) } else { executed.map(|count: usize| count + 1) };
        } else if let (Some((port, register, value)), Some(executed)) = (write(&line), executed) {
            if (port, register) == (0, MODER) {
                ensure!(written[0], "the pins are taken from the timer before their level is low");
                heaters.get_or_insert(executed);
            } else if register == BSRR && value == level(port) {
                written[port] = true;
                if written == [true; PORTS] {
                    drivers.get_or_insert(executed);
                }
            }
        }
    }
    ensure!(executed.is_some(), "its handler was never reached");
    let heaters = heaters.context("the heaters' pins stayed the timer's")?;
    let drivers = drivers.with_context(|| format!("ports that got no safe level: {written:?}"))?;
    Ok(Counts { heaters, drivers })
}

/// The address in a line of the log about an instruction.
fn instruction(line: &str) -> Option<u32> {
    let at = line.strip_prefix("Trace")?.split('/').nth(1)?;
    u32::from_str_radix(at, 16).ok()
}

/// Port, register and value in a line about a write to a port.
fn write(line: &str) -> Option<(usize, &str, u32)> {
    let (port, access) = line.strip_prefix("GPIO")?.split_once(": unimplemented device write (size 4, offset ")?;
    let port = usize::from(*port.as_bytes().first()?).checked_sub(usize::from(b'A')).filter(|port| *port < PORTS)?;
    let (register, value) = access.split_once(", value 0x")?;
    Some((port, register, u32::from_str_radix(value.trim_end_matches(')'), 16).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(at: u32) -> String {
        format!("Trace 0: 0x7f66bc000100 [00800408/{at:08x}/00000110/ff000201] ")
    }

    fn stored(port: char, register: &str, value: u32) -> String {
        format!("GPIO{port}: unimplemented device write (size 4, offset {register}, value 0x{value:08x})")
    }

    fn safe() -> Vec<String> {
        let mut log = vec![trace(4), trace(8), trace(10), stored('A', BSRR, level(0)), trace(12)];
        log.push(stored('A', MODER, 0));
        for (port, letter) in (0..PORTS).zip('A'..) {
            log.extend([trace(14), stored(letter, BSRR, level(port))]);
        }
        log
    }

    #[test]
    fn instructions_are_counted_from_the_handler_on() {
        let counts = count(safe().into_iter(), 8).unwrap();
        assert_eq!((counts.heaters, counts.drivers), (3, 10));
    }

    #[test]
    fn a_pin_that_stays_as_it_was_is_told() {
        let without = |missing: &str| count(safe().into_iter().filter(|line| !line.contains(missing)), 8);
        assert!(without("GPIOD").unwrap_err().to_string().contains("no safe level"));
        assert!(without("offset 0x000").unwrap_err().to_string().contains("the timer's"));
        assert!(count(safe().into_iter(), 99).unwrap_err().to_string().contains("never reached"));
    }

    #[test]
    fn stores_load_their_words_from_behind_them() {
        let code = Fault::Stores(vec![[0xE000_ED04, 1 << 31]]).code();
        let halves: Vec<_> = code.chunks(2).map(|half| u16::from_le_bytes([half[0], half[1]])).collect();
        // ldr r0, [pc, #4]; ldr r1, [pc, #8]; str r1, [r0]; b .
        assert_eq!(halves[..4], [0x4801, 0x4902, 0x6001, 0xE7FE]);
        assert_eq!(code[8..], [0x04, 0xED, 0x00, 0xE0, 0, 0, 0, 0x80]);
    }
}
