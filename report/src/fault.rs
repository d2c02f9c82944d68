//! Fault: why a print failed, when, and what to do.

use corehbot_sim::host::Remark;
use serde::Serialize;

/// The parts of [`DOCUMENT`] about numbered faults, and about all others.
const NUMBERED: Part = Part { page: "docs/reference/errors.md#faults", heading: "## Faults\n" };
const OTHERS: Part = Part { page: "docs/reference/errors.md#jobs-that-end", heading: "## Jobs that end\n" };

/// That document: it knows the cause of each numbered fault, which the firmware does not say.
const DOCUMENT: &str = include_str!("../../docs/reference/errors.md");

/// A part of the document: its address, and its first line.
struct Part {
    page: &'static str,
    heading: &'static str,
}

impl Part {
    /// Its text, from the heading up to the next one of its rank.
    fn text(&self) -> &'static str {
        let rest = DOCUMENT.find(self.heading).and_then(|at| DOCUMENT.get(at..)).unwrap_or_default();
        let end = rest.find("\n## ").map_or(rest.len(), |at| at + 1);
        rest.get(..end).unwrap_or_default()
    }
}

/// What the firmware says around a fault (`Replies::killed_by`, `killed_after`).
const WRAPPING: [&str; 2] = ["Error:", "Printer halted. kill() called! ("];
const END: &str = ") Send M999 or reset";

/// A fault as a card shows it.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Fault {
    /// `E08`, if it has a number.
    pub code: Option<String>,
    /// What happened.
    pub text: String,
    /// Why it happens, as the document says.
    pub cause: Option<String>,
    /// What to do, if the firmware says it.
    pub cure: Option<String>,
    /// The document about it.
    pub page: &'static str,
    /// When, in s since the printer was switched on.
    pub time_s: f64,
    /// The same in s of motion time.
    pub motion_s: f64,
    /// The line of the file that was under way; 0 if there is none.
    pub line: u32,
    /// The command in it.
    pub command: String,
}

impl Fault {
    /// The fault that ended a print with this remark.
    #[must_use]
    pub fn new(remark: &Remark, time_s: f64, motion_s: f64) -> Self {
        let (code, text, cure) = parts(&remark.reply);
        Self {
            page: part(code).page,
            cause: code.and_then(cause),
            code: code.map(str::to_owned),
            text: text.to_owned(),
            cure: cure.map(str::to_owned),
            time_s,
            motion_s,
            line: remark.line,
            command: remark.command.clone(),
        }
    }

    /// The part of the document at [`Self::page`], in Markdown.
    #[must_use]
    pub fn text_of_page(&self) -> &'static str {
        part(self.code.as_deref()).text()
    }
}

/// The part about faults with a number, or about those without.
const fn part(code: Option<&str>) -> Part {
    if code.is_some() { NUMBERED } else { OTHERS }
}

/// The cause of a fault: the third column of its row, without addresses of links.
fn cause(code: &str) -> Option<String> {
    let row = DOCUMENT.lines().find_map(|line| line.strip_prefix("| ")?.strip_prefix(code)?.strip_prefix(" | "))?;
    let cell = row.split(" | ").nth(1)?;
    let mut parts = cell.split("](");
    let mut text = parts.next()?.replace('[', "");
    for part in parts {
        text += &part.split_once(')')?.1.replace('[', "");
    }
    Some(text)
}

/// Number, text and cure in the printer's words: `Error:hotend: sensor shorted [E02]: mend the sensor's wire`. A text
/// without a number has its cure in sentences of their own.
fn parts(reply: &str) -> (Option<&str>, &str, Option<&str>) {
    let reply = WRAPPING.iter().fold(reply, |reply, begin| reply.strip_prefix(begin).unwrap_or(reply));
    let reply = reply.strip_suffix(END).unwrap_or(reply);
    let numbered = reply.split_once(" [").and_then(|(text, rest)| {
        let (code, cure) = rest.split_once("]: ")?;
        let is_code = code.strip_prefix('E').is_some_and(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
        is_code.then_some((code, text, cure))
    });
    match numbered {
        Some((code, text, cure)) => (Some(code), text, Some(cure)),
        None => match reply.split_once(". ") {
            Some((text, cure)) => (None, text, Some(cure)),
            None => (None, reply, None),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::fault::{Cause, Fault as Told};

    #[test]
    fn every_fault_of_the_firmware_comes_apart() {
        for cause in Cause::all() {
            let told = Told { subject: 0, ..Told::plain(cause) }.to_string();
            for reply in
                [format!("Error:{told}"), format!("Error:Printer halted. kill() called! ({told}){}", &END[1..])]
            {
                let (code, text, cure) = parts(&reply);
                assert_eq!(code, Some(format!("E{:02}", cause as u8).as_str()), "{reply}");
                assert_eq!(format!("{text} [{}]: {}", code.unwrap(), cure.unwrap()), told);
                let cause = super::cause(code.unwrap()).unwrap();
                assert!(cause.len() > 5 && !cause.contains(['[', ']', '|']), "{cause}");
            }
        }
    }

    #[test]
    fn causes_are_those_of_the_document() {
        assert_eq!(cause("E02").as_deref(), Some("the wire of a sensor is shorted"));
        assert_eq!(cause("E18").as_deref(), Some("a bug; the values are calls"));
        assert_eq!(cause("E99"), None);
    }

    #[test]
    fn the_page_about_a_fault_is_all_of_its_part() {
        let numbered = NUMBERED.text();
        for cause in Cause::all() {
            assert_eq!(numbered.matches(&format!("\n| E{:02} |", cause as u8)).count(), 1);
        }
        for (part, end) in [(NUMBERED, "\n## Jobs that end\n"), (OTHERS, "\n## At the start\n")] {
            let (before, after) = DOCUMENT.split_once(part.text()).unwrap();
            assert!(before.ends_with('\n') && format!("\n{after}").starts_with(end), "{}", part.page);
            assert_eq!(part.text().matches("\n## ").count(), 0);
        }
    }

    #[test]
    fn other_ends_have_a_text() {
        let text = "the printer has ended the print";
        assert_eq!(parts(text), (None, text, None));
        assert_eq!(parts("Error:no [homing] here"), (None, "no [homing] here", None));
        let homing = "print ended: homing failed: Y endstop was not met within 10.5 mm. Check its switch. Home again";
        let text = "print ended: homing failed: Y endstop was not met within 10.5 mm";
        assert_eq!(parts(homing), (None, text, Some("Check its switch. Home again")));
    }
}
