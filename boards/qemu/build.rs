//! Link arguments: memory.x in the repository's root folder, with this board's addresses.

#[path = "../link.rs"]
mod link;

use std::env;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    if !link::is_for_board()? {
        return Ok(());
    }
    // link.x asks for a device.x that names the handlers of a vendor's table; here src/an386/vectors.rs
    // fills the whole table.
    let out = env::var("OUT_DIR")?;
    std::fs::write(Path::new(&out).join("device.x"), "")?;
    println!("cargo:rustc-link-search={out}");
    // The memory at 0 holds the vectors (ARM DAI 0386C, memory map). The sizes are the Octopus's but for two. The flash
    // also holds the plants of bed and heaters. The stack is deeper, because all handles are made at once here and the
    // plants compute in doubles.
    link::link(&[], &["--defsym=flash_start=0", "--defsym=flash_size=544K", "--defsym=stack_size=48K"]);
    Ok(())
}
