//! What the elements of a figure take.

use super::node::{FigureCode, FigureElementCode, Node, NodeKind};
use super::symbols::SymbolKind;
use super::{Checked, Compiler, Failed};
use crate::color::Paint;
use crate::diag::{Diagnostic, nearest};
use crate::source::Span;
use crate::syntax::ast::{ExprKind, Figure, FigureElement};
use std::sync::Arc;

/// Kinds of elements, their arguments, those that must be there, and whether bare values may stand.
#[rustfmt::skip]
const KINDS: &[(&str, &[&str], &[&str], bool)] = &[
    ("polygon", &["x", "y", "fill", "stroke", "width", "opacity", "dash", "label", "panel"], &["x", "y"], false),
    ("polyline", &["x", "y", "stroke", "width", "opacity", "dash", "label", "panel"], &["x", "y"], false),
    ("points", &["x", "y", "fill", "stroke", "width", "size", "opacity", "label", "panel"], &["x", "y"], false),
    ("arrow", &["x", "y", "dx", "dy", "stroke", "width", "opacity", "dash", "label", "panel"], &["x", "y", "dx", "dy"], false),
    ("text", &["x", "y", "label", "fill", "size", "align", "opacity", "panel"], &["x", "y", "label"], true),
    ("line", &["x", "y", "stroke", "width", "opacity", "dash", "label", "panel"], &["y"], false),
    ("bar", &["x", "y", "fill", "stroke", "width", "opacity", "label", "panel"], &["y"], false),
    ("errorbar", &["x", "low", "high", "stroke", "width", "opacity", "label", "panel"], &["low", "high"], false),
    ("heat", &["value", "label", "opacity", "panel"], &["value"], true),
    ("contour", &["x", "y", "z", "levels", "stroke", "width", "opacity", "dash", "panel"], &["x", "y", "z"], false),
    ("gantt", &["from", "to", "fill", "stroke", "width", "opacity", "label", "panel"], &["from", "to"], true),
    ("node", &["x", "y", "fill", "stroke", "width", "size", "opacity", "label", "panel"], &[], true),
    ("arc", &["stroke", "width", "opacity", "dash", "label", "panel"], &[], true),
    ("title", &[], &[], true),
    ("axes", &["x", "y"], &[], true),
    ("xaxis", &["label", "min", "max"], &[], true),
    ("yaxis", &["label", "min", "max"], &[], true),
    ("legend", &["label"], &[], true),
    ("size", &["width", "height"], &[], true),
];

/// Words that `axes`, `xaxis`, `yaxis` and `legend` take bare.
const WORDS: &[(&str, &[&str])] = &[
    ("axes", &["none", "on", "equal", "free", "xlog", "ylog"]),
    ("xaxis", &["log"]),
    ("yaxis", &["log"]),
    ("legend", &["none"]),
];

/// The kinds of elements.
pub(crate) fn kinds() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|k| k.0)
}

/// Whether the value of an argument is a text.
pub(crate) fn is_text(n: &Node) -> bool {
    matches!(
        n.kind,
        NodeKind::Text(_)
            | NodeKind::LabelText(_)
            | NodeKind::ElementText(..)
            | NodeKind::SymbolText(_)
            | NodeKind::RecordName(..)
    )
}

impl Compiler {
    pub(super) fn declare_figure(&mut self, f: &Figure) -> Checked<()> {
        self.texts_allowed = true;
        let mut elements = Vec::new();
        for e in &f.elements {
            elements.extend(self.scoped(|c| c.figure_element(e)));
        }
        self.texts_allowed = false;
        let whole = elements.len() == f.elements.len();
        let title = f.title.clone();
        let kind = SymbolKind::Figure(Arc::new(FigureCode { title, elements }));
        self.declare_plain(&f.name, kind, f.title.as_deref())?;
        whole.then_some(()).ok_or(Failed)
    }

    fn figure_element(&mut self, e: &FigureElement) -> Checked<FigureElementCode> {
        let kind = e.kind.name.to_lowercase();
        if !kinds().any(|k| k == kind) {
            let all = kinds().collect::<Vec<_>>().join(", ");
            return Diagnostic::error("E0332", e.kind.span)
                .says(format!("a figure has no element `{}`", e.kind.name))
                .label("unknown element")
                .did_you_mean(nearest(&kind, kinds()), format!("there are: {all}"))
                .fail(self);
        }
        // The levels and data that a figure shows need not be there when it is declared.
        self.in_equation = true;
        let r = (|| {
            let domain = e.domain.as_ref().map(|d| self.domain(d)).transpose()?;
            let mut arguments = Vec::new();
            for (name, value) in &e.arguments {
                // A bare word that names nothing is a word: `fill = none`.
                let node = match &value.kind {
                    ExprKind::Apply(word, None, None)
                        if self.symbols.find(&word.name).is_none() =>
                    {
                        Node::data(NodeKind::Text(word.name.clone()), value.span)
                    }
                    _ => self.expr(value)?,
                };
                if node.has_var {
                    return Diagnostic::error("E0310", node.span)
                        .says("a variable is not a number; a figure shows its level")
                        .label("which of its numbers?")
                        .help("write `.l` behind the variable's name")
                        .fail(self);
                }
                arguments.push((name.as_ref().map(|n| n.name.to_lowercase().into()), node));
            }
            let code = FigureElementCode {
                kind: kind.into(),
                domain,
                arguments,
                span: e.span,
            };
            self.figure_arguments(e, &code)?;
            Ok(code)
        })();
        self.in_equation = false;
        self.reads.clear();
        r
    }

    /// Checks names and types of an element's arguments.
    pub(super) fn figure_arguments(
        &mut self,
        e: &FigureElement,
        code: &FigureElementCode,
    ) -> Checked<()> {
        let Some(&(kind, known, required, bare)) = KINDS.iter().find(|k| k.0 == &*code.kind) else {
            return Ok(());
        };
        for ((name, value), (ident, _)) in code.arguments.iter().zip(&e.arguments) {
            let Some(name) = name.as_deref() else {
                self.bare_value(kind, bare, value)?;
                continue;
            };
            if !known.contains(&name) {
                let span = ident.as_ref().map_or(value.span, |i| i.span);
                let d = Diagnostic::error("E0370", span)
                    .says(format!("`{kind}` has no argument `{name}`"))
                    .label("unknown argument");
                let mut names = known.iter().copied();
                let near = match name {
                    "color" | "colour" => names.find(|k| matches!(*k, "fill" | "stroke")),
                    _ => nearest(name, names),
                };
                let help = match known.is_empty() {
                    true => format!("`{kind}` takes values without names"),
                    false => format!("there are: {}", known.join(", ")),
                };
                return d.did_you_mean(near, help).fail(self);
            }
            self.fits_argument(kind, name, value)?;
        }
        let given = |r: &str| code.arguments.iter().any(|(n, _)| n.as_deref() == Some(r));
        if let Some(r) = required.iter().find(|r| !given(r)) {
            let all: Vec<String> = required.iter().map(|r| format!("{r} = …")).collect();
            return Diagnostic::error("E0373", e.kind.span)
                .says(format!("`{kind}` needs `{r}`"))
                .label(format!("`{r} = …` is missing"))
                .help(format!("write `{kind}(…) {};`", all.join(", ")))
                .fail(self);
        }
        self.has_indices(kind, e.kind.span, code)
    }

    /// An error for a text where a number belongs, and for what is no colour.
    fn fits_argument(&mut self, kind: &str, name: &str, value: &Node) -> Checked<()> {
        if matches!(name, "x" | "y") && kind == "axes" {
            return Ok(());
        }
        if matches!(
            name,
            "x" | "y" | "dx" | "dy" | "width" | "height" | "opacity" | "size" | "low" | "high"
                | "from" | "to" | "z" | "value" | "levels" | "min" | "max"
        ) && is_text(value)
            // A chart stands against labels as well.
            && !(name == "x" && matches!(kind, "line" | "bar" | "errorbar"))
        {
            return Diagnostic::error("E0371", value.span)
                .says(format!("`{name}` of `{kind}` is a number"))
                .label("this is a text")
                .help(format!("give an expression, for instance `{name} = p(i)`"))
                .fail(self);
        }
        if let ("fill" | "stroke", NodeKind::Text(t)) = (name, &value.kind)
            && Paint::parse(t).is_none()
        {
            let near = nearest(t, Paint::names().iter().copied()).map(|n| format!("'{n}'"));
            return Diagnostic::error("E0372", value.span)
                .says(format!("`{t}` is not a colour"))
                .label("unknown colour")
                .did_you_mean(near, "colours are CSS names (`'steelblue'`), `'#rrggbb'`, `none`, or a number for the colour scale")
                .fail(self);
        }
        Ok(())
    }

    /// An error for an element without the indices that it runs over.
    fn has_indices(&mut self, kind: &str, span: Span, code: &FigureElementCode) -> Checked<()> {
        let slots = code.domain.as_ref().map_or(0, |d| d.slots.len());
        if matches!(kind, "heat" | "contour" | "arc" | "gantt") && slots < 2 {
            let example = match kind {
                "arc" => "`arc(i,j)`: from node i to node j",
                "gantt" => "`gantt(machine,job)`: a row for each machine",
                _ => "of two indices, the first runs along x, the last along y",
            };
            return Diagnostic::error("E0373", span)
                .says(format!("`{kind}` needs two indices"))
                .label(format!("{slots} here"))
                .help(format!("write {example}"))
                .fail(self);
        }
        if matches!(
            kind,
            "polygon" | "polyline" | "line" | "bar" | "errorbar" | "node"
        ) && slots == 0
        {
            return Diagnostic::error("E0373", span)
                .says(format!("`{kind}` needs an index that runs over its points"))
                .label("no index here")
                .help(format!("write `{kind}(i)`; of several indices the last runs along, the others give one {kind} each"))
                .fail(self);
        }
        Ok(())
    }

    /// A value without a name.
    fn bare_value(&mut self, kind: &str, bare: bool, value: &Node) -> Checked<()> {
        if !bare {
            return Diagnostic::error("E0370", value.span)
                .says(format!("`{kind}` takes values with names"))
                .label("which argument?")
                .help("for instance `x = p(i)`")
                .fail(self);
        }
        let words = WORDS.iter().find(|w| w.0 == kind).map_or(&[][..], |w| w.1);
        if let ("axes", NodeKind::Text(t)) = (kind, &value.kind)
            && !words.contains(&t.to_lowercase().as_str())
        {
            let all = words.join(", ");
            return Diagnostic::error("E0370", value.span)
                .says(format!("`axes` does not know the word `{t}`"))
                .label("unknown word")
                .did_you_mean(
                    nearest(t, words.iter().copied()),
                    format!("there are: {all}; labels are written `x = 'text'`"),
                )
                .fail(self);
        }
        if kind == "size" && is_text(value) {
            return Diagnostic::error("E0371", value.span)
                .says("`size` takes numbers: width and height in pixels")
                .label("this is a text")
                .fail(self);
        }
        Ok(())
    }
}
