//! Settings as they are stored: what is stored counts from the start on, and M500, M501, M502, M504; and the note of a
//! self-test that was passed.

use crate::machine::answers::answer::Answer;
use crate::machine::answers::storage_news::StorageNews;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::state::machine_pieces::MachinePieces;
use crate::port::{Pend, Storage, StorageError};
use crate::settings::Settings;
use crate::storage::{self, Receipt, SaveError, Survey};

/// The storage, with the world going round once after every transfer, so that M112 is heard while settings
/// are being saved.
struct Paced<'c, 'm, P: PortSet, W: Pend> {
    crank: &'c mut Crank<'m, P, W>,
    interrupt: Option<Interrupt>,
}

impl<'c, 'm, P: PortSet, W: Pend> Paced<'c, 'm, P, W> {
    const fn new(crank: &'c mut Crank<'m, P, W>) -> Self {
        Self { crank, interrupt: None }
    }

    /// An interrupt ends the transfers, but for an M410 that finds no motion to stop.
    async fn go_round(&mut self) -> Result<(), StorageError> {
        match self.crank.turn().await {
            Err(interrupt) if matches!(interrupt, Interrupt::Halt | Interrupt::Limp) || self.crank.has_motion() => {
                self.interrupt = Some(interrupt);
                Err(StorageError::Failed)
            }
            Err(_) | Ok(()) => Ok(()),
        }
    }

    /// What ended the transfers before their time, if something did.
    fn into_result(self) -> Result<(), Interrupt> {
        match self.interrupt {
            Some(interrupt) => Err(interrupt),
            None => Ok(()),
        }
    }
}

impl<P: PortSet, W: Pend> Storage for Paced<'_, '_, P, W> {
    fn capacity(&self) -> u32 {
        self.crank.storage().capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.crank.storage_mut().read(at, into).await?;
        self.go_round().await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.crank.storage_mut().write(at, bytes).await?;
        self.go_round().await?;
        while !self.crank.storage_mut().is_done()? {
            self.go_round().await?;
        }
        Ok(())
    }

    fn image(&self) -> Option<u32> {
        self.crank.storage().image()
    }
}

/// Looks into the storage.
pub(in crate::machine) async fn survey<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<Result<Survey, StorageError>, Interrupt> {
    let mut paced = Paced::new(crank);
    let survey = storage::survey(&mut paced).await;
    paced.into_result()?;
    Ok(survey.map(|survey| survey.on(&crank.defaults().mechanism)))
}

/// Takes the settings that are stored, before the first `start`, and returns what to tell of them after it: a
/// host listens only then. A machine without storage has nothing to tell, and on a board that is no machine nothing stored counts.
pub(in crate::machine) async fn load_at_start<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<Answer<'static>, Interrupt> {
    let survey = match survey(crank).await? {
        Ok(survey) => survey,
        Err(StorageError::Absent) => return Ok(Answer::Nothing),
        Err(error) => return Ok(Answer::Storage(StorageNews::Unreadable(error))),
    };
    if crank.refusal().is_some() {
        return Ok(Answer::Nothing);
    }
    if let Some(stored) = survey.newest {
        crank.use_settings(stored.settings).await?;
    }
    let mut paced = Paced::new(crank);
    let passed = storage::passed_test(&mut paced).await;
    paced.into_result()?;
    // A note that cannot be read costs a test, and no more.
    crank.know_passed_test(passed.unwrap_or_default());
    Ok(Answer::Storage(StorageNews::loaded(&survey)))
}

/// Notes the self-test that was passed, for starts to come.
pub(in crate::machine) async fn note_self_test<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<(), Interrupt> {
    let Some(tested) = crank.take_passed_test() else { return Ok(()) };
    let mut paced = Paced::new(crank);
    let _ = storage::note_passed_test(&mut paced, tested).await;
    paced.into_result()
}

/// M500. Another machine that waits for the next reset is not written over, and a board without a machine does not become one.
pub(in crate::machine) async fn save_settings<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    pieces: &MachinePieces,
) -> Result<StorageNews, Interrupt> {
    if pieces.is_stored {
        return Ok(StorageNews::MachineWaits);
    }
    if let Some(why) = crank.refusal() {
        return Ok(StorageNews::NoMachine(why));
    }
    let settings = *crank.settings();
    Ok(save(crank, &settings).await?.map_or_else(StorageNews::NotSaved, StorageNews::Saved))
}

/// Stores settings. The machine rests: storage may be flash, whose erasing stops the processor.
pub(in crate::machine) async fn save<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    settings: &Settings,
) -> Result<Result<Receipt, SaveError>, Interrupt> {
    crank.finish().await?;
    let mut paced = Paced::new(crank);
    let saved = storage::save(&mut paced, settings).await;
    paced.into_result()?;
    Ok(saved)
}

/// M501. Storage without valid settings gives the defaults, storage that does not answer changes nothing; nor does a board without
/// a machine.
pub(in crate::machine) async fn load_settings<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<StorageNews, Interrupt> {
    if let Some(why) = crank.refusal() {
        return Ok(StorageNews::NotLoaded(why));
    }
    crank.finish().await?;
    let survey = match survey(crank).await? {
        Ok(survey) => survey,
        Err(error) => return Ok(StorageNews::Unchanged(error)),
    };
    let settings = survey.newest.map_or(*crank.defaults(), |stored| stored.settings);
    crank.use_settings(settings).await?;
    Ok(StorageNews::loaded(&survey))
}

/// M502.
pub(in crate::machine) async fn reset_settings<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<StorageNews, Interrupt> {
    crank.finish().await?;
    crank.use_settings(*crank.defaults()).await?;
    Ok(StorageNews::Defaults)
}

/// M504.
pub(in crate::machine) async fn check_storage<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<StorageNews, Interrupt> {
    Ok(match survey(crank).await? {
        Ok(survey) => StorageNews::checked(&survey),
        Err(error) => StorageNews::Unanswered(error),
    })
}
