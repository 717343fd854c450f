//! Pass 7: the agents at t = 0, from `system` and its data files.
//!
//! Every block is planned first: where each of its values comes from, how many agents it has. Only then is anything
//! made, so that a block may refer to one behind it, and a count beyond the limit costs no memory.

use rustc_hash::FxHashMap;

use super::context::{Context, Home, Member, Scope};
use super::dimension::Dimension;
use super::error::{FileError, LimitError, SystemError, TypeError, ValueError};
use super::ir::{Block, Given, ModeId, TypeId};
use super::plan::{Plan, Source};
use super::suggest::closest;
use super::table::{self, Header, Wanted};
use super::types::{Slot, Ty};
use crate::base::{FileId, Span};
use crate::syntax::ast::{self, Count, GivenKind, Item};

/// A data file that has been opened.
struct Data {
    file: FileId,
    header: Header,
    used: Span,
}

/// Makes the population.
pub(super) fn populate<'a>(context: &mut Context<'a>, items: &[&'a Item]) {
    let instances = items.iter().filter_map(|item| match item {
        Item::System(system) => Some(&system.instances),
        _ => None,
    });
    let mut plans = Vec::new();
    for item in instances.flatten() {
        plans.extend(context.plan(item));
    }
    for plan in &mut plans {
        context.plan_links(plan);
    }
    for plan in &plans {
        context.from_data.extend(plan.given_by_data());
    }
    context.model.population.fixed = context.fixed(&plans);
    context.check_values();
    if !context.has_errors() {
        context.make(&plans);
    }
}

impl<'a> Context<'a> {
    /// The discrete variables that all plans of their type leave at a declared constant.
    fn fixed(&self, plans: &[Plan]) -> Vec<(TypeId, usize)> {
        let is_closed = |given: &Given| matches!(given, Given::Value(id) if self.facts[id.index()].closed);
        let is_fixed = |source: &Source| matches!(source, Source::Declared(given) if is_closed(given));
        let mut by_type: FxHashMap<TypeId, Vec<bool>> = FxHashMap::default();
        for plan in plans {
            let all = by_type.entry(plan.ty).or_insert_with(|| vec![true; plan.discretes.len()]);
            all.iter_mut().zip(&plan.discretes).for_each(|(all, source)| *all &= is_fixed(source));
        }
        for create in self.model.creations() {
            let all = by_type.entry(create.ty).or_insert_with(|| vec![true; create.discretes.len()]);
            let declared = &self.model.types[create.ty].initials.discretes;
            for ((all, given), declared) in all.iter_mut().zip(&create.discretes).zip(declared) {
                *all &= given.is_none() && declared.as_ref().is_some_and(is_closed);
            }
        }
        let of_type = |ty: TypeId| {
            let all = by_type.get(&ty).into_iter().flatten().enumerate();
            all.filter(|(_, fixed)| **fixed).map(move |(k, _)| (ty, k)).collect::<Vec<_>>()
        };
        self.model.types.indices().flat_map(of_type).collect()
    }

    /// Refuses agents that hold too many numbers together, before there are any.
    fn check_values(&mut self) {
        let most = self.model.limits.values_max;
        let mut values = 0usize;
        for block in &self.model.population.blocks {
            let ty = &self.model.types[block.ty];
            let each = ty.params.len() + ty.states.len() + ty.discretes.len() + ty.links.len();
            values = values.saturating_add(each.saturating_mul(block.count));
            if values > most {
                return self.report(LimitError::Values { what: "in all agents", most, span: block.span });
            }
        }
    }

    fn plan(&mut self, item: &'a ast::Instance) -> Option<Plan<'a>> {
        let constructor = &item.constructor;
        let ty = self.agent_named(&constructor.agent)?;
        let mode = self.start_mode(ty, constructor.start.as_deref());
        let names = &self.agents[ty.index()];
        let missing = |slots: &[Slot]| vec![Source::Missing; slots.len()];
        let mut plan = Plan {
            item,
            ty,
            mode,
            params: missing(&names.params),
            states: missing(&names.states),
            discretes: missing(&names.discretes),
            links: self.model.types[ty].links.iter().map(|_| None).collect(),
            columns: Vec::new(),
            misspelt: Vec::new(),
        };
        let given = self.plan_arguments(&mut plan);
        let data = constructor.source.as_ref().map(|source| self.open(source));
        let mut wanted = Vec::new();
        if let Some(Some(data)) = &data {
            wanted = self.plan_columns(&mut plan, data, &given);
        }
        if !matches!(data, Some(None)) {
            self.plan_declared(&mut plan, &given);
        }
        let count = self.count(item, &data);
        let count = match (&data, count) {
            (Some(Some(data)), Some(count)) => self.read_data(&mut plan, data, &wanted, count),
            (_, count) => count.unwrap_or(Some(0)),
        };
        let count = count.unwrap_or(0);
        let total = self.model.population.blocks.last().map_or(0, |block| block.first + block.count);
        self.model.population.blocks.push(Block {
            name: item.name.text.clone(),
            ty,
            first: total,
            count,
            array: constructor.count.is_some(),
            span: item.name.span,
        });
        let most = self.model.limits.agents_max;
        if total.saturating_add(count) > most {
            let count = total as f64 + count as f64;
            self.report(LimitError::Agents { count, most, span: item.span });
        }
        Some(plan)
    }

    /// The leaf that is entered by default in the mode that is named, or in the agent.
    pub fn start_mode(&mut self, ty: TypeId, start: Option<&'a ast::Target>) -> ModeId {
        let root = ModeId::new(0);
        let mut mode = start.and_then(|target| self.resolve_mode(ty, root, target)).unwrap_or(root);
        while let Some(inner) = self.model.types[ty].modes[mode].initial {
            mode = inner;
        }
        mode
    }

    /// Arguments that are numbers; returns the place of every argument by name.
    fn plan_arguments(&mut self, plan: &mut Plan<'a>) -> FxHashMap<&'a str, Span> {
        let mut given = FxHashMap::default();
        for arg in &plan.item.constructor.args {
            let name = arg.name.text.as_str();
            if let Some(first) = given.insert(name, arg.name.span) {
                let help = "leave one of them out";
                self.report(SystemError::GivenTwice {
                    name: name.to_string(),
                    span: arg.name.span,
                    first,
                    help,
                });
            }
            let member = self.agents[plan.ty.index()].members.get(name).map(|(member, _)| *member);
            let names = &self.agents[plan.ty.index()];
            let (slot, source) = match member {
                Some(Member::Param(number)) => (names.params[number], &mut plan.params[number]),
                Some(Member::State(number)) => (names.states[number], &mut plan.states[number]),
                Some(Member::Discrete(number)) => (names.discretes[number], &mut plan.discretes[number]),
                Some(Member::Link(number)) => {
                    self.check_link_argument(plan.ty, number, &arg.name);
                    continue;
                }
                Some(Member::Twice) => continue,
                Some(Member::Let(_) | Member::Event(_)) | None => {
                    let is_let = matches!(member, Some(Member::Let(_)));
                    plan.misspelt.extend(self.unknown_argument(plan.ty, &arg.name, is_let));
                    continue;
                }
            };
            if let Some(given) = self.argument_value(arg, slot) {
                *source = Source::Argument(given);
            }
        }
        given
    }

    /// What an argument gives; none, and a diagnostic, if it is wrong or not a constant.
    fn argument_value(&mut self, arg: &'a ast::NamedArg, slot: Slot) -> Option<Given> {
        let (what, value) = (format!("`{}`", arg.name.text), &arg.given.value);
        let mut scope = Scope::of(Home::Construction);
        let given = match arg.given.kind {
            GivenKind::Value => {
                let value = self.lower_into(&mut scope, value, slot, &what);
                if value.ty == Ty::Wrong {
                    return None;
                }
                Given::Value(value.id)
            }
            GivenKind::Draw => Given::Draw(self.lower_draw(&mut scope, value, slot)?),
        };
        if given.exprs().iter().all(|id| self.facts[id.index()].pure) {
            return Some(given);
        }
        self.report(ValueError::NotConstant { what, span: value.span });
        None
    }

    pub fn unknown_argument(&mut self, ty: TypeId, name: &ast::Name, is_let: bool) -> Option<String> {
        let similar = closest(&name.text, self.agents[ty.index()].members.keys().copied());
        let agent = self.model.types[ty].name.clone();
        let (name, span) = (name.text.clone(), name.span);
        self.report(SystemError::UnknownArgument { name, agent, span, similar: similar.clone(), is_let });
        similar
    }

    /// The file behind `from csv(...)`; none, and a diagnostic, if it cannot be used.
    fn open(&mut self, source: &'a ast::Expr) -> Option<Data> {
        let path = match &source.kind {
            ast::ExprKind::Call { callee, args } => match (&callee.kind, args.as_slice()) {
                (ast::ExprKind::Name(name), [path]) if name == "csv" => Some(path),
                _ => None,
            },
            _ => None,
        };
        let Some(path) = path else {
            let (what, expected) =
                ("what follows `from`".to_string(), "a data file, `csv(\"file.csv\")`".to_string());
            let found = "something else".to_string();
            self.report(TypeError::Mismatch { what, expected, found, span: source.span, help: None });
            return None;
        };
        let file = self.open_file(path)?;
        match table::read_header(file, &self.sources.file(file).text) {
            Ok(header) => Some(Data { file, header, used: source.span }),
            Err(error) => {
                self.report(error);
                None
            }
        }
    }

    fn plan_columns(
        &mut self,
        plan: &mut Plan<'a>,
        data: &Data,
        given: &FxHashMap<&'a str, Span>,
    ) -> Vec<Wanted> {
        let mut wanted = Vec::new();
        for (column, (name, span)) in data.header.columns.iter().enumerate() {
            let names = &self.agents[plan.ty.index()];
            let (slot, source) = match names.members.get(name.as_str()).map(|(member, _)| *member) {
                Some(Member::Param(number)) => (names.params[number], &mut plan.params[number]),
                Some(Member::State(number)) => (names.states[number], &mut plan.states[number]),
                Some(Member::Discrete(number)) => (names.discretes[number], &mut plan.discretes[number]),
                Some(Member::Twice) => continue,
                Some(Member::Link(_) | Member::Let(_) | Member::Event(_)) | None => {
                    if !(name.starts_with('_') || name == "i" || name == "index") {
                        plan.misspelt.extend(self.unknown_column(plan.ty, name, *span, data.used));
                    }
                    continue;
                }
            };
            if let Some(&first) = given.get(name.as_str()) {
                let help = "leave one of them out; a column whose name begins with `_` is passed over";
                self.report(SystemError::GivenTwice { name: name.clone(), span: *span, first, help });
            }
            *source = Source::Column(wanted.len());
            wanted.push(Wanted { column, slot });
        }
        wanted
    }

    fn unknown_column(&mut self, ty: TypeId, name: &str, span: Span, used: Span) -> Option<String> {
        let model = &self.model.types[ty];
        let variables = model.params.iter().chain(&model.states).chain(&model.discretes);
        let similar = closest(name, variables.map(|variable| variable.name.as_str()));
        let agent = model.name.clone();
        let name = name.to_string();
        self.report(FileError::UnknownColumn { name, agent, span, similar: similar.clone(), used });
        similar
    }

    /// What neither an argument nor a column gives comes from the agent type, or is missing.
    fn plan_declared(&mut self, plan: &mut Plan<'a>, given: &FxHashMap<&'a str, Span>) {
        let model = &self.model.types[plan.ty];
        let initials = &model.initials;
        let parts = [
            ("parameter", &model.params, &mut plan.params, &initials.params),
            ("state", &model.states, &mut plan.states, &initials.states),
            ("discrete variable", &model.discretes, &mut plan.discretes, &initials.discretes),
        ];
        let mut missing: Vec<(&'static str, String, Span)> = Vec::new();
        for (kind, variables, sources, declared) in parts {
            for ((variable, source), declared) in variables.iter().zip(sources).zip(declared) {
                match (*source, declared) {
                    (Source::Missing, Some(value)) => *source = Source::Declared(*value),
                    (Source::Missing, None) if !given.contains_key(variable.name.as_str()) => {
                        missing.push((kind, variable.name.clone(), variable.span));
                    }
                    (Source::Missing | Source::Argument(_) | Source::Column(_) | Source::Declared(_), _) => {}
                }
            }
        }
        let unlinked =
            model.links.iter().filter(|link| link.required && !given.contains_key(link.name.as_str()));
        missing.extend(unlinked.map(|link| ("parameter", link.name.clone(), link.span)));
        for (kind, name, declared) in missing {
            let twice =
                matches!(self.agents[plan.ty.index()].members.get(name.as_str()), Some((Member::Twice, _)));
            if !twice && !plan.misspelt.contains(&name) && !self.declared_with_value(plan.ty, &name) {
                let agent = self.model.types[plan.ty].name.clone();
                self.report(SystemError::Missing {
                    kind,
                    name,
                    agent,
                    span: plan.item.constructor.span,
                    declared,
                });
            }
        }
    }

    /// Whether a variable has a value in the text, though it was refused.
    pub fn declared_with_value(&self, ty: TypeId, name: &str) -> bool {
        let item = self.agents[ty.index()].item;
        let formal = item.formals.iter().any(|formal| formal.name.text == name && formal.default.is_some());
        formal
            || item.items.iter().any(|part| match part {
                ast::AgentItem::Variables(line) => line
                    .variables
                    .iter()
                    .any(|variable| variable.name.text == name && variable.initial.is_some()),
                _ => false,
            })
    }

    /// How many agents: none if that is wrong, `Some(None)` for one per row.
    fn count(&mut self, item: &'a ast::Instance, data: &Option<Option<Data>>) -> Option<Option<usize>> {
        match &item.constructor.count {
            None => Some(Some(1)),
            Some(Count::AllRows(span)) => {
                if data.is_none() {
                    self.report(SystemError::NoRows {
                        agent: item.constructor.agent.text.clone(),
                        span: *span,
                    });
                }
                data.as_ref().and_then(|data| data.as_ref()).map(|_| None)
            }
            Some(Count::Exactly(expr)) => {
                let what = "the size of an array";
                let value = self.lower_number(&mut Scope::of(Home::File), expr, "[ ]");
                self.expect(value, Slot::of(Dimension::ONE), what);
                let count = self.constant(value, expr, what)?;
                if count.fract() != 0.0 || count < 0.0 {
                    self.report(ValueError::BadCount { value: count, span: expr.span });
                    return None;
                }
                let most = self.model.limits.agents_max;
                if count > most as f64 {
                    self.report(LimitError::Agents { count, most, span: expr.span });
                    return None;
                }
                Some(Some(count as usize))
            }
        }
    }

    /// Reads the rows; returns how many agents there are.
    fn read_data(
        &mut self,
        plan: &mut Plan<'a>,
        data: &Data,
        wanted: &[Wanted],
        count: Option<usize>,
    ) -> Option<usize> {
        let text = &self.sources.file(data.file).text;
        let most = self.model.limits.agents_max;
        match table::read_rows(data.file, text, &data.header, wanted, count.unwrap_or(most.saturating_add(1)))
        {
            Ok(rows) => {
                plan.columns = rows.values;
                if let Some(needed) = count.filter(|&needed| rows.count < needed) {
                    let (found, span) = (rows.count, rows.last);
                    let used = plan.item.constructor.span;
                    self.report(FileError::TooFewRows { needed, found, span, used });
                }
                Some(rows.count)
            }
            Err(errors) => {
                for error in errors {
                    self.report(error);
                }
                count
            }
        }
    }
}
