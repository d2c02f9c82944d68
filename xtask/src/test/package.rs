//! The packages of the core and of its macros, as a registry would get them: the embedding example is built on them and
//! runs.

use crate::checkout::{cargo, command_output, root, run, target_dir};
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, ensure};
use flate2::read::GzDecoder;
use std::fs::{self, File};
use std::path::Path;

/// The packages: the core, and the macros that pack its texts.
const PACKAGES: [&str; 2] = ["corehbot", "corehbot-text-macro"];

/// The example's own manifest. The packages lie beside it, in folders of their names.
const MANIFEST: &str = "\
[workspace]

[package]
name = \"embed\"
version = \"0.0.0\"
edition = \"2024\"

[dependencies]
corehbot = { path = \"../corehbot\" }

[patch.crates-io]
corehbot-text-macro = { path = \"../corehbot-text-macro\" }

[profile.dev]
debug = 0
";

/// Packs both, and runs the example on the packages.
pub fn check() -> Result<Verdict> {
    // Packed without a build: the example builds what was packed.
    let mut package = cargo(["package", "--quiet", "--no-verify", "--allow-dirty", "--exclude-lockfile"]);
    package.args(PACKAGES.map(|name| ["--package", name]).as_flattened());
    run(package)?;
    let folder = target_dir()?.join("package");
    let mut bytes = 0;
    for name in PACKAGES {
        let packed = folder.join(format!("{name}-{}.crate", env!("CARGO_PKG_VERSION")));
        unpack(&packed, &folder, name)?;
        bytes += fs::metadata(&packed)?.len();
    }
    let example = folder.join("embed");
    fs::create_dir_all(example.join("src"))?;
    fs::write(example.join("Cargo.toml"), MANIFEST)?;
    fs::copy(folder.join("corehbot/examples/embed.rs"), example.join("src/main.rs"))?;
    // The versions that everything else here is tested with.
    fs::copy(root().join("Cargo.lock"), example.join("Cargo.lock"))?;
    let mut example_on_package = cargo(["run", "--quiet", "--manifest-path"]);
    example_on_package.arg(example.join("Cargo.toml")).arg("--target-dir").arg(folder.join("build"));
    let said = command_output(example_on_package)?;
    ensure!(said.contains("step events"), "the example on the package printed no steps:\n{said}");
    Ok(Verdict::Passed(format!("{} KB packed", bytes / 1000)))
}

/// Unpacks a package into the folder of its name in `folder`, which replaces an older one.
fn unpack(packed: &Path, folder: &Path, package: &str) -> Result<()> {
    let file = File::open(packed).with_context(|| format!("cannot open {}", packed.display()))?;
    let [fresh, there] = ["unpacked", package].map(|name| folder.join(name));
    for old in [&fresh, &there] {
        if old.exists() {
            fs::remove_dir_all(old).with_context(|| format!("cannot remove {}", old.display()))?;
        }
    }
    tar::Archive::new(GzDecoder::new(file)).unpack(&fresh)?;
    let name = packed.file_stem().context("a package has a name")?;
    fs::rename(fresh.join(name), &there)?;
    fs::remove_dir(fresh)?;
    Ok(())
}
