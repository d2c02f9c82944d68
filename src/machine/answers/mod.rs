//! Answers: the result of a command as a value, and the writer that sends it.
//!
//! A command returns an [`answer::Answer`]. `reports` words it and sends it through the
//! [`reply_writer::ReplyWriter`], one part after the other. Nothing here knows the Console.
//!
//! | file | is for |
//! |---|---|
//! | [`answer`] | the **content**: one variant a reply |
//! | [`says`] | words in the file of a command |
//! | [`next_step`] | what is awaited before an answer |
//! | [`setting`], [`driver_value`] | names for the values that a line sets and reports |
//! | [`words`] | values of a command, as the line that sets them |
//! | [`machine_answer`] | answers about a machine record on a serial line |
//! | [`belt_answer`] | answers about motors that can pull against each other |
//! | [`buzz_answer`] | answers to STEPPER_BUZZ |
//! | [`mesh_answer`] | answers about the mesh of the bed |
//! | [`resonance_answer`] | answers to resonance tests |
//! | [`screw_answer`] | answers to G34 and G35 |
//! | [`probe_answer`] | answers of the Z probe |
//! | [`storage_news`] | results of M500 to M504 and of the start |
//! | [`message`] | a message from one host to others (M118), as they read it |
//! | [`reply_writer`] | sends each part once and in order, for any free room |
//!
//! | word | means |
//! |---|---|
//! | part | a line, or lines that must not be separated |
//! | send | write a part, if there is room for it |

pub(in crate::machine) mod answer;
pub(in crate::machine) mod belt_answer;
pub(in crate::machine) mod buzz_answer;
pub(in crate::machine) mod driver_value;
pub(in crate::machine) mod machine_answer;
pub(in crate::machine) mod mesh_answer;
pub(in crate::machine) mod message;
pub(in crate::machine) mod next_step;
pub(in crate::machine) mod probe_answer;
pub(in crate::machine) mod reply_writer;
pub(in crate::machine) mod resonance_answer;
pub(in crate::machine) mod says;
pub(in crate::machine) mod screw_answer;
pub(in crate::machine) mod setting;
pub(in crate::machine) mod storage_news;
pub(in crate::machine) mod words;
