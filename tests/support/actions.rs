//! The reactions of hosts and screens to a host action line, as in their sources.

/// The reaction of a host's print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Deed {
    /// It pauses the print, with its scripts.
    Pause,
    /// It takes the print as paused by the printer.
    NotePaused,
    /// It takes the print as going on again.
    NoteResumed,
    Cancel,
    Begin,
    Button,
    Show,
    Close,
}

/// OctoPrint 1.11.8, util/comm.py, `_monitor`; and its bundled plugin `action_command_prompt`.
pub fn octoprint(line: &str) -> Option<Deed> {
    let action = line.strip_prefix("//")?.trim().strip_prefix("action:")?.trim();
    let (name, text) = action.split_once(' ').unwrap_or((action, ""));
    match name {
        "pause" => Some(Deed::Pause),
        "paused" => Some(Deed::NotePaused),
        "resumed" => Some(Deed::NoteResumed),
        "cancel" => Some(Deed::Cancel),
        "prompt_begin" if !text.is_empty() => Some(Deed::Begin),
        "prompt_button" if !text.is_empty() => Some(Deed::Button),
        "prompt_show" => Some(Deed::Show),
        "prompt_end" => Some(Deed::Close),
        _ => None,
    }
}

/// Printrun 2.2.0, pronsole.py and pronterface.py, `recvcb_actions`: a cancel pauses. It ignores other actions.
pub fn printrun(line: &str) -> Option<Deed> {
    let (_, command) = line.starts_with("//").then(|| line.split_once(' '))??;
    match command.split(':').collect::<Vec<_>>().as_slice() {
        ["action", "pause" | "cancel"] => Some(Deed::Pause),
        _ => None,
    }
}

/// BIGTREETECH's TouchScreenFirmware, Mainboard_AckHandler.c, `parseAck` and `hostActionCommands`: the first of these
/// texts that stands anywhere in the line counts. Its texts have 30 and 20 bytes, line end and zero included, without a
/// check whether they fit.
pub fn btt_tft(line: &str) -> Option<Deed> {
    if !line.starts_with("//action:") {
        return None;
    }
    let after = |word: &str| line.split_once(word).map(|(_, text)| text);
    if line.contains(":notification ") {
        None
    } else if line.contains(":paused") {
        Some(Deed::NotePaused)
    } else if line.contains(":pause") {
        Some(Deed::Pause)
    } else if line.contains(":resume") {
        Some(Deed::NoteResumed)
    } else if line.contains(":cancel") {
        Some(Deed::Cancel)
    } else if let Some(text) = after(":prompt_begin ") {
        assert!(text.len() + 2 <= 30, "overflows the screen's memory: {text}");
        Some(Deed::Begin)
    } else if let Some(text) = after(":prompt_button ") {
        assert!(text.len() + 2 <= 20, "overflows the screen's memory: {text}");
        Some(Deed::Button)
    } else if line.contains(":prompt_show") {
        Some(Deed::Show)
    } else {
        None
    }
}
