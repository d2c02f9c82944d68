//! The screen: one line on a terminal with the printer's state.

use corehbot::kinematics::ForwardKinematics;
use corehbot::motors::MOTORS;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_sim::world::World;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal as _;
use std::time::Duration;

/// Five times a second, as fast as one can read.
const PERIOD: Duration = Duration::from_millis(200);

/// Longest line that is worth to be kept until its end.
const LONGEST: usize = 200;

pub(crate) struct Screen {
    bar: ProgressBar,
    next: Duration,
    seen_tick: u32,
    /// The line that the printer is saying.
    spoken: String,
    /// The printer's last temperature report.
    temperatures: String,
    /// Where motors bring the tool.
    back: ForwardKinematics<{ MOTORS }>,
    /// Where the tool stood at power-up, in mm.
    start: [f64; 3],
    /// Steps a mm of x, y and z.
    pitch: [f64; 3],
}

impl Screen {
    /// A screen if standard error is a terminal, and `None` otherwise.
    pub fn new(settings: &Settings, start: [Mm; 3]) -> Self {
        let target =
            if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{wide_msg}") {
            bar.set_style(style);
        }
        let a = &settings.axes;
        Self {
            bar,
            next: Duration::ZERO,
            seen_tick: 0,
            spoken: String::new(),
            temperatures: "no temperatures yet".to_owned(),
            back: settings.mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE),
            start: start.map(Mm::to_num),
            pitch: [a.x.steps_per_mm, a.y.steps_per_mm, a.z.steps_per_mm].map(|pitch| pitch.to_num()),
        }
    }

    /// Reads temperature reports in the printer's output.
    pub fn hear(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if byte == b'\n' {
                if let Some(temperatures) = temperatures(&self.spoken) {
                    self.temperatures = temperatures.to_owned();
                }
                self.spoken.clear();
            } else if self.spoken.len() < LONGEST {
                self.spoken.push(char::from(byte));
            }
        }
    }

    /// Shows how the printer is, if it is time.
    pub fn show(&mut self, wall: Duration, world: &World<'_>) {
        if wall < self.next || self.bar.is_hidden() {
            return;
        }
        self.next = wall + PERIOD;
        let status = world.status();
        let is_moving = std::mem::replace(&mut self.seen_tick, status.tick()) != status.tick();
        let state = state([status.is_halted(), is_moving, status.is_awaiting_user(), status.is_awaiting_input()]);
        let [x, y, z] = self.place(world.outcome().counts);
        let level = status.level();
        let temperatures = &self.temperatures;
        let seconds = world.now() / u64::from(TICKS_PER_SECOND);
        let (minutes, seconds) = (seconds / 60, seconds % 60);
        self.bar.set_message(format!(
            "{state}  X{x:.2} Y{y:.2} Z{z:.2}  {level} moves ahead  {temperatures}  {minutes}:{seconds:02}"
        ));
        self.bar.tick();
    }

    /// Clears the line.
    pub fn close(&self) {
        self.bar.finish_and_clear();
    }

    /// Where the tool is, from the steps that the motors made.
    pub fn place(&self, counts: [i32; MOTORS]) -> [f64; 3] {
        let way = self.back.fractions(&counts.map(i64::from)).map(|(sum, over)| sum as f64 / over as f64);
        std::array::from_fn(|i| self.start[i] + way[i] / self.pitch[i])
    }
}

/// The printer's state: it has halted, moves, waits for its user, or waits for its host.
const fn state([is_halted, is_moving, is_for_user, is_for_host]: [bool; 4]) -> &'static str {
    if is_halted {
        "HALTED"
    } else if is_moving {
        "moving"
    } else if is_for_user {
        "paused, waits for the user"
    } else if is_for_host {
        "ready"
    } else {
        "busy"
    }
}

/// The temperatures in a line, without the duties of the heaters.
fn temperatures(line: &str) -> Option<&str> {
    let at = line.find("T:").filter(|at| *at == 0 || line[..*at].ends_with(' '))?;
    let text = &line[at..];
    Some(text.split_once(" @").map_or(text, |(text, _)| text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::per_motor;

    #[test]
    fn a_printer_that_waits_for_its_user_says_so() {
        assert_eq!(state([false, false, true, false]), "paused, waits for the user");
        assert_eq!(state([false, false, true, true]), "paused, waits for the user");
        assert_eq!(state([false, true, true, false]), "moving");
        assert_eq!(state([false, false, false, true]), "ready");
        assert_eq!(state([true, false, true, false]), "HALTED");
    }

    #[test]
    fn temperatures_are_found_in_answers_and_reports() {
        assert_eq!(temperatures("ok T:21.50 /0.00 B:22.10 /0.00 @:0 B@:0"), Some("T:21.50 /0.00 B:22.10 /0.00"));
        assert_eq!(temperatures(" T:20.0 /0.0"), Some("T:20.0 /0.0"));
        assert_eq!(temperatures("echo:UNIT:4"), None);
    }

    #[test]
    fn the_tool_is_where_the_belt_puts_it() {
        let screen = Screen::new(&Settings::prototype(), [1, 2, 3].map(Mm::from_num));
        let (n, up) = (screen.pitch[0] as i32, 2 * screen.pitch[2] as i32);
        // To the right by a millimetre, and up by two.
        assert_eq!(screen.place(per_motor(&[-n, -n, n, n, up, up], 0)), [2.0, 2.0, 5.0]);
    }
}
