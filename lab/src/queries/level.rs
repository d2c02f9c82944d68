//! Level: racking of the bar and tilt of the gantry of a CoreXYZ, by its belts.
//!
//! A belt pulls the bar's two ends apart along y, and the gantry's two corners apart along z. So each belt alone racks
//! the bar and tilts the gantry; four alike cancel out (Carlyle, CoreXYZ, 2014). Belts with signs (sx, sy, sz) of their
//! rows rack with sx sy, tilt about x with sy sz and about y with sx sz times their mean tension.
//!
//! A belt that is taken up while its motor has no power slips over the motor until both sides have one tension. Motors
//! with power strain their belts by the one pattern that no place of the tool has, A - B + C - D. It is the pattern of
//! racking, so motors cannot level the gantry. Where both sides of a belt are not equally stiff, a thrust changes its
//! mean tension, so motion racks and tilts too. Off the middle the inertia of head and bar does as well: the bar yaws
//! about its own middle, and the gantry tilts about the machine's. `claims` holds what Carlyle says against all this.

mod claims;

use super::claim::{Claim, write_claims};
use corehbot_twin::model::gantry::{COORDINATES, Gantry, Given, TILT_X, TILT_Y, YAW};
use corehbot_twin::params::Params;
use corehbot_twin::queries::{At, shown};
use corehbot_twin::routing::{Machine, Place};
use serde::Serialize;

/// mm in a m, N mm in an N m, mrad in a rad.
const THOUSAND: f64 = 1000.0;

/// Names of a CoreXYZ's belts in the order of its routing (D, C, B, A): Carlyle's letters.
const BELTS: [&str; 4] = ["D", "C", "B", "A"];

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ask {
    /// Belt that is taken up, or let out, mm.
    pub taken_mm: f64,
    /// Stiffness of a spring idler in each belt, N/mm. It counts where belts slip over motors: levelling and preload.
    pub spring_n_per_mm: Option<f64>,
    /// Acceleration along each axis, m/s2.
    pub acceleration: f64,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// The same up.
    pub z_mm: f64,
    /// Belts taken up by this (shorter) or let out (longer).
    pub taken_up_mm: f64,
    /// Springs of the belts in the cases of levelling and preload.
    #[serde(rename = "spring_N_per_mm")]
    pub spring_n_per_mm: Option<f64>,
    /// Acceleration in the cases of motion.
    pub acceleration_m_s2: f64,
    /// The cases.
    pub cases: Vec<Case>,
    /// What the paper says.
    pub claims: Vec<Claim>,
}

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// How the belts are loaded.
    pub kind: Kind,
    /// What happens.
    pub name: String,
    /// Racking of the bar, counter-clockwise.
    pub bar_mrad: f64,
    /// Tilt of the gantry about x (back up) and about y (left up).
    pub gantry_mrad: [f64; 2],
    /// Height of the gantry's corners front left, front right, back right, back left, at the width and depth.
    pub corners_mm: [f64; 4],
    /// Moment on the guides of the bar.
    #[serde(rename = "bar_guides_Nm")]
    pub bar_nm: f64,
    /// Moments on the guides of the gantry about x and y.
    #[serde(rename = "gantry_guides_Nm")]
    pub gantry_nm: [f64; 2],
    /// Motion of the tool by belts along x, y and z; 0 where the tool is held.
    pub tool_mm: [f64; 3],
    /// Change of tension of each belt, or span.
    #[serde(rename = "tensions_N")]
    pub tensions_n: Vec<(&'static str, f64)>,
    /// Whether preload and change of a belt are below 0 together: the figures do not hold.
    pub goes_slack: bool,
}

/// How the belts are loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Belts are taken up, motors without power.
    Taken,
    /// Motors move.
    Motors,
    /// Belts at rest, with their preload.
    Preload,
    /// The tool accelerates, motors hold.
    Motion,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LevelError {
    /// The belts of this machine do not lift a gantry.
    NoGantry(&'static str),
    /// Nothing holds the bar or the gantry.
    NotHeld,
}

impl std::fmt::Display for LevelError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoGantry(name) => {
                write!(f, "the belts of a {name} lift no gantry: take --routing corexyz or corexyz-three")
            }
            Self::NotHeld => f.write_str("neither guides nor belts hold the bar and the gantry"),
        }
    }
}

impl std::error::Error for LevelError {}

/// Belts that are taken up (1) or let out (-1), as A, B, C, D.
const TAKEN: [(&str, [f64; 4]); 7] = [
    ("A shorter", [1.0, 0.0, 0.0, 0.0]),
    ("A shorter, C longer", [1.0, 0.0, -1.0, 0.0]),
    ("B shorter, D longer", [0.0, 1.0, 0.0, -1.0]),
    ("A, D shorter, B, C longer", [1.0, -1.0, -1.0, 1.0]),
    ("A, B shorter, C, D longer", [1.0, 1.0, -1.0, -1.0]),
    ("A, C shorter, B, D longer", [1.0, -1.0, 1.0, -1.0]),
    ("all shorter", [1.0; 4]),
];

/// Turns of the motors A, B, C, D: along the axes (Carlyle's table), and the pattern that no place of the tool has.
const MODES: [(&str, [f64; 4]); 4] = [
    ("motors +A +B -C -D: x", [1.0, 1.0, -1.0, -1.0]),
    ("motors +A -B -C +D: y", [1.0, -1.0, -1.0, 1.0]),
    ("motors +A +B +C +D: z", [1.0; 4]),
    ("motors +A -B +C -D: internal", [1.0, -1.0, 1.0, -1.0]),
];

impl Level {
    /// The answer for a machine about a place of its tool.
    ///
    /// # Errors
    /// The belts do not lift a gantry, or nothing holds it.
    pub fn new(machine: Machine, params: &Params, tool: Place, ask: Ask) -> Result<Self, LevelError> {
        if !matches!(machine, Machine::CoreXyz | Machine::CoreXyzThree) {
            return Err(LevelError::NoGantry(machine.name()));
        }
        let study = Study { machine, params, tool, ask };
        let cases = study.cases()?;
        let claims = study.claims(&cases)?;
        let at = At { machine: machine.key(), x_mm: tool.x, y_mm: tool.y };
        let Ask { taken_mm, spring_n_per_mm, acceleration } = ask;
        Ok(Self {
            at,
            z_mm: tool.z,
            taken_up_mm: taken_mm,
            spring_n_per_mm,
            acceleration_m_s2: acceleration,
            cases,
            claims,
        })
    }
}

struct Study<'p> {
    machine: Machine,
    params: &'p Params,
    tool: Place,
    ask: Ask,
}

impl Study<'_> {
    fn loose(&self) -> Gantry {
        let gantry = Gantry::loose(self.machine, self.params, self.tool);
        match self.ask.spring_n_per_mm {
            Some(spring) => gantry.with_springs(spring),
            None => gantry,
        }
    }

    fn cases(&self) -> Result<Vec<Case>, LevelError> {
        let mut cases = Vec::new();
        for (name, pattern) in TAKEN {
            cases.push(self.taken(name, pattern)?);
        }
        // Three motors have no pattern without a place.
        let modes = if self.machine == Machine::CoreXyz { &MODES[..] } else { &[] };
        for (name, pattern) in modes {
            cases.push(self.turned(name, *pattern, self.tool)?);
        }
        cases.push(self.preload("belts A, B and C alone", |belt| belt != 0)?);
        let all = if self.machine == Machine::CoreXyz { "four belts" } else { "with D over an idler" };
        cases.push(self.preload(all, |_| true)?);
        cases.extend(self.motions()?);
        Ok(cases)
    }

    /// Motion along each axis.
    fn motions(&self) -> Result<Vec<Case>, LevelError> {
        ["along x", "along y", "along z"].into_iter().enumerate().map(|(axis, name)| self.motion(axis, name)).collect()
    }

    /// Belts taken up by a pattern over A, B, C, D, motors without power.
    fn taken(&self, name: &str, pattern: [f64; 4]) -> Result<Case, LevelError> {
        let gantry = self.loose();
        let taken: Vec<f64> = pattern.iter().rev().map(|part| part * self.ask.taken_mm).collect();
        let given = gantry.settle(YAW, [0.0; COORDINATES], &taken).ok_or(LevelError::NotHeld)?;
        Ok(self.case(Kind::Taken, name, &gantry, &given))
    }

    /// Motors turned by a pattern over A, B, C, D. The springs of levelling do not matter here: they are not counted.
    fn turned(&self, name: &str, pattern: [f64; 4], tool: Place) -> Result<Case, LevelError> {
        let gantry = Gantry::held(self.machine, self.params, tool);
        let turns: Vec<f64> = pattern.iter().rev().map(|part| part * self.ask.taken_mm).collect();
        let taken: Vec<f64> = gantry
            .parts
            .iter()
            .map(|part| part.motors.iter().zip(&turns).map(|(row, turn)| row * turn).sum())
            .collect();
        let given = gantry.settle(0, [0.0; COORDINATES], &taken).ok_or(LevelError::NotHeld)?;
        Ok(self.case(Kind::Motors, name, &gantry, &given))
    }

    /// The preload of some belts (by their index: D, C, B, A), the others left out.
    fn preload(&self, name: &str, is_there: impl Fn(usize) -> bool) -> Result<Case, LevelError> {
        let mut gantry = self.loose();
        gantry.parts.retain(|part| is_there(part.belt));
        let mut force = [0.0; COORDINATES];
        for part in &gantry.parts {
            let tension = self.params.preload_n.of(part.belt);
            force.iter_mut().zip(part.row).for_each(|(force, row)| *force -= tension * row);
        }
        let given = gantry.settle(YAW, force, &vec![0.0; gantry.parts.len()]).ok_or(LevelError::NotHeld)?;
        Ok(self.case(Kind::Preload, name, &gantry, &given))
    }

    /// The tool accelerates along an axis: the inertia of what moves pulls the other way. A spring of a belt that its
    /// motor holds would be in one of its two parts; the springs of levelling are not counted.
    fn motion(&self, axis: usize, name: &str) -> Result<Case, LevelError> {
        let gantry = Gantry::held(self.machine, self.params, self.tool);
        let Params { width_mm, depth_mm, head_mass_kg: head, bar_mass_kg: bar, .. } = *self.params;
        let [right, back] = [self.tool.x - width_mm / 2.0, self.tool.y - depth_mm / 2.0];
        let [along_x, along_y, up] = self.machine.masses_kg(self.params);
        // Moments of mass, kg and kg mm, on x, y, z, the yaw and the tilts. The gantry's own is in its middle.
        let moved = match axis {
            0 => [along_x, 0.0, 0.0, 0.0, 0.0, 0.0],
            1 => [0.0, along_y, 0.0, head * right, 0.0, 0.0],
            _ => [0.0, 0.0, up, 0.0, (head + bar) * back, -head * right],
        };
        let force = moved.map(|moved| -moved * self.ask.acceleration);
        let given = gantry.settle(0, force, &vec![0.0; gantry.parts.len()]).ok_or(LevelError::NotHeld)?;
        Ok(self.case(Kind::Motion, name, &gantry, &given))
    }

    fn case(&self, kind: Kind, name: &str, gantry: &Gantry, given: &Given) -> Case {
        let Params { width_mm, depth_mm, .. } = *self.params;
        let [x, y, z, yaw, tilt_x, tilt_y] = given.moved;
        let rises = |right: f64, back: f64| tilt_x * back * depth_mm - tilt_y * right * width_mm;
        let on_guides =
            |at: usize| gantry.guides.get(at).zip(given.moved.get(at)).map_or(0.0, |(k, way)| k * way / THOUSAND);
        let is_belt = matches!(kind, Kind::Taken | Kind::Preload);
        let changes = || gantry.parts.iter().zip(&given.tensions_n);
        let tension = |(part, change): (&corehbot_twin::model::gantry::GantryPart, &f64)| {
            let name = if is_belt { BELTS.get(part.belt).copied().unwrap_or(part.name) } else { part.name };
            (name, *change)
        };
        Case {
            kind,
            name: name.to_owned(),
            bar_mrad: yaw * THOUSAND,
            gantry_mrad: [tilt_x, tilt_y].map(|tilt| tilt * THOUSAND),
            corners_mm: [rises(-0.5, -0.5), rises(0.5, -0.5), rises(0.5, 0.5), rises(-0.5, 0.5)],
            bar_nm: on_guides(YAW),
            gantry_nm: [on_guides(TILT_X), on_guides(TILT_Y)],
            tool_mm: [x, y, z],
            tensions_n: changes().map(tension).collect(),
            goes_slack: changes().any(|(part, change)| self.params.preload_n.of(part.belt) + change < 0.0),
        }
    }
}

impl std::fmt::Display for Level {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}, {:.1} mm up; angles in mrad, moments on guides in N m", self.at, self.z_mm)?;
        writeln!(f, "{:33}  {:>23}  {:>22}  tool moved by", "", "bar      gantry", "bar      gantry")?;
        writeln!(
            f,
            "{:33}  {:>7} {:>7} {:>7}  {:>6} {:>7} {:>7}  x, y, z mm",
            "", "racked", "about x", "about y", "", "about x", "about y"
        )?;
        let mut before = None;
        for case in &self.cases {
            if before != Some(case.kind) {
                let Self { taken_up_mm, acceleration_m_s2, .. } = self;
                match case.kind {
                    Kind::Taken => write!(f, "belts taken up by {taken_up_mm} mm, motors without power")?,
                    Kind::Motors => write!(f, "motors turned by {taken_up_mm} mm of belt")?,
                    Kind::Preload => write!(f, "preload at rest")?,
                    Kind::Motion => write!(f, "acceleration of {acceleration_m_s2} m/s2, motors holding")?,
                }
                match (self.spring_n_per_mm, case.kind) {
                    (None, _) => writeln!(f)?,
                    (Some(spring), Kind::Taken | Kind::Preload) => writeln!(f, ", springs of {spring} N/mm")?,
                    (Some(_), Kind::Motors | Kind::Motion) => writeln!(f, ", springs not counted")?,
                }
                before = Some(case.kind);
            }
            let [about_x, about_y] = case.gantry_mrad.map(|v| shown(v, 4));
            let [on_x, on_y] = case.gantry_nm.map(|v| shown(v, 3));
            let (bar, on_bar) = (shown(case.bar_mrad, 4), shown(case.bar_nm, 3));
            let tool = case.tool_mm.map(|v| shown(v, 4)).join(", ");
            let tool = if matches!(case.kind, Kind::Motors | Kind::Motion) { tool } else { String::new() };
            let name = &case.name;
            writeln!(f, "  {name:31}  {bar:>7} {about_x:>7} {about_y:>7}  {on_bar:>6} {on_x:>7} {on_y:>7}  {tool}")?;
        }
        let slack: Vec<&str> =
            self.cases.iter().filter(|case| case.goes_slack).map(|case| case.name.as_str()).collect();
        if !slack.is_empty() {
            writeln!(f, "belts go slack, so figures do not hold: {}", slack.join("; "))?;
        }
        writeln!(f, "\nwhat Carlyle says, on this machine")?;
        write_claims(f, &self.claims)
    }
}
