//! `hyc show`: a model at a stage of its way, as text.

use super::arguments::{PictureForm, ShowArguments, Stage};
use super::input::{Loaded, Parsed, load, parse, settings_with};
use super::terminal::{say, tell};
use super::{Exit, Refused};
use crate::picture::{Theme, modes_dot, modes_svg};
use crate::{calculus, codegen, model, syntax};

/// Prints the stage, or what keeps the model from reaching it.
pub(super) fn show(arguments: &ShowArguments) -> Result<Exit, Refused> {
    if arguments.format.is_some() && arguments.stage != Stage::Modes {
        return Err("`--format` belongs to `--stage modes`; the other stages are text".into());
    }
    if arguments.stage == Stage::Ast {
        return show_tree(arguments);
    }
    let loaded = load(&arguments.model, &settings_with(&arguments.params, &arguments.limits)?)?;
    tell(&loaded.sources, &loaded.diagnostics);
    let exit = loaded.exit();
    let Loaded { sources, model: Some(model), .. } = loaded else { return Ok(exit) };
    if arguments.stage == Stage::Model {
        say(&model::dump(&model))?;
        return Ok(Exit::Fine);
    }
    if arguments.stage == Stage::Modes {
        let diagrams = model::diagrams(&model, &sources);
        say(&match arguments.format {
            None | Some(PictureForm::Dot) => modes_dot(&diagrams),
            Some(PictureForm::Svg) => modes_svg(&diagrams, Theme::Own),
        })?;
        return Ok(Exit::Fine);
    }
    let system = match calculus::derive(&model) {
        Ok(system) => system,
        Err(diagnostics) => {
            tell(&sources, &diagnostics);
            return Ok(Exit::ModelErrors);
        }
    };
    let text = match arguments.stage {
        Stage::Ast | Stage::Model | Stage::Modes | Stage::System => calculus::dump(&system),
        Stage::Tape => codegen::dump_tape(&system),
        Stage::Clif => codegen::dump_clif(&system),
    };
    say(&text)?;
    Ok(Exit::Fine)
}

/// The first stage needs no more than a text that parses.
fn show_tree(arguments: &ShowArguments) -> Result<Exit, Refused> {
    let Parsed { sources, tree } = parse(&arguments.model)?;
    match tree {
        Ok(tree) => {
            say(&syntax::dump(&tree))?;
            Ok(Exit::Fine)
        }
        Err(diagnostics) => {
            tell(&sources, &diagnostics);
            Ok(Exit::ModelErrors)
        }
    }
}
