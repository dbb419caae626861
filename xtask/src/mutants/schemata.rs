//! Puts all changes of a file into it at once, each behind a switch.
//!
//! `a - b` with two changes becomes `match (a, b) { (l, r) => if is(1) { l + r } else if is(2) { l / r } else { l - r }
//! }`, so that operands occur once, however many changes are in them. Marks show which change the compiler rejects, by
//! the place of its error: `/*<1*/` and `/*1>*/` around what a change inserts, `/*{1*/` and `/*1}*/` around all that
//! its switch needs.

use super::{
    Out,
    changes::Site,
    text::{Edit, Piece, edited},
};
use anyhow::{Context, Result};
use proc_macro2::Span;
use std::{
    collections::{BTreeMap, HashMap},
    ops::Range,
};
use syn::{
    Arm, BinOp, Block, Expr, ExprBinary, ExprMatch, ExprStruct, ExprUnary, ImplItemFn, ItemFn,
    Member, Pat, ReturnType, Signature, TraitItemFn, Type,
    spanned::Spanned,
    visit::{self, Visit},
};

/// Changes of a file by their site, each with its number and replacement.
pub type Sites = HashMap<Site, Vec<(usize, String)>>;

/// Returns the file's text with all changes behind switches, and those that cannot have one.
pub fn switched(text: &str, sites: &Sites) -> Result<(String, Vec<(usize, Out)>)> {
    let file = syn::parse_file(text).context("the crate's source does not parse")?;
    let all = sites.values().flatten().map(|(change, _)| (*change, Out::NoSwitch));
    let mut schemata = Schemata { text, sites, edits: Vec::new(), out: all.collect() };
    schemata.visit_file(&file);
    Ok((edited(text, &mut schemata.edits), schemata.out.into_iter().collect()))
}

struct Schemata<'a> {
    text: &'a str,
    sites: &'a Sites,
    edits: Vec<Edit>,
    /// Changes that have not been found yet.
    out: BTreeMap<usize, Out>,
}

fn is(change: usize) -> String {
    format!("/*<{change}*/crate::mutant::is({change})/*{change}>*/")
}

fn put_in(change: usize, code: &str) -> String {
    format!("/*<{change}*/{code}/*{change}>*/")
}

impl<'a> Schemata<'a> {
    /// Returns the changes at this place.
    fn at(&mut self, genre: &str, span: Span) -> &'a [(usize, String)] {
        let start = span.start();
        let site = (genre.to_owned(), start.line, start.column + 1);
        let changes = self.sites.get(&site).map_or(&[][..], Vec::as_slice);
        for (change, _) in changes {
            self.out.remove(change);
        }
        changes
    }

    fn refuse(&mut self, changes: &[(usize, String)]) {
        self.out.extend(changes.iter().map(|(change, _)| (*change, Out::DoesNotCompile)));
    }

    fn insert(&mut self, at: usize, code: String) {
        self.edits.push(Edit { range: at..at, pieces: vec![Piece::New(code)] });
    }

    fn replace(&mut self, range: Range<usize>, pieces: Vec<Piece>) {
        self.edits.push(Edit { range, pieces });
    }

    /// Writes `if is(1) { a } else if is(2) { b } else { as it is }`.
    fn choice(
        &self,
        changes: &[(usize, String)],
        changed: impl Fn(&str) -> String,
        unchanged: String,
    ) -> String {
        let mut code = String::new();
        for (change, with) in changes {
            code += &format!("if {} {{ {} }} else ", is(*change), put_in(*change, &changed(with)));
        }
        code + &format!("{{ {unchanged} }}")
    }

    fn function(&mut self, signature: &Signature, block: &Block) {
        let Some(first) = block.stmts.first() else { return };
        let changes = self.at("FnValue", first.span());
        if changes.is_empty() {
            return;
        }
        let body = block.brace_token.span.open().byte_range().end
            ..block.brace_token.span.close().byte_range().start;
        let is_iterator = matches!(&signature.output, ReturnType::Type(_, of) if matches!(**of, Type::ImplTrait(_)));
        if is_iterator {
            // No other iterator can be returned: this one ends at once, and others follow.
            let none: Vec<String> = changes.iter().map(|(change, _)| is(*change)).collect();
            self.insert(body.start, "core::iter::Iterator::take({".into());
            let mut end = format!("}}, if {} {{ 0 }} else {{ usize::MAX }})", none.join(" || "));
            for (change, with) in changes.iter().filter(|(_, with)| with != "::std::iter::empty()")
            {
                end += &format!(
                    ".chain(if {} {{ Some({}) }} else {{ None }}.into_iter().flatten())",
                    is(*change),
                    put_in(*change, with)
                );
            }
            self.insert(body.end, end);
        } else {
            let code = changes.iter().map(|(change, with)| {
                format!(" if {} {{ return {}; }}", is(*change), put_in(*change, with))
            });
            self.insert(body.start, code.collect());
        }
    }

    fn binary(&mut self, binary: &ExprBinary) {
        let changes = self.at("BinaryOperator", binary.op.span());
        // A chain that binds names allows nothing but `&&`.
        if changes.is_empty() {
            return;
        }
        if binds(&binary.left) || binds(&binary.right) {
            return self.refuse(changes);
        }
        let left = Piece::Old(binary.left.span().byte_range());
        let right = Piece::Old(binary.right.span().byte_range());
        let operator = &self.text[binary.op.span().byte_range()];
        let all = binary.span().byte_range();
        let (opening, closing) = marks(changes);
        let new = |code: &str| Piece::New(code.into());
        let pieces = match binary.op {
            BinOp::And(_) | BinOp::Or(_)
                if changes.iter().all(|(_, with)| with == "&&" || with == "||") =>
            {
                let [(change, _)] = changes else { return };
                let off = if operator == "&&" { "==" } else { "!=" };
                vec![
                    Piece::New(format!("({opening}match (")),
                    left,
                    Piece::New(format!(") {{ l => if l {off} {} {{ l }} else {{ ", is(*change))),
                    right,
                    Piece::New(format!(" }} }}{closing})")),
                ]
            }
            BinOp::And(_) | BinOp::Or(_) => return self.refuse(changes),
            BinOp::Eq(_)
            | BinOp::Ne(_)
            | BinOp::Lt(_)
            | BinOp::Le(_)
            | BinOp::Gt(_)
            | BinOp::Ge(_) => {
                let choice = self.choice(
                    changes,
                    |with| format!("*l {with} *r"),
                    format!("*l {operator} *r"),
                );
                vec![
                    Piece::New(format!("({opening}match (&(")),
                    left,
                    new("), &("),
                    right,
                    Piece::New(format!(")) {{ (l, r) => {choice} }}{closing})")),
                ]
            }
            BinOp::Add(_)
            | BinOp::Sub(_)
            | BinOp::Mul(_)
            | BinOp::Div(_)
            | BinOp::Rem(_)
            | BinOp::BitXor(_)
            | BinOp::BitAnd(_)
            | BinOp::BitOr(_)
            | BinOp::Shl(_)
            | BinOp::Shr(_) => {
                let choice =
                    self.choice(changes, |with| format!("l {with} r"), format!("l {operator} r"));
                vec![
                    Piece::New(format!("({opening}match (")),
                    left,
                    new(", "),
                    right,
                    Piece::New(format!(") {{ (l, r) => {choice} }}{closing})")),
                ]
            }
            _ => {
                let mut pieces =
                    vec![Piece::New(format!("({opening}match (")), right, new(") { r => ")];
                let place = binary.left.span().byte_range();
                for (change, with) in changes {
                    pieces.push(Piece::New(format!("if {} {{ /*<{change}*/", is(*change))));
                    pieces.push(Piece::Old(place.clone()));
                    pieces.push(Piece::New(format!(" {with} r/*{change}>*/ }} else ")));
                }
                pieces.extend([
                    new("{ "),
                    Piece::Old(place),
                    Piece::New(format!(" {operator} r }} }}{closing})")),
                ]);
                pieces
            }
        };
        self.replace(all, pieces);
    }

    fn unary(&mut self, unary: &ExprUnary) {
        let [(change, _)] = self.at("UnaryOperator", unary.op.span()) else { return };
        let operand = unary.expr.span().byte_range();
        let operator = &self.text[unary.op.span().byte_range()];
        let pieces = vec![
            Piece::New(format!("(if {} {{ /*<{change}*/", is(*change))),
            Piece::Old(operand.clone()),
            Piece::New(format!("/*{change}>*/ }} else {{ {operator}")),
            Piece::Old(operand),
            Piece::New(" })".into()),
        ];
        self.replace(unary.span().byte_range(), pieces);
    }

    fn arm(&mut self, arm: &Arm, has_rest: bool) {
        let gone = self.at("MatchArm", arm.span());
        if arm.guard.is_none() && !has_rest {
            return self.refuse(gone);
        }
        let gone = gone.first().map(|(change, _)| format!("!{}", is(*change)));
        let Some((_, guard)) = &arm.guard else {
            if let Some(gone) = gone {
                self.insert(arm.pat.span().byte_range().end, format!(" if {gone}"));
            }
            return;
        };
        let changes = self.at("MatchArmGuard", guard.span());
        if gone.is_none() && changes.is_empty() {
            return;
        }
        let range = guard.span().byte_range();
        let mut open = gone.map_or(String::new(), |gone| format!("{gone} && "));
        let of = |value: &str| {
            changes.iter().find(|(_, with)| with == value).map(|(change, _)| is(*change))
        };
        let on = of("true").map_or(String::new(), |on| format!("{on} || "));
        let off = of("false").map_or(String::new(), |off| format!("!{off} && "));
        open += &format!("({on}{off}(");
        self.insert(range.start, open);
        self.insert(range.end, "))".into());
    }

    fn fields(&mut self, node: &ExprStruct) {
        let Some(base) = &node.rest else { return };
        let base = &self.text[base.span().byte_range()];
        for field in &node.fields {
            let [(change, _)] = self.at("StructField", field.span()) else { continue };
            let Member::Named(name) = &field.member else { continue };
            let label =
                if field.colon_token.is_some() { String::new() } else { format!("{name}: ") };
            let taken = put_in(*change, &format!("({base}).{name}"));
            let range = field.expr.span().byte_range();
            self.insert(range.start, format!("{label}if {} {{ {taken} }} else {{ ", is(*change)));
            self.insert(range.end, " }".into());
        }
    }
}

/// Returns marks around a whole expression, for errors that concern all of its changes.
fn marks(changes: &[(usize, String)]) -> (String, String) {
    let mark = |from: fn(usize) -> String| {
        changes.iter().map(|(change, _)| from(*change)).collect::<String>()
    };
    (mark(|change| format!("/*{{{change}*/")), mark(|change| format!("/*{change}}}*/")))
}

/// Returns whether a condition contains a `let`.
fn binds(expression: &Expr) -> bool {
    match expression {
        Expr::Let(_) => true,
        Expr::Binary(ExprBinary { left, right, op: BinOp::And(_), .. }) => {
            binds(left) || binds(right)
        }
        _ => false,
    }
}

impl<'a> Visit<'a> for Schemata<'_> {
    fn visit_item_fn(&mut self, node: &'a ItemFn) {
        self.function(&node.sig, &node.block);
        visit::visit_item_fn(self, node);
    }

    fn visit_impl_item_fn(&mut self, node: &'a ImplItemFn) {
        self.function(&node.sig, &node.block);
        visit::visit_impl_item_fn(self, node);
    }

    fn visit_trait_item_fn(&mut self, node: &'a TraitItemFn) {
        if let Some(block) = &node.default {
            self.function(&node.sig, block);
        }
        visit::visit_trait_item_fn(self, node);
    }

    fn visit_expr_binary(&mut self, node: &'a ExprBinary) {
        self.binary(node);
        visit::visit_expr_binary(self, node);
    }

    fn visit_expr_unary(&mut self, node: &'a ExprUnary) {
        self.unary(node);
        visit::visit_expr_unary(self, node);
    }

    fn visit_expr_match(&mut self, node: &'a ExprMatch) {
        let takes_all =
            |arm: &Arm| arm.guard.is_none() && matches!(arm.pat, Pat::Wild(_) | Pat::Ident(_));
        let has_rest = node.arms.iter().any(takes_all);
        for arm in &node.arms {
            self.arm(arm, has_rest);
        }
        visit::visit_expr_match(self, node);
    }

    fn visit_expr_struct(&mut self, node: &'a ExprStruct) {
        self.fields(node);
        visit::visit_expr_struct(self, node);
    }

    // Constants: no switch reaches them.
    fn visit_type(&mut self, _: &'a Type) {}
    fn visit_item_const(&mut self, _: &'a syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'a syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'a syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'a syn::TraitItemConst) {}
    fn visit_expr_const(&mut self, _: &'a syn::ExprConst) {}
    fn visit_expr_repeat(&mut self, node: &'a syn::ExprRepeat) {
        self.visit_expr(&node.expr);
    }
    fn visit_generic_argument(&mut self, _: &'a syn::GenericArgument) {}
    fn visit_pat(&mut self, _: &'a Pat) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the text with these changes, numbered from 0 and given as (genre, column from 1, replacement), without
    /// its marks.
    fn of(text: &str, changes: &[(&str, usize, &str)]) -> (String, Vec<usize>) {
        let mut sites = Sites::new();
        for (number, (genre, column, with)) in changes.iter().enumerate() {
            let site = ((*genre).to_owned(), 1, *column);
            sites.entry(site).or_default().push((number, (*with).to_owned()));
        }
        let (code, out) = switched(text, &sites).unwrap();
        let code = code.replace("crate::mutant::is", "is");
        let mut parts = code.split("/*");
        let first = parts.next().unwrap().to_owned();
        let code = first + &parts.map(|part| part.split_once("*/").unwrap().1).collect::<String>();
        (code, out.into_iter().map(|(number, _)| number).collect())
    }

    #[test]
    fn operands_stand_once() {
        let changes =
            [("BinaryOperator", 19, "-"), ("BinaryOperator", 19, "*"), ("UnaryOperator", 17, "")];
        let code = "(match ((if is(2) { b } else { -b }), c) \
            { (l, r) => if is(0) { l - r } else if is(1) { l * r } else { l + r } })";
        let (found, out) = of("fn a() -> f32 { -b+c }", &changes);
        assert_eq!(found, format!("fn a() -> f32 {{ {code} }}"));
        assert!(out.is_empty());
    }

    #[test]
    fn the_right_of_a_lazy_operator_stays_lazy() {
        let (code, _) = of("fn a() { b && c }", &[("BinaryOperator", 12, "||")]);
        assert_eq!(code, "fn a() { (match (b) { l => if l == is(0) { l } else { c } }) }");
    }

    #[test]
    fn a_body_is_left_before_it_begins() {
        let (code, _) = of("fn a() -> u8 { b() }", &[("FnValue", 16, "0"), ("FnValue", 16, "1")]);
        assert_eq!(code, "fn a() -> u8 { if is(0) { return 0; } if is(1) { return 1; } b() }");
    }

    #[test]
    fn an_arm_and_its_guard_are_switched() {
        let text = "fn a() { match b { 0 if c => d, 1 => e, _ => f } }";
        let changes = [
            ("MatchArm", 20, ""),
            ("MatchArmGuard", 25, "true"),
            ("MatchArmGuard", 25, "false"),
            ("MatchArm", 33, ""),
        ];
        let code = "0 if !is(0) && (is(1) || !is(2) && (c)) => d, 1 if !is(3) => e, _ => f";
        assert_eq!(of(text, &changes).0, format!("fn a() {{ match b {{ {code} }} }}"));
    }

    #[test]
    fn a_field_that_is_left_out_is_the_other_s() {
        let (code, _) = of("fn a() { B { c: 1, ..d } }", &[("StructField", 14, "")]);
        assert_eq!(code, "fn a() { B { c: if is(0) { (d).c } else { 1 }, ..d } }");
    }

    #[test]
    fn constants_and_conditions_that_bind_have_no_switch() {
        let (code, out) = of("const A: u8 = 1 + 2;", &[("BinaryOperator", 17, "-")]);
        assert_eq!((&*code, out), ("const A: u8 = 1 + 2;", vec![0]));
        let text = "fn a() { if b && let c = d {} }";
        let (code, out) = of(text, &[("BinaryOperator", 15, "||")]);
        assert_eq!((&*code, out), (text, vec![0]));
    }
}
