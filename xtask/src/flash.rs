//! `cargo xtask flash`: builds the image of a board and puts it there.

use crate::build::{self, Board, Image};
use crate::checkout::run;
use anyhow::{Context as _, Result, bail, ensure};
use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// ST's bootloader in the processor's ROM, as USB sees it (AN2606).
const DFU_DEVICE: &str = "0483:df11";

/// Which board, and how the image gets there.
#[derive(clap::Args)]
pub struct Args {
    /// The board.
    #[arg(value_parser = build::board_parser())]
    board: Board,
    #[command(flatten)]
    way: Way,
}

#[derive(clap::Args)]
#[group(required = true, multiple = false)]
struct Way {
    /// By a debug probe on the SWD pins, with probe-rs; its reset wire (NRST) has to be connected. Afterwards the log
    /// can be read through the same probe.
    #[arg(long)]
    probe: bool,
    /// By USB, with dfu-util; the board has to be in the chip's own bootloader (BOOT0 high and BOOT1 low at reset),
    /// with the heaters unplugged.
    #[arg(long)]
    dfu: bool,
    /// Flashes by the SD card in this folder; the board's bootloader takes the image at the next reset.
    #[arg(long, value_name = "DIR")]
    sd: Option<PathBuf>,
}

/// The message of dfu-util 0.11 when everything has arrived.
const DOWNLOADED: &str = "File downloaded successfully";

/// The flashing tool, and its source.
struct Tool {
    program: &'static str,
    install: &'static str,
}

const PROBE_RS: Tool = Tool { program: "probe-rs", install: "cargo install probe-rs-tools --locked" };
const DFU_UTIL: Tool = Tool { program: "dfu-util", install: "sudo apt-get install dfu-util" };

/// Builds and flashes.
pub fn main(args: &Args) -> Result<()> {
    let (board, way) = (args.board, &args.way);
    // Impossible requests are reported before minutes of building.
    if way.probe {
        PROBE_RS.find()?;
    } else if way.dfu {
        ensure!(board.entry.board.has_usb, "the {} has no USB socket of its own: use --probe", board.title());
        DFU_UTIL.find()?;
        println!("{}", board.entry.before_dfu);
    } else if let Some(card) = &way.sd {
        ensure!(board.entry.has_card_slot, "the {} has no card slot: use --probe", board.title());
        ensure!(card.is_dir(), "{} is no folder: where is the card mounted?", card.display());
    }
    let image = build::image(board)?;
    if way.probe {
        by_probe(board, &image)
    } else if way.dfu {
        by_dfu(dfu_command(&image))
    } else if let Some(card) = &way.sd {
        onto_card(&image.binary, card)
    } else {
        bail!("say how: --probe, --dfu or --sd DIR")
    }
}

fn by_probe(board: Board, image: &Image) -> Result<()> {
    for command in probe_commands(board, image) {
        run(command).context("no image was flashed; is the probe connected, its NRST too, and has the board power?")?;
    }
    println!("the log: probe-rs attach --chip {} {}", board.entry.chip, image.elf.display());
    Ok(())
}

/// Flashes and lets the board start. Both connect while the chip is held in reset: BTT's bootloader makes an output of
/// SWDIO (PA13, which has the board's LED), and with an image that has crashed early it stays one.
fn probe_commands(board: Board, image: &Image) -> [Command; 2] {
    let command = |task: &str| {
        let mut command = Command::new(PROBE_RS.program);
        command.args([task, "--chip", board.entry.chip, "--connect-under-reset"]);
        command
    };
    let mut download = command("download");
    if board.has_elf() {
        download.arg(&image.elf);
    } else {
        download.args(["--binary-format", "bin", "--base-address", &format!("{:#010x}", image.start)]);
        download.arg(&image.binary);
    }
    [download, command("reset")]
}

/// `leave` starts the image afterwards.
fn dfu_command(image: &Image) -> Command {
    let mut command = Command::new(DFU_UTIL.program);
    let place = format!("{:#010x}:leave", image.start);
    command.args(["--device", DFU_DEVICE, "--alt", "0", "--dfuse-address", &place, "--download"]);
    command.arg(&image.binary);
    command
}

/// Runs dfu-util and decides by its output. After a download it may end with an error, because the board starts the
/// image at once and does not answer any more.
fn by_dfu(mut command: Command) -> Result<()> {
    let mut child = command.stdout(Stdio::piped()).spawn().context("cannot run dfu-util")?;
    let mut output = child.stdout.take().context("dfu-util has no output")?;
    let (mut said, mut part) = (Vec::new(), [0; 4096]);
    loop {
        let length = output.read(&mut part)?;
        if length == 0 {
            break;
        }
        io::stdout().write_all(&part[..length])?;
        io::stdout().flush()?;
        said.extend_from_slice(&part[..length]);
    }
    let status = child.wait()?;
    let is_there = String::from_utf8_lossy(&said).contains(DOWNLOADED);
    ensure!(
        status.success() || is_there,
        "no image was flashed ({status}); is the board in its bootloader (BOOT0 jumper set, BOOT1 low, then reset)?"
    );
    println!("flashed; take the BOOT0 jumper off and reset, then plug the heaters in again");
    Ok(())
}

/// Copies the binary under the name that the bootloader expects, and waits until it is on the card.
fn onto_card(binary: &Path, card: &Path) -> Result<()> {
    let name = binary.file_name().context("the image has no name")?;
    let target = card.join(name);
    let copy = || -> io::Result<()> {
        std::fs::copy(binary, &target)?;
        File::open(&target)?.sync_all()
    };
    copy().with_context(|| format!("cannot write {}", target.display()))?;
    println!("copied  {}; eject the card, put it into the board and switch it on", target.display());
    Ok(())
}

impl Tool {
    /// Fails with a hint if the tool is missing.
    fn find(&self) -> Result<()> {
        let mut command = Command::new(self.program);
        command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
        match command.status() {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                bail!("{} is missing; install it with: {}", self.program, self.install)
            }
            Err(error) => Err(error).with_context(|| format!("cannot run {}", self.program)),
            Ok(_) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkout::words;

    fn called(key: &str) -> Board {
        Board::called(key).unwrap()
    }

    fn image() -> Image {
        Image { elf: "octopus.elf".into(), binary: "firmware.bin".into(), start: 0x0800_8000 }
    }

    #[test]
    fn dfu_writes_behind_the_bootloader_of_the_board() {
        let text = words(&dfu_command(&image()));
        let wanted = "dfu-util --device 0483:df11 --alt 0 --dfuse-address 0x08008000:leave --download firmware.bin";
        assert_eq!(text, wanted);
    }

    #[cfg(unix)]
    #[test]
    fn a_board_that_starts_at_once_was_flashed_whatever_the_tool_thinks_of_it() {
        let tool = |script: &str| {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            command
        };
        assert!(by_dfu(tool("echo Download done.; echo File downloaded successfully; exit 74")).is_ok());
        assert!(by_dfu(tool("echo No DFU capable USB device available; exit 74")).is_err());
        assert!(by_dfu(tool("exit 0")).is_ok());
    }

    #[test]
    fn a_probe_gets_the_chip_and_connects_while_it_is_held_in_reset() {
        for (board, chip) in [("octopus", "STM32F446ZETx"), ("nucleo", "STM32F446RETx")] {
            let texts = probe_commands(called(board), &image()).map(|command| words(&command));
            let wanted = [
                format!("probe-rs download --chip {chip} --connect-under-reset octopus.elf"),
                format!("probe-rs reset --chip {chip} --connect-under-reset"),
            ];
            assert_eq!(texts, wanted);
        }
    }

    #[test]
    fn a_board_that_shares_its_image_gets_the_binary_that_is_for_it() {
        let [download, _] = probe_commands(called("octopus-pro"), &image()).map(|command| words(&command));
        let wanted = "probe-rs download --chip STM32F446ZETx --connect-under-reset --binary-format bin \
                      --base-address 0x08008000 firmware.bin";
        assert_eq!(download, wanted);
    }

    #[test]
    fn whoever_flashes_by_usb_is_warned_of_the_heaters_and_of_both_boot_pins() {
        for board in Board::all().filter(|board| board.entry.board.has_usb) {
            for word in ["BOOT1", "unplug", "PB2"] {
                assert!(board.entry.before_dfu.contains(word), "{}: {word}", board.key());
            }
        }
    }

    #[test]
    fn a_missing_tool_is_named_with_the_way_to_get_it() {
        let tool = Tool { program: "no-such-flasher", install: "somehow" };
        let error = tool.find().unwrap_err().to_string();
        assert_eq!(error, "no-such-flasher is missing; install it with: somehow");
    }

    #[test]
    fn a_card_gets_the_file_that_its_bootloader_looks_for() {
        let dir = std::env::temp_dir().join(format!("corehbot-card-{}", std::process::id()));
        let (made, card) = (dir.join("made"), dir.join("card"));
        std::fs::create_dir_all(&made).unwrap();
        std::fs::create_dir_all(&card).unwrap();
        let binary = made.join("firmware.bin");
        std::fs::write(&binary, [1, 2, 3]).unwrap();
        onto_card(&binary, &card).unwrap();
        assert_eq!(std::fs::read(card.join("firmware.bin")).unwrap(), [1, 2, 3]);
        assert!(onto_card(&binary, &dir.join("nowhere")).is_err());
        std::fs::remove_dir_all(dir).unwrap();
    }
}
