//! The values that a function returns instead of its own, by their type.

use syn::{GenericArgument, PathArguments, ReturnType, Type};

/// At most this many values are tried of one function; pairs of pairs would have more.
const MOST: usize = 6;

/// Rust expressions for values of what a function returns. Nothing is known of a type without a name.
pub fn of(output: &ReturnType) -> Vec<String> {
    let mut values = match output {
        ReturnType::Default => vec!["()".to_owned()],
        ReturnType::Type(_, kind) => of_type(kind),
    };
    values.truncate(MOST);
    values
}

fn of_type(kind: &Type) -> Vec<String> {
    match kind {
        Type::Tuple(tuple) => {
            let parts = tuple.elems.iter().map(of_type);
            let all = parts.fold(vec![String::new()], |all, values| {
                all.iter().flat_map(|begin| values.iter().map(move |value| format!("{begin}{value}, "))).collect()
            });
            all.iter().map(|parts| format!("({})", parts.trim_end())).map(|tuple| tuple.replace(",)", ")")).collect()
        }
        Type::Array(array) => of_type(&array.elem).iter().map(|value| format!("[{value}; _]")).collect(),
        Type::Reference(reference) => match &*reference.elem {
            _ if reference.mutability.is_some() => Vec::new(),
            Type::Path(path) if path.path.is_ident("str") => strings(&["\"\"", "\"xyzzy\""]),
            Type::Slice(_) => strings(&["&[]"]),
            other => of_type(other).iter().map(|value| format!("&{value}")).collect(),
        },
        Type::Path(path) => path.path.segments.last().map_or_else(Vec::new, of_name),
        Type::Paren(inner) => of_type(&inner.elem),
        _ => Vec::new(),
    }
}

fn of_name(name: &syn::PathSegment) -> Vec<String> {
    let first = match &name.arguments {
        PathArguments::AngleBracketed(arguments) => arguments.args.iter().find_map(|argument| match argument {
            GenericArgument::Type(kind) => Some(of_type(kind)),
            _ => None,
        }),
        _ => None,
    };
    let in_each = |around: &str| -> Vec<String> {
        let inner = first.clone().unwrap_or_else(|| strings(&["Default::default()"]));
        inner.iter().map(|value| format!("{around}({value})")).collect()
    };
    match name.ident.to_string().as_str() {
        "bool" => strings(&["true", "false"]),
        "u8" | "u16" | "u32" | "u64" | "u128" | "usize" => strings(&["0", "1"]),
        "i8" | "i16" | "i32" | "i64" | "i128" | "isize" => strings(&["0", "1", "-1"]),
        "f32" | "f64" => strings(&["0.0", "1.0", "-1.0"]),
        "Option" => [strings(&["None"]), in_each("Some")].concat(),
        "Result" => in_each("Ok"),
        _ => strings(&["Default::default()"]),
    }
}

fn strings(values: &[&str]) -> Vec<String> {
    values.iter().map(|&value| value.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(output: &str) -> Vec<String> {
        of(&syn::parse_str(output).unwrap())
    }

    #[test]
    fn values_are_of_the_type() {
        assert_eq!(values(""), ["()"]);
        assert_eq!(values("-> Option<bool>"), ["None", "Some(true)", "Some(false)"]);
        assert_eq!(values("-> fmt::Result"), ["Ok(Default::default())"]);
        assert_eq!(values("-> Result<(), Fault>"), ["Ok(())"]);
        assert_eq!(values("-> (bool, Mm)"), ["(true, Default::default())", "(false, Default::default())"]);
        assert_eq!(values("-> &'static str"), ["\"\"", "\"xyzzy\""]);
        assert_eq!(values("-> [u8; 4]"), ["[0; _]", "[1; _]"]);
    }

    #[test]
    fn a_type_without_a_name_has_no_values() {
        assert!(["-> impl Iterator<Item = u8>", "-> &mut u8", "-> !"].iter().all(|output| values(output).is_empty()));
    }
}
