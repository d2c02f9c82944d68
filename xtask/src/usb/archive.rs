//! A memory disk as the kernel takes it: cpio, "newc" (the kernel's Documentation/driver-api/early-userspace,
//! buffer-format).

/// Bits of a file's mode: folder, file, and who may do what.
const FOLDER: u32 = 0o040_755;
const FILE: u32 = 0o100_644;
const PROGRAM: u32 = 0o100_755;

/// The last entry.
const END: &str = "TRAILER!!!";

/// The disk under way.
#[derive(Default)]
pub struct Archive {
    bytes: Vec<u8>,
    entries: u32,
}

impl Archive {
    /// Adds a folder.
    pub fn folder(&mut self, name: &str) {
        self.add(name, FOLDER, &[]);
    }

    /// Adds a file.
    pub fn file(&mut self, name: &str, bytes: &[u8]) {
        self.add(name, FILE, bytes);
    }

    /// Adds a program.
    pub fn program(&mut self, name: &str, bytes: &[u8]) {
        self.add(name, PROGRAM, bytes);
    }

    /// The whole disk.
    pub fn end(mut self) -> Vec<u8> {
        self.add(END, 0, &[]);
        self.bytes
    }

    fn add(&mut self, name: &str, mode: u32, bytes: &[u8]) {
        self.entries += 1;
        // Number, mode, owner, group, links, time, size, two devices of two numbers each, length of the name, sum.
        let fields = [self.entries, mode, 0, 0, 1, 0, bytes.len() as u32, 0, 0, 0, 0, name.len() as u32 + 1, 0];
        self.bytes.extend(b"070701");
        self.bytes.extend(fields.iter().flat_map(|field| format!("{field:08X}").into_bytes()));
        self.bytes.extend(name.as_bytes());
        self.bytes.push(0);
        self.pad();
        self.bytes.extend(bytes);
        self.pad();
    }

    /// Names and files begin at multiples of four.
    fn pad(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_has_its_header_its_name_and_its_bytes_at_multiples_of_four() {
        let mut archive = Archive::default();
        archive.program("init", b"#!/x");
        let bytes = archive.end();
        let header = "070701 00000001 000081ED 00000000 00000000 00000001 00000000 00000004 00000000 00000000 00000000 \
                      00000000 00000005 00000000";
        let expected = [header.replace(' ', "").as_bytes(), b"init\0\0", b"#!/x"].concat();
        assert_eq!(&bytes[..expected.len()], expected);
        assert_eq!(bytes.len() % 4, 0);
        assert!(bytes.windows(END.len()).any(|part| part == END.as_bytes()));
    }
}
