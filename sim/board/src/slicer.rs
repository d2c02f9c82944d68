//! Slicer: the notes that slicers leave in comments, about what is printed and of which filament.
//!
//! | slicer | line type | filament |
//! |---|---|---|
//! | PrusaSlicer, SuperSlicer, OrcaSlicer | `;TYPE:External perimeter` | `; filament_density = 1.24` |
//! | Bambu Studio | `; FEATURE: Outer wall` | the same |
//! | Cura, ideaMaker | `;TYPE:WALL-OUTER` | none |
//! | Simplify3D | `; feature outer perimeter`, before version 4.1 `; outer perimeter` | none |
//!
//! Slicers name the same things by different words. So each name has a [`Role`], found by the words in it.

use serde::{Serialize, Serializer};

/// What a line is for, whatever the slicer calls it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// No filament is laid.
    Travel,
    /// The outermost line of a wall.
    OuterWall,
    /// Other lines of a wall.
    InnerWall,
    /// Sparse infill, and what fills gaps.
    Infill,
    /// Solid layers, top and bottom.
    Skin,
    /// Supports and rafts.
    Support,
    /// Skirts and brims.
    Skirt,
    /// Filament that is laid to clean the nozzle.
    Purge,
    /// Lines over air.
    Bridge,
    /// Anything else.
    Other,
}

impl Role {
    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Travel => "travel",
            Self::OuterWall => "outer wall",
            Self::InnerWall => "inner wall",
            Self::Infill => "infill",
            Self::Skin => "skin",
            Self::Support => "support",
            Self::Skirt => "skirt",
            Self::Purge => "purge",
            Self::Bridge => "bridge",
            Self::Other => "other",
        }
    }
}

impl Serialize for Role {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Roles by words in the names of slicers, in lower case; the first that fits counts.
const ROLES: [(&str, Role); 26] = [
    ("bridge", Role::Bridge),
    ("overhang", Role::Bridge),
    ("skirt", Role::Skirt),
    ("brim", Role::Skirt),
    ("support", Role::Support),
    ("raft", Role::Support),
    ("prime", Role::Purge),
    ("purge", Role::Purge),
    ("wipe tower", Role::Purge),
    ("ooze shield", Role::Purge),
    ("flush", Role::Purge),
    ("external perimeter", Role::OuterWall),
    ("outer", Role::OuterWall),
    ("perimeter", Role::InnerWall),
    ("inner", Role::InnerWall),
    ("single extrusion", Role::InnerWall),
    ("sparse", Role::Infill),
    ("gap", Role::Infill),
    ("solid", Role::Skin),
    ("top surface", Role::Skin),
    ("bottom surface", Role::Skin),
    ("ironing", Role::Skin),
    ("skin", Role::Skin),
    ("infill", Role::Infill),
    ("fill", Role::Infill),
    ("internal", Role::Infill),
];

/// The role of a slicer's name for lines.
fn role_of(name: &str) -> Role {
    let name = name.to_ascii_lowercase();
    ROLES.iter().find(|(word, _)| name.contains(word)).map_or(Role::Other, |(_, role)| *role)
}

/// Comments by which Simplify3D named lines before version 4.1.
const PLAIN_NAMES: [&str; 13] = [
    "outer perimeter",
    "inner perimeter",
    "external single extrusion",
    "internal single extrusion",
    "single extrusion",
    "solid layer",
    "infill",
    "gap fill",
    "bridge",
    "skirt",
    "support",
    "dense support",
    "raft",
];

/// A type of line.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct LineType {
    /// As the slicer calls it.
    pub name: String,
    /// What it is for.
    pub role: Role,
}

/// Types that no comment names, by their index.
pub const TRAVEL: u16 = 0;
/// Filament goes back, and the tool stands.
pub const RETRACT: u16 = 1;
/// Filament is laid, and nothing says why.
pub const UNNAMED: u16 = 2;
/// Filament is laid before the print begins.
pub const PURGE: u16 = 3;
/// Filament goes forth, and the tool stands.
pub const PRIME: u16 = 4;
/// Filament goes back while the tool travels.
pub const WIPE: u16 = 5;

/// Keys of a slicer's estimate: PrusaSlicer and OrcaSlicer, Bambu Studio, Cura, Simplify3D, ideaMaker.
const ESTIMATES: [&str; 5] =
    ["estimated printing time (normal mode)", "model printing time", "TIME", "Build time", "Print Time"];

/// So many names are told apart: slicers have some twenty.
const MOST_TYPES: usize = 200;

/// The notes of a file, as far as it was read.
#[derive(Clone, PartialEq, Debug)]
pub struct Notes {
    types: Vec<LineType>,
    current: u16,
    /// A name other than the slicer's for start code was read, so the print has begun.
    has_begun: bool,
    /// Density of the filament in g/cm3, and its diameter in mm.
    filament: [Option<f64>; 2],
    /// The slicer's estimate of the time.
    estimate_s: Option<f64>,
}

impl Default for Notes {
    fn default() -> Self {
        let own = |(name, role): (&str, Role)| LineType { name: name.to_owned(), role };
        let types = [
            ("Travel", Role::Travel),
            ("Retract", Role::Travel),
            ("Without a name", Role::Other),
            ("Purge line", Role::Purge),
            ("Prime", Role::Travel),
            ("Wipe", Role::Travel),
        ];
        Self {
            types: types.map(own).to_vec(),
            current: UNNAMED,
            has_begun: false,
            filament: [None; 2],
            estimate_s: None,
        }
    }
}

impl Notes {
    /// The types so far; indices stay.
    #[must_use]
    pub fn types(&self) -> &[LineType] {
        &self.types
    }

    /// The type of lines that are read now.
    #[must_use]
    pub const fn current(&self) -> u16 {
        self.current
    }

    /// Density of the filament in g/cm3, if the file says it.
    #[must_use]
    pub const fn density(&self) -> Option<f64> {
        self.filament[0]
    }

    /// Its diameter in mm, if the file says it.
    #[must_use]
    pub const fn diameter(&self) -> Option<f64> {
        self.filament[1]
    }

    /// How long the print takes by the slicer's estimate in s, if the file says it.
    #[must_use]
    pub const fn estimate_s(&self) -> Option<f64> {
        self.estimate_s
    }

    /// Takes in a line of the file, whatever it is.
    pub fn read(&mut self, line: &str) {
        let Some(comment) = line.trim_start().strip_prefix(';') else { return };
        let comment = comment.trim();
        if let Some(name) = type_name(comment) {
            self.enter(name);
        } else if let Some((key, value)) = comment.split_once(['=', ':']) {
            self.note_filament(key.trim(), value);
            if ESTIMATES.contains(&key.trim()) {
                self.estimate_s = self.estimate_s.or(duration(value));
            }
        }
    }

    /// Lines are of that type from now on.
    fn enter(&mut self, name: &str) {
        // What a user has put there is start code before the first line of the print.
        let is_custom = name.eq_ignore_ascii_case("custom");
        if is_custom && !self.has_begun {
            self.current = PURGE;
            return;
        }
        self.has_begun |= !is_custom;
        let known = self.types.iter().position(|known| known.name == name);
        let index = known.unwrap_or(self.types.len());
        if index == self.types.len() && index < MOST_TYPES {
            self.types.push(LineType { name: name.to_owned(), role: role_of(name) });
        }
        self.current = if index < self.types.len() { index as u16 } else { UNNAMED };
    }

    fn note_filament(&mut self, key: &str, value: &str) {
        let place = match key {
            "filament_density" => 0,
            "filament_diameter" => 1,
            _ => return,
        };
        // A list has a value for each extruder. Slic3r writes 0 for an unknown density.
        let first = value.split([',', ';']).next().and_then(|text| text.trim().parse::<f64>().ok());
        if let Some(value) = first.filter(|value| value.is_finite() && *value > 0.0) {
            self.filament[place].get_or_insert(value);
        }
    }
}

/// A time such as ` 1d 2h 3m 4s`, ` 1 hour 2 minutes` or `3600`, in s.
fn duration(text: &str) -> Option<f64> {
    // Bambu Studio has another time after it in the same line.
    let text = text.split(';').next()?.trim();
    if let Ok(seconds) = text.parse::<f64>() {
        return Some(seconds).filter(|seconds| seconds.is_finite() && *seconds > 0.0);
    }
    let (mut sum, mut number) = (0.0, None);
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        let digits = word.find(|c: char| !c.is_ascii_digit()).unwrap_or(word.len());
        let (figures, unit) = word.split_at(digits);
        number = figures.parse::<u32>().ok().map(f64::from).or(number);
        let seconds = match unit.bytes().next() {
            Some(b'd') => 86_400.0,
            Some(b'h') => 3600.0,
            Some(b'm') => 60.0,
            Some(b's') => 1.0,
            Some(_) => return None,
            None => continue,
        };
        sum += number.take()? * seconds;
    }
    Some(sum).filter(|sum| *sum > 0.0)
}

/// The name of a type in a comment, if it names one.
fn type_name(comment: &str) -> Option<&str> {
    for mark in ["TYPE:", "FEATURE:", "feature "] {
        if let Some(name) = comment.strip_prefix(mark) {
            return Some(name.trim()).filter(|name| !name.is_empty());
        }
    }
    PLAIN_NAMES.contains(&comment).then_some(comment)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(lines: &[&str]) -> (String, Role) {
        let mut notes = Notes::default();
        lines.iter().for_each(|line| notes.read(line));
        let LineType { name, role } = notes.types()[usize::from(notes.current())].clone();
        (name, role)
    }

    #[test]
    fn every_slicer_s_words_have_their_role() {
        for (comment, name, role) in [
            // PrusaSlicer, src/libslic3r/ExtrusionRole.cpp.
            (";TYPE:External perimeter", "External perimeter", Role::OuterWall),
            (";TYPE:Perimeter", "Perimeter", Role::InnerWall),
            (";TYPE:Overhang perimeter", "Overhang perimeter", Role::Bridge),
            (";TYPE:Internal infill", "Internal infill", Role::Infill),
            (";TYPE:Solid infill", "Solid infill", Role::Skin),
            (";TYPE:Top solid infill", "Top solid infill", Role::Skin),
            (";TYPE:Bridge infill", "Bridge infill", Role::Bridge),
            (";TYPE:Gap fill", "Gap fill", Role::Infill),
            (";TYPE:Skirt/Brim", "Skirt/Brim", Role::Skirt),
            (";TYPE:Support material interface", "Support material interface", Role::Support),
            (";TYPE:Wipe tower", "Wipe tower", Role::Purge),
            (";TYPE:Ironing", "Ironing", Role::Skin),
            // OrcaSlicer and Bambu Studio.
            (";TYPE:Inner wall", "Inner wall", Role::InnerWall),
            ("; FEATURE: Outer wall", "Outer wall", Role::OuterWall),
            ("; FEATURE: Sparse infill", "Sparse infill", Role::Infill),
            ("; FEATURE: Internal solid infill", "Internal solid infill", Role::Skin),
            ("; FEATURE: Top surface", "Top surface", Role::Skin),
            ("; FEATURE: Prime tower", "Prime tower", Role::Purge),
            ("; FEATURE: Overhang wall", "Overhang wall", Role::Bridge),
            // Cura.
            (";TYPE:WALL-OUTER", "WALL-OUTER", Role::OuterWall),
            (";TYPE:WALL-INNER\r", "WALL-INNER", Role::InnerWall),
            (";TYPE:FILL", "FILL", Role::Infill),
            (";TYPE:SKIN", "SKIN", Role::Skin),
            (";TYPE:SKIRT", "SKIRT", Role::Skirt),
            (";TYPE:SUPPORT-INTERFACE", "SUPPORT-INTERFACE", Role::Support),
            (";TYPE:PRIME-TOWER", "PRIME-TOWER", Role::Purge),
            // Simplify3D.
            ("; feature solid layer", "solid layer", Role::Skin),
            ("; feature gap fill", "gap fill", Role::Infill),
            ("; outer perimeter", "outer perimeter", Role::OuterWall),
            ("; support", "support", Role::Support),
        ] {
            assert_eq!(after(&[comment]), (name.to_owned(), role), "{comment}");
        }
    }

    #[test]
    fn start_code_is_a_purge_and_later_code_is_not() {
        assert_eq!(after(&[";TYPE:Custom"]).1, Role::Purge);
        assert_eq!(after(&[";TYPE:Custom", ";TYPE:Skirt/Brim"]).1, Role::Skirt);
        assert_eq!(after(&[";TYPE:Perimeter", ";TYPE:Custom"]), ("Custom".to_owned(), Role::Other));
    }

    #[test]
    fn other_comments_are_no_types() {
        for comment in ["G1 X5 ;TYPE:Perimeter", "; perimeters extrusion width = 0.44mm", ";TYPE:", ";LAYER:3", ";"] {
            assert_eq!(after(&[comment]).0, "Without a name", "{comment}");
        }
    }

    #[test]
    fn every_slicer_s_estimate_is_read() {
        for (line, seconds) in [
            ("; estimated printing time (normal mode) = 1d 2h 3m 4s", Some(93_784.0)),
            ("; estimated printing time (silent mode) = 59s", None),
            ("; model printing time: 14m 20s; total estimated time: 20m 37s", Some(860.0)),
            (";TIME:5025", Some(5025.0)),
            (";TIME_ELAPSED:12.5", None),
            (";   Build time: 1 hour 2 minutes", Some(3720.0)),
            (";Print Time: 77", Some(77.0)),
            (";TIME:soon", None),
            (";TIME:-5", None),
        ] {
            let mut notes = Notes::default();
            notes.read(line);
            assert_eq!(notes.estimate_s(), seconds, "{line}");
        }
    }

    #[test]
    fn the_filament_is_read_once_and_must_make_sense() {
        let mut notes = Notes::default();
        for line in ["; filament_density = 0", "; filament_density: 1.27,1.24", "; filament_density = 1"] {
            notes.read(line);
        }
        notes.read("; filament_diameter = 2.85");
        assert_eq!((notes.density(), notes.diameter()), (Some(1.27), Some(2.85)));
    }
}
