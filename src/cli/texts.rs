//! The files of a model, and where in them its transitions stand, for its page.

use std::collections::BTreeMap;
use std::path::Path;

use crate::base::{SourceMap, Span};
use crate::model::Model;
use crate::picture::{Lines, Text};

/// The model's own file, then those that it imports.
pub(super) fn texts<'s>(model: &Model, sources: &'s SourceMap) -> Vec<Text<'s>> {
    // The model's own is the last to declare anything; the others are named from its folder.
    let own = |name: &'s str| Path::new(name).file_name().and_then(|name| name.to_str()).unwrap_or(name);
    let files = model.files.iter().rev().map(|&file| sources.file(file)).enumerate();
    files
        .map(|(k, file)| Text { name: if k == 0 { own(&file.name) } else { &file.name }, text: &file.text })
        .collect()
}

/// The lines of every transition, by its label.
pub(super) fn places(model: &Model, sources: &SourceMap) -> BTreeMap<String, Lines> {
    let own = model.types.iter().flat_map(|ty| &ty.transitions);
    let of_pairs = model.interactions.iter().flat_map(|interaction| &interaction.transitions);
    let place = |span: Span| {
        let file = model.files.iter().rev().position(|&file| file == span.file)?;
        let first = sources.line_column(span).0;
        let last = sources.line_column(Span { start: span.end, ..span }).0;
        Some(Lines { file, lines: [first, last] })
    };
    own.chain(of_pairs).filter_map(|item| Some((item.label.clone(), place(item.span)?))).collect()
}
