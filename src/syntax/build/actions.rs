//! Actions: what transitions, entries and exits do.

use super::Builder;
use crate::syntax::ast::*;
use crate::syntax::grammar::{Parts, Piece, Rule};

impl Builder<'_> {
    pub(super) fn actions(&mut self, piece: Piece<'_>) -> Actions {
        let span = self.span(&piece);
        let mut actions = Vec::new();
        for part in Parts::of(piece).rest() {
            let span = self.span(&part);
            if let Some(kind) = self.action(part) {
                actions.push(Action { kind, span });
            }
        }
        Actions { actions, span }
    }

    /// One action; none for braces.
    fn action(&mut self, piece: Piece<'_>) -> Option<ActionKind> {
        let rule = piece.as_rule();
        let mut parts = Parts::of(piece);
        Some(match rule {
            Rule::assignment => self.assignment(parts),
            Rule::create => {
                parts.expect(Rule::kw_create);
                ActionKind::Create(self.constructor(parts.expect(Rule::constructor)))
            }
            Rule::destroy => {
                parts.expect(Rule::kw_destroy);
                ActionKind::Destroy(self.expr(parts.expect(Rule::expr)))
            }
            Rule::emit => self.emit(parts),
            Rule::change_mode => {
                let participant = self.name(parts.expect(Rule::name));
                parts.expect(Rule::arrow);
                ActionKind::ChangeMode { participant, target: self.target(parts.expect(Rule::target)) }
            }
            Rule::stop => {
                parts.expect(Rule::kw_stop);
                ActionKind::Stop(parts.next_if(Rule::string).map(|reason| self.text(reason)))
            }
            Rule::branches => self.branches(parts),
            _ => return None,
        })
    }

    fn assignment(&mut self, mut parts: Parts<'_>) -> ActionKind {
        let place = self.place(parts.expect(Rule::place));
        let kind = if parts.next().as_rule() == Rule::tilde { GivenKind::Draw } else { GivenKind::Value };
        ActionKind::Assign { place, given: Given { kind, value: self.expr(parts.expect(Rule::expr)) } }
    }

    fn place(&mut self, piece: Piece<'_>) -> Place {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let first = self.name(parts.expect(Rule::name));
        if parts.skip(Rule::dot) {
            Place { owner: Some(first), variable: self.name(parts.expect(Rule::name)), span }
        } else {
            Place { owner: None, variable: first, span }
        }
    }

    fn emit(&mut self, mut parts: Parts<'_>) -> ActionKind {
        parts.expect(Rule::kw_emit);
        let event = self.name(parts.expect(Rule::name));
        let args = parts.next_if(Rule::call_args).map(|args| self.call_args(args)).unwrap_or_default();
        let delay = parts.skip(Rule::kw_after).then(|| self.time(parts.expect(Rule::expr)));
        ActionKind::Emit { event, args, delay }
    }

    fn branches(&mut self, mut parts: Parts<'_>) -> ActionKind {
        let mut branches = Vec::new();
        let mut otherwise = None;
        loop {
            if parts.skip(Rule::kw_if) {
                let condition = self.expr(parts.expect(Rule::expr));
                branches.push(Branch { condition, actions: self.actions(parts.expect(Rule::actions)) });
            } else {
                otherwise = Some(self.actions(parts.expect(Rule::actions)));
            }
            if !parts.skip(Rule::kw_else) {
                return ActionKind::If { branches, otherwise };
            }
        }
    }
}
