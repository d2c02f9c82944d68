//! Packs the texts of the core when they are compiled: words of a dictionary become one character each.
//!
//! The core's `text` room has the macros that its rooms use, and the other half, which unpacks. Texts of the Octopus's
//! image take half the bytes so. How to make the dictionary again: docs/explanation/texts.md.

mod code;
#[cfg(test)]
mod learn;
mod literal;
#[cfg(test)]
mod tests;
mod words;

use code::Packer;
use proc_macro::{Delimiter, Group, Literal, TokenStream, TokenTree};
use words::WORDS;

/// `format_args!` with a packed template; the places for values and the values stay.
#[proc_macro]
pub fn packed_args(input: TokenStream) -> TokenStream {
    with_first_literal(
        input,
        |text| literal::pack_template(text, &Packer::new(WORDS)),
        |tokens| {
            let path = "::core::format_args!".parse::<TokenStream>().unwrap_or_default();
            path.into_iter().chain([TokenTree::Group(Group::new(Delimiter::Parenthesis, tokens))]).collect()
        },
    )
}

/// A packed literal.
#[proc_macro]
pub fn packed_str(input: TokenStream) -> TokenStream {
    with_first_literal(input, |text| Packer::new(WORDS).pack(text), |tokens| tokens)
}

/// The dictionary: the length of each word, and all words, packed by each other.
#[proc_macro]
pub fn dictionary(_: TokenStream) -> TokenStream {
    let packer = Packer::new(WORDS);
    let packed = WORDS.map(|word| packer.pack_word(word));
    format!("(&{:?}, {:?})", packed.each_ref().map(String::len), packed.concat()).parse().unwrap_or_default()
}

/// The words of the dictionary, each with its code.
#[proc_macro]
pub fn words(_: TokenStream) -> TokenStream {
    let coded: Vec<_> = WORDS.iter().enumerate().map(|(number, word)| (code::code(number), *word)).collect();
    format!("{coded:?}").parse().unwrap_or_default()
}

/// Tokens whose first one, a literal of a string, is packed, in the form that `wrap` gives them.
fn with_first_literal(
    input: TokenStream,
    pack: impl FnOnce(&str) -> String,
    wrap: impl FnOnce(TokenStream) -> TokenStream,
) -> TokenStream {
    let mut tokens = input.into_iter();
    let first = tokens.next();
    let text = first.as_ref().and_then(|first| literal::text_of(&first.to_string()));
    let (Some(first), Some(text)) = (first, text) else { return not_a_text() };
    let mut packed = Literal::string(&pack(&text));
    // The template's own place: names in it are the caller's.
    packed.set_span(first.span());
    wrap([TokenTree::Literal(packed)].into_iter().chain(tokens).collect())
}

fn not_a_text() -> TokenStream {
    let say = "::core::compile_error!(\"a packed text begins with the literal of a string\")";
    say.parse().unwrap_or_default()
}
