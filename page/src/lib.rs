//! The page's worker: prints, machine files and a terminal, as a script calls them.
//!
//! Everything here is one thread's work on values in memory. A print runs to its end in one call and tells its progress
//! on the way; the script cancels it by ending the worker. A terminal is asked again and again to go on for a moment.
//!
//! | file | job |
//! |---|---|
//! | [`job`] | the machine, its plants and their accidents, as the page asks for them |
//! | [`opening`] | what a chosen file is, and its G-code |
//! | [`printing`] | a file printed to its end, with its trace's SHA-256 and its report |
//! | [`terminal`] | a printer at the end of a serial line |
//! | [`picture`] | frame, bar, head, motors and belts of a machine, for a drawing |
//! | [`editing`] | problems of a machine file, and its keys |

pub mod editing;
pub mod job;
pub mod opening;
pub mod picture;
pub mod printing;
pub mod terminal;

use job::Job;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// The script's function that shows how far a print is: commands answered, of all, and the printer's time in s.
    #[wasm_bindgen(js_name = tellProgress)]
    fn tell_progress(answered: f64, commands: f64, seconds: f64);

    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn complain(text: &str);
}

/// An error with its causes, as the script throws it.
fn thrown(error: &anyhow::Error) -> JsError {
    JsError::new(&format!("{error:#}"))
}

/// Called once when the worker begins: a panic leaves its words in the console.
#[wasm_bindgen(start)]
pub fn begin() {
    std::panic::set_hook(Box::new(|info| complain(&info.to_string())));
}

/// What a chosen file is, as JSON: `kind`, `plates`, and `trouble` if it is of no use here. `begin` is its first MiB,
/// or all of an archive; nothing if it cannot be read.
#[wasm_bindgen]
#[must_use]
pub fn told(begin: Option<Vec<u8>>, length: f64, is_machine_wanted: bool) -> String {
    opening::told(begin.as_deref(), length as u64, is_machine_wanted)
}

/// All problems of a machine file, as JSON.
#[wasm_bindgen]
#[must_use]
pub fn problems(text: &str) -> String {
    editing::problems(text)
}

/// The schema of machine files, as JSON.
#[wasm_bindgen]
#[must_use]
pub fn schema() -> String {
    corehbot_machine_file::schema().to_string()
}

/// Names of the boards that a new machine file can be for, as JSON.
#[wasm_bindgen]
#[must_use]
pub fn boards() -> String {
    editing::boards()
}

/// A new machine file for a board.
///
/// # Errors
/// No such board.
#[wasm_bindgen]
pub fn template(board: &str) -> Result<String, JsError> {
    editing::template(board).map_err(|error| thrown(&error))
}

/// The accidents that there are, as JSON.
#[wasm_bindgen]
#[must_use]
pub fn accidents() -> String {
    job::accidents()
}

/// What of a job's options cannot be, as JSON. `job` is JSON.
///
/// # Errors
/// The page asks for something unknown.
#[wasm_bindgen]
pub fn refusals(job: &str) -> Result<String, JsError> {
    Job::read(job).map(|job| job.refusals()).map_err(|error| thrown(&error))
}

/// A job's machine as a still picture, with its motors and pulleys, as JSON; or `why` there is none. `job` is JSON.
///
/// # Errors
/// The machine file's first error.
#[wasm_bindgen]
pub fn parts(job: &str) -> Result<String, JsError> {
    Job::read(job).and_then(|job| picture::still(&job.machine()?)).map_err(|error| thrown(&error))
}

/// The words of all that hands do to the machine at a terminal, as JSON.
#[wasm_bindgen]
#[must_use]
pub fn hands() -> String {
    terminal::hands()
}

/// A print that is done.
#[wasm_bindgen]
pub struct Printed(printing::Printed);

#[wasm_bindgen]
impl Printed {
    /// The summary, as JSON.
    #[must_use]
    pub fn summary(&self) -> String {
        self.0.summary.clone()
    }

    /// The summary in words, as `corehbot run` prints it.
    #[must_use]
    pub fn words(&self) -> String {
        self.0.words.clone()
    }

    /// The page of the report; it is given away.
    pub fn report(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.0.report)
    }
}

/// Prints a file as fast as it can be computed. `job` is JSON.
///
/// # Errors
/// What is wrong with the file, the machine or an accident.
#[wasm_bindgen]
pub fn print(job: &str, gcode: Vec<u8>) -> Result<Printed, JsError> {
    let job = Job::read(job).map_err(|error| thrown(&error))?;
    let printed = printing::print(&job, gcode, &mut tell_progress);
    printed.map(Printed).map_err(|error| thrown(&error))
}

/// A printer at the end of a serial line.
#[wasm_bindgen]
pub struct Terminal(terminal::Terminal);

#[wasm_bindgen]
impl Terminal {
    /// Switches it on. `job` is JSON.
    ///
    /// # Errors
    /// What is wrong with the machine or an accident.
    #[wasm_bindgen(constructor)]
    pub fn new(job: &str) -> Result<Self, JsError> {
        let job = Job::read(job).map_err(|error| thrown(&error))?;
        terminal::Terminal::new(&job).map(Self).map_err(|error| thrown(&error))
    }

    /// Bytes go to the printer.
    pub fn send(&self, text: &str) {
        self.0.send(text);
    }

    /// Something happens to the machine: `press x`, `let go`, `warm hotend`, `reset`, or an accident such as
    /// `open:hotend`.
    ///
    /// # Errors
    /// There is nothing of the kind.
    pub fn act(&self, what: &str) -> Result<(), JsError> {
        self.0.act(what).map_err(|error| thrown(&error))
    }

    /// Goes on for some milliseconds of the printer's time; returns what it has said.
    pub fn turn(&mut self, ms: f64) -> String {
        self.0.turn(ms)
    }

    /// What does not move in the picture, as JSON; or `why` there is none.
    #[must_use]
    pub fn frame(&self) -> String {
        self.0.frame()
    }

    /// The printer's state, and the belts as they are now, as JSON.
    #[must_use]
    pub fn state(&self) -> String {
        self.0.state()
    }
}
