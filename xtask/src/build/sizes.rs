//! The bytes of an image by room, each against its budget, and the largest functions.
//!
//! A room is a folder of sources. An instruction belongs to the innermost function of the project that it was inlined
//! from. So a closure counts where it is written, and an iterator of the library counts for its caller. Constants have
//! no author: texts and tables are one room.

use super::Elf;
use super::contents::flash;
use crate::image_code::Code;
use addr2line::demangle_auto;
use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSymbol as _, SymbolKind};
use std::collections::BTreeMap;
use std::fmt;

/// The package of the image that has budgets: it holds every room that flies, on the chip with the least flash.
pub const PACKAGE: &str = "corehbot-octopus";

/// Budgets of [`PACKAGE`], a room and its bytes a line. A budget is what the room took when the line was last changed,
/// and 1 % more, because another compiler gives other sizes.
const BUDGETS: &str = include_str!("rooms.tsv");

/// Code of libraries that nothing of the project was inlined from or into.
const LIBRARIES: &str = "libraries";

/// What is no code: texts, tables, vectors, first values.
const CONSTANTS: &str = "constants";

/// Functions that are listed.
const LISTED: usize = 40;

/// Columns of a function's name.
const COLUMNS: usize = 110;

/// What an image is made of.
pub struct Sizes {
    /// Bytes by room.
    rooms: BTreeMap<String, u64>,
    /// The largest functions, with their bytes.
    functions: Vec<(u64, String)>,
}

/// Weighs an ELF file.
pub fn of(data: &[u8]) -> Result<Sizes> {
    let code = Code::read(data)?;
    let mut rooms = BTreeMap::new();
    let mut instructions = 0;
    for address in code.addresses() {
        let room = code.author(address, room)?.room;
        *rooms.entry(room.unwrap_or_else(|| LIBRARIES.to_owned())).or_default() += 2;
        instructions += 2;
    }
    let elf = Elf::parse(data)?;
    let constants = flash(&elf).checked_sub(instructions).context("the image has more code than bytes")?;
    rooms.insert(CONSTANTS.to_owned(), constants);
    Ok(Sizes { rooms, functions: functions(&elf) })
}

/// The room of a source file: a folder of the core, of its two largest rooms, or a crate. Other files are of libraries.
fn room(path: &str) -> Option<String> {
    let folders: Vec<_> = path.split('/').collect();
    let depth = match folders.as_slice() {
        ["src", "machine" | "motion", _, _, ..] => 3,
        ["src", _] => return Some(path.trim_end_matches(".rs").to_owned()),
        ["src" | "chips" | "boards", _, _, ..] => 2,
        _ => return None,
    };
    Some(folders.get(..depth)?.join("/"))
}

fn functions(elf: &Elf<'_>) -> Vec<(u64, String)> {
    let code = elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text);
    let name = |symbol: &str| demangle_auto(symbol.into(), None).replace("corehbot::", "");
    let mut all: Vec<_> = code.filter_map(|symbol| Some((symbol.size(), name(symbol.name().ok()?)))).collect();
    all.sort_unstable_by(|a, b| b.cmp(a));
    all.truncate(LISTED);
    all
}

/// Budgets by room.
fn budgets(table: &str) -> Result<BTreeMap<&str, u64>> {
    let lines = table.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    lines
        .map(|line| {
            let (room, bytes) = line.split_once('\t').with_context(|| format!("no tab in `{line}`"))?;
            Ok((room, bytes.parse().with_context(|| format!("no number in `{line}`"))?))
        })
        .collect()
}

impl Sizes {
    /// Fails if a room is over its budget, or has none.
    pub fn check(&self) -> Result<()> {
        let complaints = complaints(&self.rooms, &budgets(BUDGETS)?);
        ensure!(complaints.is_empty(), "{} (xtask/src/build/rooms.tsv)", complaints.join("; "));
        Ok(())
    }
}

fn complaints(rooms: &BTreeMap<String, u64>, budgets: &BTreeMap<&str, u64>) -> Vec<String> {
    let over = rooms.iter().filter_map(|(room, bytes)| match budgets.get(room.as_str()) {
        None => Some(format!("{room} takes {bytes} bytes of flash and has no budget")),
        Some(budget) => {
            (bytes > budget).then(|| format!("{room} is {} bytes over its budget of flash", bytes - budget))
        }
    });
    let gone = budgets.keys().filter(|room| !rooms.contains_key(**room));
    over.chain(gone.map(|room| format!("{room} has a budget and no code"))).collect()
}

impl fmt::Display for Sizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let budgets = budgets(BUDGETS).map_err(|_| fmt::Error)?;
        let mut rooms: Vec<_> = self.rooms.iter().collect();
        rooms.sort_by_key(|(_, bytes)| std::cmp::Reverse(**bytes));
        writeln!(f, "{:<32} {:>8} {:>8}", "room", "bytes", "budget")?;
        for (room, bytes) in rooms {
            let budget = budgets.get(room.as_str()).map_or_else(|| "none".to_owned(), u64::to_string);
            writeln!(f, "{room:<32} {bytes:>8} {budget:>8}")?;
        }
        writeln!(f, "{:<32} {:>8}\n", "all", self.rooms.values().sum::<u64>())?;
        for (bytes, name) in &self.functions {
            writeln!(f, "{bytes:>8} {}", name.chars().take(COLUMNS).collect::<String>())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_is_a_folder_of_the_core_or_a_crate() {
        for (path, known) in [
            ("src/machine/commands/bed/mesh.rs", "src/machine/commands"),
            ("src/machine/pause.rs", "src/machine"),
            ("src/motion/planner/junction.rs", "src/motion/planner"),
            ("src/settings/probe.rs", "src/settings"),
            ("src/text.rs", "src/text"),
            ("chips/stm32f446/src/usb.rs", "chips/stm32f446"),
        ] {
            assert_eq!(room(path).as_deref(), Some(known));
        }
        assert_eq!(room("registry/src/heapless-0.9.1/src/vec.rs"), None);
    }

    #[test]
    fn a_room_over_its_budget_is_told_and_so_is_one_without() {
        let rooms = BTreeMap::from([("a".to_owned(), 100), ("b".to_owned(), 101), ("c".to_owned(), 1)]);
        let budgets = budgets("# room\tbytes\na\t100\nb\t100\nd\t5\n").unwrap();
        let told = complaints(&rooms, &budgets);
        assert_eq!(told.len(), 3, "{told:?}");
        assert!(told[0].contains("b is 1 bytes over") && told[1].contains("c takes 1") && told[2].contains("d has"));
    }

    #[test]
    fn every_line_of_the_table_is_a_budget() {
        assert!(budgets(BUDGETS).unwrap().values().sum::<u64>() > 0);
        assert!(super::budgets("a 5").is_err() && super::budgets("a\tfive").is_err());
    }
}
