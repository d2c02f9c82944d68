//! Writers of packed files, by their specifications and not by the readers: nothing here is shared with them but the
//! compressor of flate2, which is the other half of what inflates.

use flate2::Compression;
use flate2::write::{DeflateEncoder, GzEncoder, ZlibEncoder};
use std::io::Write as _;

/// CRC-32 bit by bit (ISO 3309).
pub fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

pub fn gzip(text: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text).unwrap();
    packed.finish().unwrap()
}

pub fn zlib(content: &[u8]) -> Vec<u8> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    packed.write_all(content).unwrap();
    packed.finish().unwrap()
}

/// Heatshrink with the longest repetition at each place.
pub fn heatshrink(content: &[u8], window: u32, lookahead: u32) -> Vec<u8> {
    let mut bits: Vec<bool> = Vec::new();
    let mut put = |value: usize, count: u32| bits.extend((0..count).rev().map(|bit| value >> bit & 1 == 1));
    let mut at = 0;
    while at < content.len() {
        let farthest = at.saturating_sub(1 << window);
        let length = |from: usize| {
            let most = (content.len() - at).min(1 << lookahead);
            (0..most).take_while(|n| content[from + n] == content[at + n]).count()
        };
        match (farthest..at).rev().map(|from| (length(from), from)).max_by_key(|(length, _)| *length) {
            Some((length, from)) if length > 2 => {
                put(0, 1);
                put(at - from - 1, window);
                put(length - 1, lookahead);
                at += length;
            }
            _ => {
                put(1, 1);
                put(content[at].into(), 8);
                at += 1;
            }
        }
    }
    bits.chunks(8)
        .map(|byte| byte.iter().enumerate().fold(0, |sum, (bit, is)| sum | u8::from(*is) << (7 - bit)))
        .collect()
}

/// MeatPack without blanks. Comments go, or stay as lines outside of the packing.
pub fn meatpack(text: &str, keeps_comments: bool) -> Vec<u8> {
    let half = |c: u8| match c {
        b'0'..=b'9' => Some(c - b'0'),
        b'.' => Some(10),
        b'E' => Some(11),
        b'\n' => Some(12),
        b'G' => Some(13),
        b'X' => Some(14),
        _ => None,
    };
    let mut packed = vec![255, 255, 251, 255, 255, 247];
    let mut is_packing = true;
    for line in text.lines() {
        if line.starts_with(';') {
            if keeps_comments {
                if std::mem::take(&mut is_packing) {
                    packed.extend([255, 255, 250]);
                }
                packed.extend(line.bytes().chain([b'\n']));
            }
            continue;
        }
        let bare = line.split(';').next().unwrap_or_default().trim();
        if bare.is_empty() {
            continue;
        }
        if !std::mem::replace(&mut is_packing, true) {
            packed.extend([255, 255, 251]);
        }
        let bare = if bare.starts_with('G') { bare.replace(' ', "") } else { bare.to_owned() } + "\n";
        for pair in bare.as_bytes().chunks(2) {
            let [first, second] = [pair[0], pair.get(1).copied().unwrap_or(b'\n')];
            packed.push(half(first).unwrap_or(15) | half(second).unwrap_or(15) << 4);
            packed.extend([first, second].iter().filter(|c| half(**c).is_none()));
        }
    }
    packed
}

/// A block of binary G-code.
pub struct Block {
    pub kind: u16,
    pub packing: u16,
    pub parameters: Vec<u16>,
    pub content: Vec<u8>,
}

/// A block as it lies in a file.
pub fn block(Block { kind, packing, parameters, content }: &Block, has_checksum: bool) -> Vec<u8> {
    let packed = match packing {
        0 => content.clone(),
        1 => zlib(content),
        2 => heatshrink(content, 11, 4),
        _ => heatshrink(content, 12, 4),
    };
    let mut bytes = [&kind.to_le_bytes()[..], &packing.to_le_bytes(), &(content.len() as u32).to_le_bytes()].concat();
    if *packing > 0 {
        bytes.extend((packed.len() as u32).to_le_bytes());
    }
    parameters.iter().for_each(|parameter| bytes.extend(parameter.to_le_bytes()));
    bytes.extend(packed);
    if has_checksum {
        bytes.extend(crc(&bytes).to_le_bytes());
    }
    bytes
}

/// A file of such blocks.
pub fn binary(blocks: &[Block], has_checksums: bool) -> Vec<u8> {
    let mut bytes = [&b"GCDE"[..], &1_u32.to_le_bytes(), &u16::from(has_checksums).to_le_bytes()].concat();
    blocks.iter().for_each(|each| bytes.extend(block(each, has_checksums)));
    bytes
}

/// A ZIP archive of files with names, each deflated or stored (PKWARE's APPNOTE, 4.3).
pub fn zip(files: &[(&str, &[u8])], is_deflated: bool) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let packed = if is_deflated {
            let mut packed = DeflateEncoder::new(Vec::new(), Compression::default());
            packed.write_all(content).unwrap();
            packed.finish().unwrap()
        } else {
            content.to_vec()
        };
        let at = bytes.len() as u32;
        let mut common =
            [&20_u16.to_le_bytes()[..], &[0; 2], &(8 * u16::from(is_deflated)).to_le_bytes(), &[0; 4]].concat();
        common.extend(crc(content).to_le_bytes());
        for length in [packed.len(), content.len()] {
            common.extend((length as u32).to_le_bytes());
        }
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0; 2]);
        bytes.extend([&b"PK\x03\x04"[..], &common, name.as_bytes(), &packed].concat());
        directory.extend([&b"PK\x01\x02\x14\0"[..], &common, &[0; 10], &at.to_le_bytes(), name.as_bytes()].concat());
    }
    let (at, count) = (bytes.len() as u32, files.len() as u16);
    bytes.extend(&directory);
    bytes.extend([&b"PK\x05\x06\0\0\0\0"[..], &count.to_le_bytes(), &count.to_le_bytes()].concat());
    bytes.extend([&(directory.len() as u32).to_le_bytes()[..], &at.to_le_bytes(), &[0; 2]].concat());
    bytes
}
