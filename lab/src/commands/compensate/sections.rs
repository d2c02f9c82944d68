//! Sections: a G-code file as stretches of motion and the commands between them.
//!
//! A stretch continues as long as no command makes the motion end. Commands that set limits, the feed, shapers or the
//! advance shape the plan of the stretch and belong to it. Commands for heat, fans and displays are carried out under
//! way. Every other command, such as homing, waiting or switching motors off, stands alone between two stretches.

use corehbot_sim::file_line::{command_of, words};
use corehbot_twin::math::{atan2, hypot, square};
use std::fmt::Write as _;

/// A part of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Section {
    /// Moves, and commands carried out under way.
    Motion(Vec<Line>),
    /// A command that motion ends for.
    Still(String),
}

/// A command of a stretch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    pub text: String,
    /// The part of the stretch's path that lies before the command's end, of 1.
    pub part: f64,
    pub kind: Kind,
}

/// The role of a command in a stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// It moves the tool or the filament.
    Move,
    /// It changes how the next ones are read.
    Mode,
    /// It changes how moves are planned.
    Plan,
    /// It is carried out under way.
    Aside,
    /// Motion ends for it.
    Still,
}

impl Kind {
    fn of(text: &str) -> Self {
        let first = words(text).next();
        match first {
            Some(('G', Some(0.0..=3.0 | 10.0 | 11.0))) => Self::Move,
            Some(('G', Some(17.0..=19.0 | 20.0 | 21.0 | 90.0 | 91.0)) | ('M', Some(82.0 | 83.0))) => Self::Mode,
            Some(('M', Some(201.0 | 203.0..=205.0 | 220.0 | 221.0 | 593.0 | 572.0 | 900.0))) => Self::Plan,
            _ if text.starts_with("SET_VELOCITY_LIMIT") || text.starts_with("SET_PRESSURE_ADVANCE") => Self::Plan,
            Some(
                ('M', Some(73.0 | 104.0..=107.0 | 114.0 | 117.0 | 118.0 | 140.0 | 141.0 | 290.0 | 486.0))
                | ('G', Some(92.0)),
            ) => Self::Aside,
            _ => Self::Still,
        }
    }
}

/// Whether a command gives the place where the tool is another name.
pub(super) fn is_origin(text: &str) -> bool {
    matches!(words(text).next(), Some(('G', Some(92.0))))
}

/// Whether a command about planning is also written where moves come planned. Only greatest speeds are, because they
/// belong to motors and screws.
pub(super) fn is_kept(text: &str) -> bool {
    matches!(words(text).next(), Some(('M', Some(203.0))))
}

/// How the words of moves are to be read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Modes {
    pub is_relative: bool,
    pub is_e_relative: bool,
    pub are_inches: bool,
    at: [f64; 4],
}

impl Modes {
    /// As a printer begins.
    pub(super) const NEW: Self = Self { is_relative: false, is_e_relative: false, are_inches: false, at: [0.0; 4] };

    /// Takes a command and returns the rough length of its path: this gives the place on the way at which a fan is
    /// switched.
    pub(super) fn take(&mut self, text: &str) -> f64 {
        let mut all = words(text);
        let first = all.next();
        match first {
            Some(('G', Some(20.0))) => self.are_inches = true,
            Some(('G', Some(21.0))) => self.are_inches = false,
            Some(('G', Some(90.0))) => (self.is_relative, self.is_e_relative) = (false, false),
            Some(('G', Some(91.0))) => (self.is_relative, self.is_e_relative) = (true, true),
            Some(('M', Some(82.0))) => self.is_e_relative = false,
            Some(('M', Some(83.0))) => self.is_e_relative = true,
            Some(('G', Some(0.0..=3.0 | 92.0))) => return self.go(first, all),
            _ => {}
        }
        0.0
    }

    fn go(&mut self, first: Option<(char, Option<f64>)>, all: impl Iterator<Item = (char, Option<f64>)>) -> f64 {
        let unit = if self.are_inches { 25.4 } else { 1.0 };
        let (from, mut centre) = (self.at, None);
        for (letter, value) in all {
            let Some(value) = value.map(|value| value * unit) else { continue };
            let axis = match letter {
                'X' => 0,
                'Y' => 1,
                'Z' => 2,
                'E' => 3,
                'I' => {
                    centre.get_or_insert([0.0; 2])[0] = value;
                    continue;
                }
                'J' => {
                    centre.get_or_insert([0.0; 2])[1] = value;
                    continue;
                }
                _ => continue,
            };
            let is_set = matches!(first, Some(('G', Some(92.0))));
            let is_relative = if axis == 3 { self.is_e_relative } else { self.is_relative };
            self.at[axis] = if is_relative && !is_set { self.at[axis] + value } else { value };
        }
        match (first, centre) {
            (Some(('G', Some(92.0))), _) => 0.0,
            (Some(('G', Some(number))), Some([i, j])) if number >= 2.0 => {
                let [begin, end] = [from, self.at].map(|at| atan2(at[1] - from[1] - j, at[0] - from[0] - i));
                let turn = if number < 2.5 { begin - end } else { end - begin };
                hypot(i, j)
                    * if turn.abs() < 1e-9 { std::f64::consts::TAU } else { turn.rem_euclid(std::f64::consts::TAU) }
            }
            _ => {
                let way: f64 = self.at.iter().zip(from).take(3).map(|(to, from)| square(to - from)).sum();
                way.sqrt()
            }
        }
    }

    /// The lines that set them after a stretch, and that name its end. On the way the tool is ahead of its path, and
    /// filament goes by its steps, flow and all.
    pub(super) fn text(self, stretch: &[Line]) -> String {
        let mut origin = String::new();
        for (letter, at) in ['X', 'Y', 'Z', 'E'].into_iter().zip(self.at) {
            let named = |line: &Line| {
                let is_said = letter == 'E' && line.kind == Kind::Move || is_origin(&line.text);
                is_said && words(&line.text).any(|(word, _)| word == letter)
            };
            if stretch.iter().any(named) {
                let _ = write!(origin, " {letter}{:.5}", at);
            }
        }
        if !origin.is_empty() {
            origin = format!("G21\nG92{origin}\n");
        }
        let units = if self.are_inches { "G20" } else { "G21" };
        let places = if self.is_relative { "G91" } else { "G90" };
        let filament = if self.is_e_relative { "M83" } else { "M82" };
        format!("{origin}{units}\n{places}\n{filament}\n")
    }
}

/// The sections of a file, and the modes after each.
pub(super) fn sections(gcode: &str) -> Vec<(Section, Modes)> {
    let mut sections: Vec<(Section, Modes)> = Vec::new();
    let mut modes = Modes::NEW;
    let mut length = 0.0;
    for line in gcode.lines() {
        let (command, _) = command_of(line);
        if command.is_empty() {
            continue;
        }
        let text = command.into_owned();
        let kind = Kind::of(&text);
        let way = modes.take(&text);
        match (kind, sections.last_mut()) {
            (Kind::Still, _) => sections.push((Section::Still(text), modes)),
            (kind, Some((Section::Motion(lines), after))) => {
                length += way;
                *after = modes;
                lines.push(Line { text, part: length, kind });
            }
            (kind, _) => {
                length = way;
                sections.push((Section::Motion(vec![Line { text, part: length, kind }]), modes));
            }
        }
    }
    for (section, _) in &mut sections {
        let Section::Motion(lines) = section else { continue };
        let whole = lines.last().map_or(0.0, |line| line.part).max(f64::MIN_POSITIVE);
        lines.iter_mut().for_each(|line| line.part /= whole);
    }
    sections
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_ends_for_what_needs_it_and_goes_on_for_fans() {
        let found = sections("G28\nG1 X10 ; go\nM106 S255\nM204 P500 R900\nG1 X30\nM109 S200\nG91\nG1 Y5\n");
        let [(home, _), (motion, _), (heat, _), (rest, modes)] = &found[..] else { panic!("{found:?}") };
        assert_eq!((home, heat), (&Section::Still("G28".into()), &Section::Still("M109 S200".into())));
        let Section::Motion(lines) = motion else { panic!() };
        let kinds: Vec<_> = lines.iter().map(|line| (line.kind, (30.0 * line.part).round() as i32)).collect();
        assert_eq!(kinds, [(Kind::Move, 10), (Kind::Aside, 10), (Kind::Plan, 10), (Kind::Move, 30)]);
        assert!(matches!(rest, Section::Motion(lines) if lines.len() == 2) && modes.is_relative);
    }

    #[test]
    fn an_arc_is_as_long_as_it_is() {
        let mut modes = Modes::NEW;
        assert!((modes.take("G1 X3 Y4") - 5.0).abs() < 1e-9);
        assert!((modes.take("G3 X1 Y4 I-1 J0") - std::f64::consts::PI).abs() < 1e-9);
        assert!((modes.take("G2 X1 Y4 I1 J0") - std::f64::consts::TAU).abs() < 1e-9);
    }
}
