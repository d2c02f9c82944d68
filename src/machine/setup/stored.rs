//! Stored settings: M500, M501, M502, M504, and the record of a passed self-test. Stored settings take effect at the
//! start.

use super::mesh_news::News;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::machine_pieces::MachinePieces;
use crate::machine::states::States;
use crate::port::{BoardFacts, Storage, StorageError, Wake};
use crate::settings::Settings;
use crate::status::WITH_FIGURES;
use crate::storage::{self, LONGEST, MeshFate, Receipt, Rejected, SaveError, Slot, Survey};
use crate::text::Packed;
use crate::thermal::baseline_subject;
use crate::units::Mm;
use core::fmt::{self, Display, Formatter};
use core::pin::pin;

/// The storage, with one turn of the main loop after every transfer, so that M112 acts while settings are being saved.
pub(in crate::machine) struct Paced<'c, 'm, P: PortSet, W: Wake> {
    main_loop: &'c mut MainLoop<'m, P, W>,
    interrupt: Option<Interrupt>,
}

impl<'c, 'm, P: PortSet, W: Wake> Paced<'c, 'm, P, W> {
    pub(in crate::machine) const fn new(main_loop: &'c mut MainLoop<'m, P, W>) -> Self {
        Self { main_loop, interrupt: None }
    }

    /// An interrupt ends the transfers, except an M410 without a motion to stop.
    async fn go_round(&mut self) -> Result<(), StorageError> {
        match self.main_loop.poll().await {
            Err(interrupt)
                if matches!(interrupt, Interrupt::Halt | Interrupt::Limp) || self.main_loop.motion.has_motion() =>
            {
                self.interrupt = Some(interrupt);
                Err(StorageError::Failed)
            }
            Err(_) | Ok(()) => Ok(()),
        }
    }

    /// The interrupt that ended the transfers early, if there was one.
    pub(in crate::machine) fn into_result(self) -> Result<(), Interrupt> {
        match self.interrupt {
            Some(interrupt) => Err(interrupt),
            None => Ok(()),
        }
    }
}

impl<P: PortSet, W: Wake> Storage for Paced<'_, '_, P, W> {
    fn capacity(&self) -> u32 {
        self.main_loop.storage.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.main_loop.storage.read(at, into).await?;
        self.go_round().await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.main_loop.storage.write(at, bytes).await?;
        self.go_round().await?;
        while !self.main_loop.storage.is_done()? {
            self.go_round().await?;
        }
        Ok(())
    }

    fn image(&self) -> Option<u32> {
        self.main_loop.storage.image()
    }
}

/// Looks into the storage for settings of this mechanism.
async fn survey<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    record: &mut [u8; LONGEST],
) -> Result<Result<Survey, StorageError>, Interrupt> {
    let own = main_loop.settings.defaults().mechanism;
    let mut paced = Paced::new(main_loop);
    let survey = storage::survey_with(&mut paced, Some(own), record).await;
    paced.into_result()?;
    Ok(survey)
}

/// What was found of stored settings.
#[derive(Clone, Copy)]
pub(in crate::machine) struct Found {
    /// Why the content of a slot is not used.
    rejected: [(Slot, Option<Rejected>); 2],
    receipt: Option<Receipt>,
    /// The first ids in them that this firmware does not know; 0 is none.
    unknown: [u16; 4],
}

impl Found {
    fn new(survey: &Survey) -> Self {
        let (receipt, unknown) = match &survey.newest {
            Some(stored) => (Some(stored.receipt), stored.unknown.first_ids()),
            None => (None, [0; 4]),
        };
        Self { rejected: survey.rejected, receipt, unknown }
    }

    /// These settings were taken, or the defaults if there is no receipt.
    pub fn report_loaded(&self, to: &mut ReplyWriter<'_>) {
        self.report_unused(to);
        match self.receipt {
            Some(receipt) => to.say(text!("echo:stored settings retrieved {receipt}")),
            None => to.say(text!("{DEFAULTS}")),
        }
    }

    /// They were looked at.
    fn report_checked(&self, to: &mut ReplyWriter<'_>) {
        self.report_unused(to);
        match self.receipt {
            Some(receipt) => to.say(text!("echo:stored settings valid {receipt}")),
            None => to.say(text!("echo:no valid settings stored")),
        }
    }

    /// Names the slots with unused content, but no empty one, and stored settings that this firmware does not have.
    fn report_unused(&self, to: &mut ReplyWriter<'_>) {
        for (slot, why) in self.rejected {
            if let Some(why) = why.filter(|why| *why != Rejected::Blank) {
                to.say(text!("echo:storage slot {slot} not used: {why}"));
            }
        }
        for id in self.unknown.into_iter().filter(|id| *id > 0) {
            to.say(text!("echo:stored setting {id} is of later firmware: kept, not used"));
        }
    }
}

const DEFAULTS: Packed = packed!("echo:Hardcoded Default Settings Loaded");

/// What a start has found: settings, or that the storage does not answer.
pub(in crate::machine) type AtStart = Result<Found, StorageError>;

/// Says what a start has found.
pub(in crate::machine) fn report_start(to: &mut ReplyWriter<'_>, found: &AtStart) {
    match found {
        Ok(found) => found.report_loaded(to),
        Err(error) => {
            to.say(text!("echo:{error}"));
            to.say(text!("{DEFAULTS}"));
        }
    }
}

/// Loads the stored settings, before the first `start`, and returns the news to send after it: a host listens only
/// then. A machine without storage has no news, and on a board without a machine no stored settings count.
pub(in crate::machine) async fn load_at_start<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
) -> Result<Option<AtStart>, Interrupt> {
    let survey = match survey(main_loop, states.pieces.begin()).await? {
        Ok(survey) => survey,
        Err(StorageError::Absent) => return Ok(None),
        Err(error) => return Ok(Some(Err(error))),
    };
    if main_loop.board.refusal().is_some() {
        return Ok(None);
    }
    if let Some(stored) = &survey.newest {
        main_loop.use_settings(&stored.settings).await?;
        main_loop.first_layer.note_stored(&main_loop.settings);
    }
    let mut paced = Paced::new(main_loop);
    let passed = storage::passed_test(&mut paced).await;
    paced.into_result()?;
    // A note that cannot be read costs a test, and no more.
    main_loop.heat.know_passed_test(passed.unwrap_or_default());
    let mut paced = Paced::new(main_loop);
    let loads = storage::belt_loads(&mut paced).await;
    paced.into_result()?;
    main_loop.trimming.know_loads(loads.unwrap_or_default());
    for heater in WITH_FIGURES {
        let subject = baseline_subject(main_loop.settings.thermal.heater(heater));
        let mut paced = Paced::new(main_loop);
        let figures = storage::baseline(&mut paced, heater as usize, subject).await;
        paced.into_result()?;
        // One that cannot be read is learned again.
        main_loop.heat.baselines().know(heater, subject, figures.ok().flatten().unwrap_or_default());
    }
    Ok(Some(Ok(Found::new(&survey))))
}

/// Notes the self-test that was passed, for starts to come.
pub(in crate::machine) async fn note_self_test<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let Some(tested) = main_loop.heat.take_passed_test() else { return Ok(()) };
    let mut paced = Paced::new(main_loop);
    let _ = storage::note_passed_test(&mut paced, tested).await;
    paced.into_result()
}

/// Stores a baseline of a heater that was learned, or erases one that was forgotten.
pub(in crate::machine) async fn note_baseline<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let Some((heater, subject, figures)) = main_loop.heat.baseline_news(&main_loop.settings.thermal) else {
        return Ok(());
    };
    let mut paced = Paced::new(main_loop);
    let noted = storage::note_baseline(&mut paced, heater as usize, subject, figures).await;
    paced.into_result()?;
    match noted {
        Ok(()) => main_loop.heat.baselines().know(heater, subject, figures),
        // Without storage the model itself is the baseline.
        Err(_) => main_loop.heat.baselines().give_up(heater),
    }
    Ok(())
}

/// Notes the load that a mm of strain takes of belt motors, if it is another one than noted.
pub(in crate::machine) async fn note_belt_loads<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let Some(loads) = main_loop.trimming.take_new_loads() else { return Ok(()) };
    main_loop.finish().await?;
    let mut paced = Paced::new(main_loop);
    let _ = storage::note_belt_loads(&mut paced, loads).await;
    paced.into_result()
}

/// M500. Another machine that waits for the next reset is not written over, and a board without a machine does not
/// become one.
pub(in crate::machine) async fn save_settings<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
) -> Result<Answer<'static>, Interrupt> {
    if pieces.is_stored {
        return Ok(Answer::Line(packed!(
            "echo:Settings not stored: a new machine is stored, which takes effect after the next reset"
        )));
    }
    if let Some(why) = main_loop.board.refusal() {
        main_loop.say(text!("echo:Settings not stored: {why}"));
        return Ok(Answer::Said);
    }
    let settings = *main_loop.settings;
    match save(main_loop, &settings, pieces.begin()).await? {
        Ok(receipt) => main_loop.say(text!("echo:Settings Stored {receipt}")),
        Err(why) => main_loop.say(text!("echo:Settings not stored: {why}")),
    }
    Ok(Answer::Said)
}

/// Stores settings, in a place for a record. The machine is at rest: storage may be flash, and erasing flash stops the
/// processor.
pub(in crate::machine) async fn save<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    settings: &Settings,
    record: &mut [u8; LONGEST],
) -> Result<Result<Receipt, SaveError>, Interrupt> {
    main_loop.finish().await?;
    apart(pin!(take_mesh_along(main_loop, settings, record))).await?;
    let mut paced = Paced::new(main_loop);
    let saved = storage::save_with(&mut paced, settings, record).await;
    paced.into_result()?;
    if saved.is_ok() {
        main_loop.first_layer.note_stored(settings);
    }
    Ok(saved)
}

/// The kept mesh becomes one of the settings that are about to be stored, or its end is told.
async fn take_mesh_along<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    settings: &Settings,
    record: &mut [u8; LONGEST],
) -> Result<(), Interrupt> {
    let mut paced = Paced::new(main_loop);
    let is_of_others = storage::is_of_others(&mut paced, settings).await;
    paced.into_result()?;
    if is_of_others != Ok(true) {
        return Ok(());
    }
    let Ok(stored) = survey(main_loop, record).await? else { return Ok(()) };
    let before = stored.newest.as_ref().map_or(main_loop.settings.defaults(), |stored| &stored.settings);
    let mut paced = Paced::new(main_loop);
    let fate = storage::follow_settings(&mut paced, before, settings).await;
    paced.into_result()?;
    let news = match fate {
        Ok(MeshFate::Stays) => return Ok(()),
        Ok(MeshFate::Moves(by)) if by == [Mm::ZERO; 2] => return Ok(()),
        Ok(MeshFate::Moves(by)) => News::Moved(by),
        Ok(MeshFate::Ends) => News::Ends,
        Err(why) => News::NotKept(why),
    };
    main_loop.say(text!("{news}"));
    Ok(())
}

/// Why M501 changes nothing.
pub(in crate::machine) enum Unchanged {
    /// The board has no machine, and why.
    NoMachine(&'static str),
    Storage(StorageError),
}

impl Display for Unchanged {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoMachine(why) => f.write_str(why),
            Self::Storage(error) => error.fmt(f),
        }
    }
}

/// M501. Storage without valid settings gives the defaults, storage that does not answer changes nothing; nor does a
/// board without a machine.
pub(in crate::machine) async fn load_settings<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
) -> Result<Result<Found, Unchanged>, Interrupt> {
    if let Some(why) = main_loop.board.refusal() {
        return Ok(Err(Unchanged::NoMachine(why)));
    }
    main_loop.finish().await?;
    let survey = match survey(main_loop, pieces.begin()).await? {
        Ok(survey) => survey,
        Err(error) => return Ok(Err(Unchanged::Storage(error))),
    };
    let settings = survey.newest.as_ref().map_or(main_loop.settings.defaults(), |stored| &stored.settings);
    main_loop.use_settings(settings).await?;
    main_loop.first_layer.note_stored(&main_loop.settings);
    Ok(Ok(Found::new(&survey)))
}

/// M502.
pub(in crate::machine) async fn reset_settings<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.finish().await?;
    main_loop.use_settings(main_loop.settings.defaults()).await?;
    Ok(Answer::Line(DEFAULTS))
}

/// M504.
pub(in crate::machine) async fn check_storage<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
) -> Result<Answer<'static>, Interrupt> {
    match survey(main_loop, pieces.begin()).await? {
        Ok(survey) => {
            let found = Found::new(&survey);
            main_loop.tell(|to, _| found.report_checked(to));
        }
        Err(error) => main_loop.say(text!("echo:{error}")),
    }
    Ok(Answer::Said)
}
