//! A source with all of its mutants: at each site the program asks the switch which change to make.

use crate::mutants::sites::{Form, Site};
use std::ops::Range;

/// The source with changes, and the places of these in it.
pub struct Rewritten {
    pub text: String,
    places: Vec<Place>,
}

/// Bytes of the rewritten source that a site takes, and those of its changes, by their numbers.
struct Place {
    site: Range<usize>,
    changes: Vec<(u32, Range<usize>)>,
}

/// Text to put into the source.
struct Insertion {
    at: usize,
    /// At the same place the end of a site comes first. Outer sites begin before, and end after, those in them.
    order: (bool, isize),
    text: String,
    /// The site, if this begins it, and its changes within the text.
    site: usize,
    changes: Vec<(u32, Range<usize>)>,
}

/// Puts changes into a source. The first change has the number `first`; changes that are not viable are left out.
pub fn rewrite(source: &str, sites: &[Site], first: u32, is_viable: impl Fn(u32) -> bool) -> Rewritten {
    let mut insertions = Vec::new();
    let mut number = first;
    for (index, site) in sites.iter().enumerate() {
        let first = number;
        number += site.changes.len() as u32;
        let viable: Vec<_> = (first..).zip(&site.changes).filter(|(number, _)| is_viable(*number)).collect();
        if viable.is_empty() {
            continue;
        }
        let ask = format!("crate::mutant::which({first}, {})", site.changes.len());
        let (begin, end) = match site.form {
            Form::Expression => (format!("(match {ask} {{ u32::MAX => "), " })"),
            Form::Return => (format!(" match {ask} {{ u32::MAX => (), "), " } "),
            Form::Arm => (format!(" if {ask} == u32::MAX"), ""),
        };
        let mut text = if site.form == Form::Expression { String::new() } else { begin.clone() };
        let mut changes = Vec::new();
        for (place, (number, change)) in viable.iter().enumerate() {
            let arm = match place + 1 == viable.len() {
                true => "_".to_owned(),
                false => (number - first).to_string(),
            };
            let start = text.len();
            match site.form {
                Form::Expression => text += &format!(", {arm} => ({})", change.code),
                Form::Return => text += &format!("{arm} => {}, ", change.code),
                Form::Arm => {}
            }
            changes.push((*number, start..text.len()));
        }
        text += end;
        let order = index as isize;
        if site.form == Form::Expression {
            let (at, order) = (site.range.start, (true, order));
            insertions.push(Insertion { at, order, text: begin, site: index, changes: Vec::new() });
        }
        let is_begin = site.form != Form::Expression;
        let order = (is_begin, if is_begin { order } else { -order });
        insertions.push(Insertion { at: site.range.end, order, text, site: index, changes });
    }
    insertions.sort_by_key(|insertion| (insertion.at, insertion.order));
    put(source, sites.len(), &insertions)
}

fn put(source: &str, sites: usize, insertions: &[Insertion]) -> Rewritten {
    let mut text = String::new();
    let mut places: Vec<Option<Place>> = (0..sites).map(|_| None).collect();
    let mut done = 0;
    for insertion in insertions {
        text += &source[done..insertion.at];
        done = insertion.at;
        let start = text.len();
        text += &insertion.text;
        let place = places[insertion.site].get_or_insert_with(|| Place { site: start..start, changes: Vec::new() });
        place.site.end = text.len();
        let moved = |(number, range): &(u32, Range<usize>)| (*number, start + range.start..start + range.end);
        place.changes.extend(insertion.changes.iter().map(moved));
    }
    text += &source[done..];
    Rewritten { text, places: places.into_iter().flatten().collect() }
}

impl Rewritten {
    /// The change with these bytes.
    pub fn change_at(&self, bytes: &Range<usize>) -> Option<u32> {
        let changes = self.places.iter().flat_map(|place| &place.changes);
        let (number, _) = changes.filter(|(_, range)| has(range, bytes)).min_by_key(|(_, range)| range.len())?;
        Some(*number)
    }

    /// All changes of the innermost site with these bytes.
    pub fn site_at(&self, bytes: &Range<usize>) -> Vec<u32> {
        let place = self.places.iter().filter(|place| has(&place.site, bytes)).min_by_key(|place| place.site.len());
        place.map(|place| place.changes.iter().map(|(number, _)| *number).collect()).unwrap_or_default()
    }
}

fn has(range: &Range<usize>, bytes: &Range<usize>) -> bool {
    range.start <= bytes.start && bytes.end <= range.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::sites;

    fn rewritten(source: &str, left_out: &[u32]) -> Rewritten {
        rewrite(source, &sites::of(source).unwrap(), 10, |number| !left_out.contains(&number))
    }

    #[test]
    fn a_site_asks_for_its_change() {
        let source = "fn f() -> u8 { a + b & c }";
        let text = rewritten(source, &[10, 11, 12]).text;
        assert_eq!(
            text,
            "fn f() -> u8 { (match crate::mutant::which(12, 2) { u32::MAX => (match crate::mutant::which(14, 2) \
             { u32::MAX => a + b, 0 => ((a) - (b)), _ => ((a) * (b)) }) & c, _ => ((a + b) ^ (c)) }) }"
        );
        let text = rewritten(source, &[12, 13, 14, 15]).text;
        assert_eq!(
            text,
            "fn f() -> u8 { match crate::mutant::which(10, 2) { u32::MAX => (), 0 => return 0, _ => return 1,  }  \
             a + b & c }"
        );
    }

    #[test]
    fn an_arm_has_a_guard() {
        let text = rewritten("fn f() -> ! { match a { 1 => b, _ => c } }", &[]).text;
        assert_eq!(text, "fn f() -> ! { match a { 1 if crate::mutant::which(10, 1) == u32::MAX => b, _ => c } }");
    }

    #[test]
    fn changes_are_found_by_their_bytes() {
        let rewritten = rewritten("fn f() -> ! { a + b }", &[]);
        let of = |code: &str| {
            let start = rewritten.text.find(code).unwrap();
            start..start + code.len()
        };
        assert_eq!(rewritten.change_at(&of("(a) - (b)")), Some(10));
        assert_eq!(rewritten.change_at(&of("(a) * (b)")), Some(11));
        assert_eq!(rewritten.change_at(&of("a + b")), None);
        assert_eq!(rewritten.site_at(&of("a + b")), [10, 11]);
    }
}
