//! SHA-256 by `ring`, for traces of gigabytes: a print waits for its digest more than for anything else.
//!
//! It chooses its code when it runs: the SHA extensions where the processor has them, otherwise its vectors.

use corehbot_sim::trace::Digest;
use ring::digest::{Context, SHA256};

/// A SHA-256 under way.
pub(crate) struct RingSha256(Context);

impl Default for RingSha256 {
    fn default() -> Self {
        Self(Context::new(&SHA256))
    }
}

impl Digest for RingSha256 {
    fn update(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    fn finish(self) -> [u8; 32] {
        let mut bytes = [0; 32];
        bytes.copy_from_slice(self.0.finish().as_ref());
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sha2::Sha256;

    /// Lengths around the blocks of 64 bytes, in one part, in two and in many.
    #[test]
    fn the_digest_is_that_of_sha2() {
        let bytes: Vec<u8> = (0..1000u32).map(|i| ((i * i) >> 3) as u8).collect();
        for length in (0..260).chain([511, 512, 513, 1000]) {
            let bytes = &bytes[..length];
            let parts = [vec![bytes], bytes.chunks(length / 2 + 1).collect(), bytes.chunks(7).collect()];
            for parts in parts {
                let (mut ours, mut other) = (RingSha256::default(), Sha256::default());
                for part in parts {
                    ours.update(part);
                    Digest::update(&mut other, part);
                }
                assert_eq!(ours.finish(), Digest::finish(other), "{length} bytes");
            }
        }
    }
}
