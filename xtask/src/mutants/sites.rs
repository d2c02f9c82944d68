//! Sites: the places of a source file where it can be changed, and the changes.

use crate::mutants::values;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, BinOp, Expr, ImplItemConst, ImplItemFn, ItemConst, ItemFn, ItemImpl, ItemMod, ItemStatic};
use syn::{ItemTrait, TraitItemConst, TraitItemFn, UnOp};

/// A place, with one change at least.
#[derive(Debug)]
pub struct Site {
    /// Bytes of the source.
    pub range: Range<usize>,
    pub form: Form,
    pub changes: Vec<Change>,
}

/// How a change takes the place of the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// An expression is another one.
    Expression,
    /// A function returns at its begin. The range is empty.
    Return,
    /// An arm of a `match` is never taken. The range is empty, behind the pattern.
    Arm,
}

/// One change.
#[derive(Debug)]
pub struct Change {
    /// `line:column: replace + with - in f`.
    pub name: String,
    /// The code instead.
    pub code: String,
}

/// All sites of a source, in the order of the text; outer ones come before those in them.
pub fn of(source: &str) -> syn::Result<Vec<Site>> {
    let file = syn::parse_file(source)?;
    let mut finder = Finder { source, names: Vec::new(), sites: Vec::new() };
    finder.visit_file(&file);
    Ok(finder.sites)
}

struct Finder<'s> {
    source: &'s str,
    /// Names of the block of methods and of the function around.
    names: Vec<String>,
    sites: Vec<Site>,
}

impl Finder<'_> {
    /// The text of a piece of syntax.
    fn text(&self, piece: &impl Spanned) -> &str {
        &self.source[piece.span().byte_range()]
    }

    /// The text in one line.
    fn line(&self, piece: &impl Spanned) -> String {
        self.text(piece).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Adds a site with its changes, as their descriptions and codes. The place in the name is the one of `piece`.
    fn add(&mut self, range: Range<usize>, form: Form, piece: proc_macro2::Span, changes: Vec<(String, String)>) {
        let place = piece.start();
        let within = self.names.last().map(|name| format!(" in {name}")).unwrap_or_default();
        let within = if form == Form::Return { "" } else { &within };
        let change = |(what, code): (String, String)| Change {
            name: format!("{}:{}: {what}{within}", place.line, place.column + 1),
            code,
        };
        let changes: Vec<_> = changes.into_iter().map(change).collect();
        if !changes.is_empty() {
            self.sites.push(Site { range, form, changes });
        }
    }

    /// A function: its values, and the sites in its body.
    fn function(&mut self, signature: &syn::Signature, body: &syn::Block) {
        let name = match self.names.last() {
            Some(around) => format!("{around}::{}", signature.ident),
            None => signature.ident.to_string(),
        };
        let code = self.text(body).trim_start_matches('{').trim_end_matches('}').trim();
        // Without `default` there is no value to return, and this would call itself.
        if !code.is_empty() && signature.ident != "default" && signature.asyncness.is_none() {
            let output = match &signature.output {
                syn::ReturnType::Default => String::new(),
                syn::ReturnType::Type(_, kind) => format!(" -> {}", self.line(kind)),
            };
            let values = values::of(&signature.output).into_iter().filter(|value| value != code);
            let change = |value: String| (format!("replace {name}{output} with {value}"), format!("return {value}"));
            let changes = values.map(change).collect();
            let begin = body.brace_token.span.open().byte_range().end;
            self.add(begin..begin, Form::Return, signature.span(), changes);
        }
        self.names.push(name);
        visit::visit_block(self, body);
        _ = self.names.pop();
    }

    /// The sites of the items in something with a name.
    fn within(&mut self, name: String, visit: impl FnOnce(&mut Self)) {
        self.names.push(name);
        visit(self);
        _ = self.names.pop();
    }

    /// An operator between two operands is another one.
    fn binary(&mut self, binary: &syn::ExprBinary) {
        // Such an operand stands only in a chain of `&&`.
        if [&binary.left, &binary.right].iter().any(|operand| has_let(operand)) {
            return;
        }
        let old = self.line(&binary.op);
        let (left, right) = (self.text(&binary.left), self.text(&binary.right));
        let change = |new: &&str| (format!("replace {old} with {new}"), format!("({left}) {new} ({right})"));
        let changes = others(&binary.op).iter().map(change).collect();
        self.add(binary.span().byte_range(), Form::Expression, binary.op.span(), changes);
    }

    /// An operator before its operand is not there.
    fn unary(&mut self, unary: &syn::ExprUnary) {
        if matches!(unary.op, UnOp::Not(_) | UnOp::Neg(_)) {
            let change = (format!("delete {}", self.line(&unary.op)), self.text(&unary.expr).to_owned());
            self.add(unary.span().byte_range(), Form::Expression, unary.op.span(), vec![change]);
        }
    }

    /// An arm of a `match` is not there, if another one takes all. A guard always holds, or never.
    fn arms(&mut self, arms: &[syn::Arm]) {
        let has_rest = arms.iter().any(|arm| matches!(arm.pat, syn::Pat::Wild(_)) && arm.guard.is_none());
        for arm in arms {
            if let Some((_, guard)) = &arm.guard {
                if !has_let(guard) {
                    let text = self.line(guard);
                    let change = |new: &str| (format!("replace match guard {text} with {new}"), new.to_owned());
                    let changes = ["true", "false"].iter().map(|new| change(new)).collect();
                    self.add(guard.span().byte_range(), Form::Expression, guard.span(), changes);
                }
            } else if has_rest && !matches!(arm.pat, syn::Pat::Wild(_)) {
                let end = arm.pat.span().byte_range().end;
                let change = (format!("delete match arm {}", self.line(&arm.pat)), String::new());
                self.add(end..end, Form::Arm, arm.span(), vec![change]);
            }
            visit::visit_arm(self, arm);
        }
    }

    /// A field has the value of the rest.
    fn fields(&mut self, value: &syn::ExprStruct) {
        let Some(rest) = &value.rest else { return };
        let kind = self.line(&value.path);
        let mut changes = Vec::new();
        for left_out in &value.fields {
            let kept = value.fields.iter().filter(|field| field.member != left_out.member);
            let kept: String = kept.map(|field| format!("{}, ", self.text(field))).collect();
            let member = self.line(&left_out.member);
            let code = format!("{kind} {{ {kept}..{} }}", self.text(rest));
            changes.push((format!("delete field {member} from struct {kind} expression"), code));
        }
        self.add(value.span().byte_range(), Form::Expression, value.span(), changes);
    }
}

/// Items for tests and for features have no sites, and constants have none: they are computed by the compiler.
impl<'a> Visit<'a> for Finder<'_> {
    fn visit_item_mod(&mut self, item: &'a ItemMod) {
        if !is_conditional(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_fn(&mut self, item: &'a ItemFn) {
        if !is_conditional(&item.attrs) {
            self.function(&item.sig, &item.block);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'a ImplItemFn) {
        if !is_conditional(&item.attrs) {
            self.function(&item.sig, &item.block);
        }
    }

    fn visit_trait_item_fn(&mut self, item: &'a TraitItemFn) {
        if let Some(body) = &item.default {
            self.function(&item.sig, body);
        }
    }

    fn visit_item_impl(&mut self, item: &'a ItemImpl) {
        if is_conditional(&item.attrs) {
            return;
        }
        let kind = self.line(&item.self_ty);
        let name = match &item.trait_ {
            Some((_, path, _)) => format!("<impl {} for {kind}>", self.line(path)),
            None => kind,
        };
        self.within(name, |finder| visit::visit_item_impl(finder, item));
    }

    fn visit_item_trait(&mut self, item: &'a ItemTrait) {
        self.within(item.ident.to_string(), |finder| visit::visit_item_trait(finder, item));
    }

    fn visit_expr(&mut self, expression: &'a Expr) {
        match expression {
            Expr::Binary(binary) => self.binary(binary),
            Expr::Unary(unary) => self.unary(unary),
            Expr::Struct(value) => self.fields(value),
            Expr::Match(of) => {
                self.visit_expr(&of.expr);
                return self.arms(&of.arms);
            }
            Expr::Repeat(repeat) => return self.visit_expr(&repeat.expr),
            Expr::Const(_) => return,
            _ => {}
        }
        visit::visit_expr(self, expression);
    }

    fn visit_item_const(&mut self, _: &'a ItemConst) {}
    fn visit_item_static(&mut self, _: &'a ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'a ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'a TraitItemConst) {}
    fn visit_variant(&mut self, _: &'a syn::Variant) {}
    fn visit_type(&mut self, _: &'a syn::Type) {}
    fn visit_pat(&mut self, _: &'a syn::Pat) {}
    fn visit_generic_argument(&mut self, _: &'a syn::GenericArgument) {}
    fn visit_attribute(&mut self, _: &'a Attribute) {}
}

/// Whether an item is only there under a condition, or is a test.
fn is_conditional(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| ["cfg", "test"].iter().any(|name| attribute.path().is_ident(name)))
}

/// Whether an operand has a `let` of its own chain.
fn has_let(operand: &Expr) -> bool {
    match operand {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

/// The operators to try instead of one.
fn others(operator: &BinOp) -> &'static [&'static str] {
    match operator {
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::Lt(_) => &["==", ">", "<="],
        BinOp::Gt(_) => &["==", "<", ">="],
        BinOp::Le(_) => &[">"],
        BinOp::Ge(_) => &["<"],
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) => &["+", "/"],
        BinOp::Mul(_) => &["+", "/"],
        BinOp::Div(_) => &["%", "*"],
        BinOp::Rem(_) => &["/", "+"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        BinOp::BitAnd(_) => &["|", "^"],
        BinOp::BitOr(_) => &["&", "^"],
        BinOp::BitXor(_) => &["|", "&"],
        BinOp::AddAssign(_) => &["-=", "*="],
        BinOp::SubAssign(_) => &["+=", "/="],
        BinOp::MulAssign(_) => &["+=", "/="],
        BinOp::DivAssign(_) => &["%=", "*="],
        BinOp::RemAssign(_) => &["/=", "+="],
        BinOp::ShlAssign(_) => &[">>="],
        BinOp::ShrAssign(_) => &["<<="],
        BinOp::BitAndAssign(_) => &["|="],
        BinOp::BitOrAssign(_) => &["&="],
        BinOp::BitXorAssign(_) => &["|=", "&="],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names and codes of all changes of a source.
    fn changes(source: &str) -> Vec<(String, String)> {
        let sites = of(source).unwrap();
        sites.into_iter().flat_map(|site| site.changes).map(|change| (change.name, change.code)).collect()
    }

    fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
        expected.iter().map(|(name, code)| ((*name).to_owned(), (*code).to_owned())).collect()
    }

    #[test]
    fn a_function_returns_values_and_its_operators_are_others() {
        let found = changes("impl<'a> A<'a> {\n    fn f(&self) -> bool {\n        !self.a || b < 1\n    }\n}\n");
        let expected = [
            ("2:5: replace A<'a>::f -> bool with true", "return true"),
            ("2:5: replace A<'a>::f -> bool with false", "return false"),
            ("3:17: replace || with && in A<'a>::f", "(!self.a) && (b < 1)"),
            ("3:9: delete ! in A<'a>::f", "self.a"),
            ("3:22: replace < with == in A<'a>::f", "(b) == (1)"),
            ("3:22: replace < with > in A<'a>::f", "(b) > (1)"),
            ("3:22: replace < with <= in A<'a>::f", "(b) <= (1)"),
        ];
        assert_eq!(found, pairs(&expected));
    }

    #[test]
    fn arms_guards_and_fields_are_left_out() {
        let found = changes("fn f() -> !{ match a { 1 => b, 2 if c => A { d: 1, e: 2, ..g }, _ => h } }");
        let expected = [
            ("1:24: delete match arm 1 in f", ""),
            ("1:37: replace match guard c with true in f", "true"),
            ("1:37: replace match guard c with false in f", "false"),
            ("1:42: delete field d from struct A expression in f", "A { e: 2, ..g }"),
            ("1:42: delete field e from struct A expression in f", "A { d: 1, ..g }"),
        ];
        assert_eq!(found, pairs(&expected));
    }

    #[test]
    fn constants_tests_and_chains_with_let_stay() {
        let source = "const A: u8 = 1 + 2;\n#[cfg(test)]\nmod tests { fn f() { a + b; } }\n\
                      fn g() -> ! { if let Some(a) = b && c { [0; 1 + 2] } }\n";
        assert!(changes(source).is_empty());
    }
}
