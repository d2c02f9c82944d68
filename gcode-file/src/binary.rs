//! Binary G-code: a header, then blocks of metadata, pictures and text, each packed and with a checksum
//! (github.com/prusa3d/libbgcode, doc/specifications.md).
//!
//! ```text
//! file    "GCDE", version 1, checksums (0 none, 1 CRC-32): 4, 4 and 2 bytes, little-endian as all numbers
//! block   kind, packing, bytes of content: 2, 2 and 4 bytes; if it is packed, bytes that it has so: 4
//!         parameters: an encoding of 2 bytes, or format, width and height of a picture of 2 bytes each
//!         content, CRC-32 of all before it in the block: 4 bytes
//! ```
//! The text that comes out has the order of the slicer's plain files: who made it, pictures, G-code, figures of the
//! print, the slicer's settings. All but the G-code are comments, by the rules of plain files.
//!
//! The container does not say how many blocks it has. So a file that ends between two blocks of G-code looks whole.

use crate::error::GcodeFileError;
use crate::{heatshrink, meatpack};
use flate2::Crc;
use flate2::read::ZlibDecoder;
use std::io::{BufReader, Read, Write};

/// First bytes of a file.
const MAGIC: [u8; 4] = *b"GCDE";

const VERSION: u32 = 1;

/// Characters of a picture in a line, as PrusaSlicer writes it.
const PICTURE_LINE: usize = 78;

/// What a block is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    File,
    Gcode,
    Slicer,
    Printer,
    Print,
    Picture,
}

/// The kinds, by their numbers.
const KINDS: [Kind; 6] = [Kind::File, Kind::Gcode, Kind::Slicer, Kind::Printer, Kind::Print, Kind::Picture];

/// Words before the size of a picture, by the numbers of formats: PNG, JPG, QOI.
const PICTURES: [&str; 3] = ["thumbnail", "thumbnail_JPG", "thumbnail_QOI"];

/// Bits of a distance in heatshrink, by the numbers of packings; those of a count are always 4.
const WINDOWS: [(u16, u32); 2] = [(2, 11), (3, 12)];

/// A block with its content unpacked.
struct Block {
    kind: Kind,
    parameters: Vec<u16>,
    content: Vec<u8>,
}

/// Writes the text of a file.
pub(crate) fn unpack(from: impl Read, into: &mut impl Write, most: u64) -> Result<(), GcodeFileError> {
    let mut from = BufReader::new(from);
    let header: [u8; 10] = read(&mut from)?;
    let [m0, m1, m2, m3, v0, v1, v2, v3, c0, c1] = header;
    let (version, checksums) = (u32::from_le_bytes([v0, v1, v2, v3]), u16::from_le_bytes([c0, c1]));
    if [m0, m1, m2, m3] != MAGIC {
        return Err(GcodeFileError::damaged("it does not begin with GCDE"));
    }
    if version != VERSION || checksums > 1 {
        let what = format!("binary G-code of version {version} with checksums of kind {checksums} is not known");
        return Err(GcodeFileError::Unknown(what));
    }
    let (mut number, mut has_gcode, mut behind) = (0, false, Behind::default());
    while let Some(block) = block(&mut from, number, checksums == 1, most)? {
        number += 1;
        let Block { kind, parameters, content } = block;
        let encoding = parameters[0];
        match kind {
            Kind::File => into.write_all(produced(&content).as_bytes())?,
            Kind::Printer => comments(&content, into)?,
            Kind::Picture => picture(&parameters, &content, into)?,
            Kind::Print => behind.print.extend(content),
            Kind::Slicer => behind.slicer.extend(content),
            Kind::Gcode => {
                has_gcode = true;
                match encoding {
                    0 => into.write_all(&content)?,
                    _ => {
                        let text = meatpack::unpack(&content);
                        let damaged = || GcodeFileError::damaged(format!("block {number} ends within a character"));
                        into.write_all(&text.ok_or_else(damaged)?)?;
                    }
                }
            }
        }
    }
    if !has_gcode {
        return Err(GcodeFileError::damaged("it has no block of G-code"));
    }
    behind.write(into)
}

/// Metadata that stand behind the G-code of plain files.
#[derive(Default)]
struct Behind {
    print: Vec<u8>,
    slicer: Vec<u8>,
}

impl Behind {
    fn write(&self, into: &mut impl Write) -> Result<(), GcodeFileError> {
        into.write_all(b"\n")?;
        comments(&self.print, into)?;
        if !self.slicer.is_empty() {
            into.write_all(b"\n; prusaslicer_config = begin\n")?;
            comments(&self.slicer, into)?;
            into.write_all(b"; prusaslicer_config = end\n")?;
        }
        Ok(())
    }
}

fn read<const N: usize>(from: &mut impl Read) -> Result<[u8; N], GcodeFileError> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// The next block, `None` at the end of the file.
fn block(from: &mut impl Read, number: usize, has_checksum: bool, most: u64) -> Result<Option<Block>, GcodeFileError> {
    let mut first = [0];
    if from.read(&mut first)? == 0 {
        return Ok(None);
    }
    let mut crc = Crc::new();
    let rest: [u8; 7] = read(from)?;
    crc.update(&first);
    crc.update(&rest);
    let [k1, p0, p1, s0, s1, s2, s3] = rest;
    let (kind, packing) = (u16::from_le_bytes([first[0], k1]), u16::from_le_bytes([p0, p1]));
    let length = u32::from_le_bytes([s0, s1, s2, s3]);
    let unknown = |what: &str, n: u16| {
        // Without checksums damage looks the same.
        GcodeFileError::damaged(format!("block {} has {what} {n}, which there is not in this version", number + 1))
    };
    let kind = *KINDS.get(usize::from(kind)).ok_or_else(|| unknown("kind", kind))?;
    let stored = match packing {
        0 => length,
        1..=3 => {
            let size: [u8; 4] = read(from)?;
            crc.update(&size);
            u32::from_le_bytes(size)
        }
        _ => return Err(unknown("packing", packing)),
    };
    if u64::from(length.max(stored)) > most {
        return Err(GcodeFileError::TooLong(most));
    }
    let mut parameters = Vec::new();
    for _ in 0..if kind == Kind::Picture { 3 } else { 1 } {
        let pair: [u8; 2] = read(from)?;
        crc.update(&pair);
        parameters.push(u16::from_le_bytes(pair));
    }
    // Metadata may be JSON, of which no line is `key=value`.
    let known = if matches!(kind, Kind::Gcode | Kind::Picture) { 2 } else { 1 };
    if parameters[0] > known {
        return Err(unknown("encoding", parameters[0]));
    }
    let mut content = Vec::new();
    if from.take(stored.into()).read_to_end(&mut content)? < stored as usize {
        return Err(GcodeFileError::damaged("its end is missing"));
    }
    crc.update(&content);
    if has_checksum && u32::from_le_bytes(read(from)?) != crc.sum() {
        return Err(GcodeFileError::damaged(format!("the checksum of block {} is wrong", number + 1)));
    }
    let content = inflated(content, packing, length as usize);
    let damaged = || GcodeFileError::damaged(format!("block {} does not inflate to its length", number + 1));
    Ok(Some(Block { kind, parameters, content: content.ok_or_else(damaged)? }))
}

/// Content of exactly this length.
fn inflated(content: Vec<u8>, packing: u16, length: usize) -> Option<Vec<u8>> {
    match packing {
        0 => Some(content),
        1 => {
            let mut found = Vec::new();
            // One byte more shows that it is longer than it says.
            ZlibDecoder::new(&content[..]).take(length as u64 + 1).read_to_end(&mut found).ok()?;
            (found.len() == length).then_some(found)
        }
        _ => {
            let (_, window) = WINDOWS.into_iter().find(|(number, _)| *number == packing)?;
            heatshrink::unpack(&content, window, 4, length)
        }
    }
}

/// Lines `key=value` of metadata.
fn pairs(content: &[u8]) -> impl Iterator<Item = (String, String)> {
    let lines: Vec<_> = String::from_utf8_lossy(content).lines().map(str::to_owned).collect();
    lines.into_iter().filter_map(|line| line.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned())))
}

/// Metadata as comments.
fn comments(content: &[u8], into: &mut impl Write) -> Result<(), GcodeFileError> {
    Ok(pairs(content).try_for_each(|(key, value)| writeln!(into, "; {key} = {value}"))?)
}

/// The first line of a plain file.
fn produced(content: &[u8]) -> String {
    let producer = pairs(content).find(|(key, _)| key == "Producer").map(|(_, value)| value);
    producer.map(|name| format!("; generated by {name}\n\n")).unwrap_or_default()
}

/// A picture as plain files have it, in letters.
fn picture(parameters: &[u16], content: &[u8], into: &mut impl Write) -> Result<(), GcodeFileError> {
    let [format, width, height] = *parameters else { return Ok(()) };
    let (word, text) = (PICTURES[usize::from(format)], base64(content));
    writeln!(into, ";\n; {word} begin {width}x{height} {}", text.len())?;
    for line in text.as_bytes().chunks(PICTURE_LINE) {
        into.write_all(b"; ")?;
        into.write_all(line)?;
        into.write_all(b"\n")?;
    }
    Ok(writeln!(into, "; {word} end\n;")?)
}

/// Bytes in letters (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let value = (0..3).fold(0, |value, at| value << 8 | u32::from(three.get(at).copied().unwrap_or(0)));
        for at in 0..4 {
            let letter = LETTERS[(value >> (18 - 6 * at) & 63) as usize];
            text.push(if at <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}
