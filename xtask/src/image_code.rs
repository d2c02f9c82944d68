//! The code of the image: its instructions, and the author of each.

use crate::checkout;
use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian, SectionId};
use anyhow::{Context as _, Result};
use object::{File, Object as _, ObjectSection as _, SectionKind, SymbolMap, SymbolMapName};

type Reader<'d> = EndianSlice<'d, LittleEndian>;

/// The author of an instruction.
pub struct Author<R> {
    /// The room of the innermost function that has one, inlined functions included.
    pub room: Option<R>,
    /// That function; if no room, the outermost one.
    pub function: String,
}

/// An image, read.
pub struct Code<'d> {
    file: File<'d>,
    symbols: SymbolMap<SymbolMapName<'d>>,
    lines: addr2line::Context<Reader<'d>>,
    /// Executable sections.
    sections: Vec<(u64, &'d [u8])>,
    root: String,
}

impl<'d> Code<'d> {
    /// Reads an ELF file.
    pub fn read(elf: &'d [u8]) -> Result<Self> {
        let file = File::parse(elf).context("the image is not an ELF file")?;
        let section = |id: SectionId| -> Result<Reader<'d>> {
            let data = file.section_by_name(id.name()).map(|section| section.data()).transpose()?;
            Ok(EndianSlice::new(data.unwrap_or_default(), LittleEndian))
        };
        let lines = addr2line::Context::from_dwarf(Dwarf::load(section)?).context("the image has no lines")?;
        let is_code = |section: &object::Section<'d, '_>| section.kind() == SectionKind::Text && section.size() > 0;
        let sections: object::Result<_> =
            file.sections().filter(is_code).map(|section| Ok((section.address(), section.data()?))).collect();
        let sections = sections?;
        let root = format!("{}/", checkout::root().display());
        let symbols = file.symbol_map();
        Ok(Self { file, symbols, lines, sections, root })
    }

    /// Where the handler of a vector is.
    pub fn handler(&self, vector: usize) -> Result<u64> {
        let table = self.file.section_by_name(".vector_table").context("the image has no vectors")?;
        let word = table.data()?.get(4 * vector..4 * vector + 4).context("the image has too few vectors")?;
        Ok(u64::from(u32::from_le_bytes(word.try_into()?) & !1))
    }

    /// Where the table of vectors is.
    pub fn vectors(&self) -> u64 {
        self.file.section_by_name(".vector_table").map_or(0, |table| table.address())
    }

    /// The addresses of all half words of code.
    pub fn addresses(&self) -> impl Iterator<Item = u64> {
        self.sections.iter().flat_map(|(start, data)| (*start..*start + data.len() as u64).step_by(2))
    }

    /// Two half words at an address; 0 beyond the code.
    pub fn words(&self, address: u64) -> [u16; 2] {
        [address, address + 2].map(|address| {
            let bytes = self.sections.iter().find_map(|(start, data)| {
                let offset = usize::try_from(address.checked_sub(*start)?).ok()?;
                data.get(offset..offset + 2)?.try_into().ok()
            });
            bytes.map_or(0, u16::from_le_bytes)
        })
    }

    /// The author of the instruction at an address; `room_of` knows the room of a source file by its path below the
    /// root.
    pub fn author<R>(&self, address: u64, room_of: impl Fn(&str) -> Option<R>) -> Result<Author<R>> {
        let mut frames = self.lines.find_frames(address).skip_all_loads()?;
        let mut function = None;
        while let Some(frame) = frames.next()? {
            let path = frame.location.and_then(|location| location.file).unwrap_or_default();
            let room = path.strip_prefix(&self.root).and_then(&room_of);
            if let Some(name) = frame.function {
                function = Some(name.demangle()?.replace("corehbot::", ""));
            }
            if let (Some(room), Some(function)) = (room, &function) {
                return Ok(Author { room: Some(room), function: function.clone() });
            }
        }
        Ok(Author { room: None, function: function.unwrap_or_else(|| self.symbol(address)) })
    }

    /// Where the function begins that has `name` in the name of its symbol.
    pub fn entry(&self, name: &str) -> Option<u64> {
        self.symbols.symbols().iter().find(|symbol| symbol.name().contains(name)).map(|symbol| symbol.address() & !1)
    }

    /// The symbol of the function at an address.
    pub fn symbol_of(&self, address: u64) -> &str {
        self.symbols.get(address | 1).map_or("", |symbol| symbol.name())
    }

    /// The symbol, for code without line information; the lowest bit marks Thumb code.
    fn symbol(&self, address: u64) -> String {
        self.symbols.get(address | 1).map_or_else(|| format!("{address:#x}"), |symbol| symbol.name().to_owned())
    }
}
