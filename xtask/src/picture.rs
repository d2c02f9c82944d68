//! `cargo xtask picture`: the pictures of the viewer in the README and in its reference, which are the report of a
//! print as a headless Chromium draws it.

use crate::checkout::{cargo, root, run, target_dir};
use anyhow::{Context as _, Result, ensure};
use std::fs;
use std::process::Command;

/// The most that a picture may weigh in the repository, in bytes.
const MOST_BYTES: u64 = 150_000;

/// Each picture in docs/pictures, the size of its window, and what is done with the viewer before it is taken.
const PICTURES: [(&str, &str, &str); 2] = [
    ("report.png", "1000,650", ""),
    (
        "viewer.png",
        "800,560",
        "view.stage.setAbove(false);
        const list = document.querySelector('label select');
        list.value = 'speed';
        list.onchange();
        const marks = [...document.querySelectorAll('[aria-label=Marks] label')];
        marks.find(label => label.textContent.trim().startsWith('seams')).querySelector('input').click();",
    ),
];

/// Runs the print, and draws its page for each picture.
pub fn main() -> Result<()> {
    let page = target_dir()?.join("report.html");
    let mut print = cargo(["run", "--quiet", "--release", "-p", "corehbot-cli", "--", "run"]);
    print.arg(root().join("examples/first-print.gcode")).arg("--report").arg(&page);
    run(print)?;
    let report = fs::read_to_string(&page).with_context(|| format!("cannot read {}", page.display()))?;
    for (name, size, acts) in PICTURES {
        let script = format!(
            "<script>const timer = setInterval(() => {{
                const view = document.querySelector('.viewer')?.corehbotView;
                if (!view) return;
                clearInterval(timer);
                {acts}
            }}, 50);</script>"
        );
        fs::write(&page, report.clone() + &script).with_context(|| format!("cannot write {}", page.display()))?;
        let picture = root().join("docs/pictures").join(name);
        let mut browser = Command::new("chromium");
        // A container has no sandbox, and no graphics; the page is ours. The picture is taken after so many ms: lines
        // are drawn over several frames.
        browser.args(["--headless", "--no-sandbox", "--hide-scrollbars"]).arg(format!("--window-size={size}"));
        browser.args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--timeout=15000"]);
        browser.arg(format!("--screenshot={}", picture.display()));
        browser.arg(format!("file://{}", page.display()));
        run(browser).context("a headless browser draws the page: apt-get install chromium")?;
        let size = fs::metadata(&picture)?.len();
        ensure!(size <= MOST_BYTES, "{}: {size} bytes, {MOST_BYTES} at most", picture.display());
        println!("{}: {size} bytes", picture.display());
    }
    Ok(())
}
