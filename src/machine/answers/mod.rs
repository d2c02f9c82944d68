//! Answers: the result of a command as a value, and the speaker that sends it.
//!
//! A command returns an [`answer::Answer`]. `reports` words it and sends it through the [`speaker::Speaker`], one part
//! after the other. Nothing here knows the Console.
//!
//! | file | is for |
//! |---|---|
//! | [`answer`] | **what** there is to say: one variant a reply |
//! | [`setting`], [`driver_value`] | names for what a line sets and shows |
//! | [`machine_answer`] | what there is to say of a machine that comes or goes over the line |
//! | [`belt_answer`] | what there is to say of motors that can pull against each other |
//! | [`storage_news`] | what M500 to M504 and the start have found |
//! | [`speaker`] | says each part once and in order, whatever room there is |
//!
//! | word | means |
//! |---|---|
//! | part | a line, or lines that must not be separated |
//! | say | write a part, if there is room for it |

pub(in crate::machine) mod answer;
pub(in crate::machine) mod belt_answer;
pub(in crate::machine) mod driver_value;
pub(in crate::machine) mod machine_answer;
pub(in crate::machine) mod setting;
pub(in crate::machine) mod speaker;
pub(in crate::machine) mod storage_news;
