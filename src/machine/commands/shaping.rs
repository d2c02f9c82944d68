//! Shaping: input shapers (M593) and pressure advance (M900, M572) as lines set them.

use crate::gcode::{Number, ShaperName, ShaperWords};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::says::Facts;
use crate::machine::answers::setting::Setting;
use crate::machine::answers::speaker::Speaker;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::shortest;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::motion::advance_window;
use crate::port::Wake;
use crate::settings::{Advance, Settings, Shaper, ShaperKind, Shapers, ranges};
use crate::text::Packed;
use crate::units::{Hertz, Ratio};

/// The kind of shaper with that number in M593 T.
fn kind_of(number: Number) -> Option<ShaperKind> {
    ShaperName::of(number).map(|name| match name {
        ShaperName::Zv => ShaperKind::Zv,
        ShaperName::Zvd => ShaperKind::Zvd,
        ShaperName::Mzv => ShaperKind::Mzv,
        ShaperName::Ei => ShaperKind::Ei,
        ShaperName::TwoHumpEi => ShaperKind::TwoHumpEi,
    })
}

impl ShaperWords {
    /// These words as values, if they are in range.
    fn legal(&self, clamps: &mut Clamps) -> LegalWords {
        // 0 is off.
        let frequency = self.frequency.map(|number| {
            (number > Number::ZERO).then(|| clamps.near_of(["M593", "F"], number, ranges::FREQUENCY, None)).flatten()
        });
        let damping = self.damping.and_then(|number| clamps.near_of(["M593", "D"], number, ranges::DAMPING, None));
        LegalWords { frequency, damping }
    }
}

/// [`ShaperWords`] as values.
struct LegalWords {
    frequency: Option<Option<Hertz>>,
    damping: Option<Ratio>,
}

impl LegalWords {
    /// `shaper` as these words, which choose `kind` if any, want it.
    fn change(&self, shaper: Shaper, kind: Option<ShaperKind>) -> Shaper {
        let mut wanted = Shaper { kind: kind.unwrap_or(shaper.kind), ..shaper };
        wanted.damping = self.damping.unwrap_or(wanted.damping);
        match self.frequency {
            Some(Some(frequency)) => {
                wanted.frequency = frequency;
                if wanted.kind == ShaperKind::None {
                    wanted.kind = ShaperKind::Zv;
                }
            }
            Some(None) => wanted.kind = ShaperKind::None,
            None => {}
        }
        wanted
    }
}

impl ShaperWords {
    /// Whether they change nothing and ask for a report.
    fn are_a_question(&self) -> bool {
        self.frequency.or(self.damping).or(self.kind).is_none()
    }

    /// `shapers` as these words want them; `None` if there is no such kind of shaper.
    fn change(&self, mut shapers: Shapers, clamps: &mut Clamps) -> Option<Shapers> {
        let kind = self.kind.and_then(kind_of);
        if self.kind.is_some() && kind.is_none() {
            return None;
        }
        let legal = self.legal(clamps);
        let are_both = !self.axes.x && !self.axes.y;
        for (shaper, is_named) in [(&mut shapers.x, self.axes.x), (&mut shapers.y, self.axes.y)] {
            if is_named || are_both {
                *shaper = legal.change(*shaper, kind);
            }
        }
        Some(shapers)
    }
}

/// The answer of M593 to an unknown kind.
const NO_SUCH_KIND: Packed =
    packed!("echo:M593 ignored: T is 0 (ZV), 1 (ZVD), 2 (MZV), 3 (EI) or 4 (2HUMP_EI), or P one of these names");

/// The advance that M900 K and M572 W want, if they are in range; W0 is the window that suits the shapers.
fn wanted_advance(time: Option<Number>, window: Option<Number>, s: &Settings, clamps: &mut Clamps) -> Advance {
    let mut wanted = *s;
    if let Some(time) = time {
        clamps.near(["M900", "K"], time, ranges::ADVANCE, &mut wanted.advance.time);
    }
    if window == Some(Number::ZERO) {
        wanted.advance.window = None;
    } else if let Some(window) = window {
        let mut seconds = advance_window(&wanted);
        clamps.near(["M572", "W"], window, ranges::ADVANCE_WINDOW, &mut seconds);
        wanted.advance.window = Some(seconds);
    }
    wanted.advance
}

/// M593. Motion comes to rest before a shaper changes.
pub(in crate::machine) async fn change_shapers<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    words: &ShaperWords,
) -> Result<Answer<'static>, Interrupt> {
    if words.are_a_question() {
        return Ok(Answer::Setting(Setting::Shapers));
    }
    let mut wanted = *main_loop.settings;
    let Some(shapers) = words.change(wanted.shapers, clamps) else {
        return Ok(Answer::Line(NO_SUCH_KIND));
    };
    wanted.shapers = shapers;
    if !clamps.refuses_line() && wanted.shapers != main_loop.settings.shapers {
        main_loop.finish().await?;
        main_loop.use_settings(&wanted).await?;
    }
    Ok(Answer::Nothing)
}

fn say_advance(to: &mut Speaker<'_>, facts: &Facts<'_>) {
    to.say(text!("echo:Advance K={}", shortest(facts.settings.advance.time)));
}

/// M900, M572.
pub(in crate::machine) async fn change_advance<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    time: Option<Number>,
    window: Option<Number>,
) -> Result<Answer<'static>, Interrupt> {
    if time.or(window).is_none() {
        return Ok(Answer::says(say_advance, 0));
    }
    let advance = wanted_advance(time, window, &main_loop.settings, clamps);
    if !clamps.refuses_line() {
        main_loop.use_advance(advance).await?;
    }
    Ok(Answer::Nothing)
}
