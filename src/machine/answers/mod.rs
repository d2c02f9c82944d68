//! Answers: the result of a command as a value, and the writer that sends it.
//!
//! A command returns an [`answer::Answer`]. Its words are functions or closures, which send lines through the
//! [`reply_writer::ReplyWriter`], one part after the other. Nothing here knows the Console.
//!
//! | file | is for |
//! |---|---|
//! | [`answer`] | the result of a command |
//! | [`words`] | what writes lines, and what it may read of the main loop |
//! | [`reply_writer`] | sends each part once and in order, for any free room |
//!
//! | word | means |
//! |---|---|
//! | part | a line, or lines that must not be separated |
//! | send | write a part, if there is room for it |

pub(in crate::machine) mod answer;
pub(in crate::machine) mod reply_writer;
pub(in crate::machine) mod words;
