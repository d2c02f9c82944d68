//! `corehbot-lab figures`: the schematics, table 1 and the numbers of the CoreH-bot paper, as drawings and a page.

use crate::drawings::figures::{Figure, figures};
use crate::queries::paper::Paper;
use anyhow::{Context as _, Result, ensure};
use clap::Args;
use corehbot_host::answer::Json;
use std::io::Write as _;
use std::path::PathBuf;

/// `corehbot-lab figures`.
#[derive(Args)]
pub(crate) struct Figures {
    /// The folder for the drawings (SVG) and their page (README.md); it is created if it does not exist.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    #[command(flatten)]
    json: Json,
}

impl Figures {
    pub(crate) fn answer(&self) -> Result<u8> {
        std::fs::create_dir_all(&self.folder)
            .with_context(|| format!("cannot create the folder {}", self.folder.display()))?;
        let paper = Paper::new();
        let figures = figures(&paper);
        for page in figures.iter().filter(|figure| figure.name.ends_with(".md")) {
            self.check_page(page)?;
        }
        self.json.give_with(&paper, [], |outputs| {
            figures.iter().try_for_each(|figure| {
                let mut out = outputs.open(&self.folder.join(figure.name))?;
                out.write_all(figure.text.as_bytes()).and_then(|()| out.flush()).context("cannot write the drawing")
            })
        })
    }

    /// A page of that name in the folder must be an earlier one of the command: a project's README.md is not lost.
    fn check_page(&self, page: &Figure) -> Result<()> {
        let path = self.folder.join(page.name);
        let Ok(there) = std::fs::read(&path) else { return Ok(()) };
        let title = page.text.lines().next().unwrap_or_default();
        let is_own = there.is_empty() || there.starts_with(title.as_bytes());
        ensure!(is_own, "{} does not begin with `{title}`: choose another folder", path.display());
        Ok(())
    }
}
