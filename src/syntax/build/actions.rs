//! Actions: what transitions, entries and exits do.

use super::Builder;
use crate::syntax::ast::*;
use crate::syntax::grammar::Rule;
use crate::syntax::pieces::{Parts, Piece, Unread};

impl Builder<'_> {
    pub(super) fn actions(&mut self, piece: Piece<'_>) -> Result<Actions, Unread> {
        let span = self.span(&piece);
        let actions = self.many_of(Parts::of(piece), |this, part| {
            let span = this.span(&part);
            Ok(this.action(part)?.map(|kind| Action { kind, span }))
        })?;
        Ok(Actions { actions, span })
    }

    /// One action; none for braces.
    fn action(&mut self, piece: Piece<'_>) -> Result<Option<ActionKind>, Unread> {
        let rule = piece.rule();
        let mut parts = Parts::of(piece);
        Ok(Some(match rule {
            Rule::assignment => self.assignment(parts)?,
            Rule::create => {
                parts.expect(Rule::kw_create)?;
                ActionKind::Create(Box::new(self.constructor(parts.expect(Rule::constructor)?)?))
            }
            Rule::destroy => {
                parts.expect(Rule::kw_destroy)?;
                ActionKind::Destroy(self.expr(parts.expect(Rule::expr)?)?)
            }
            Rule::emit => self.emit(parts)?,
            Rule::change_mode => {
                let participant = self.name(parts.expect(Rule::name)?);
                parts.expect(Rule::arrow)?;
                ActionKind::ChangeMode { participant, target: self.target(parts.expect(Rule::target)?)? }
            }
            Rule::stop => {
                parts.expect(Rule::kw_stop)?;
                ActionKind::Stop(parts.next_if(Rule::string)?.map(|reason| self.text(reason)))
            }
            Rule::branches => self.branches(parts)?,
            _ => return Ok(None),
        }))
    }

    fn assignment(&mut self, mut parts: Parts<'_>) -> Result<ActionKind, Unread> {
        let place = self.place(parts.expect(Rule::place)?)?;
        let kind = if parts.any()?.rule() == Rule::tilde { GivenKind::Draw } else { GivenKind::Value };
        Ok(ActionKind::Assign { place, given: Given { kind, value: self.expr(parts.expect(Rule::expr)?)? } })
    }

    fn place(&mut self, piece: Piece<'_>) -> Result<Place, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let first = self.name(parts.expect(Rule::name)?);
        Ok(if parts.has(Rule::dot)? {
            Place { owner: Some(Box::new(first)), variable: self.name(parts.expect(Rule::name)?), span }
        } else {
            Place { owner: None, variable: first, span }
        })
    }

    fn emit(&mut self, mut parts: Parts<'_>) -> Result<ActionKind, Unread> {
        parts.expect(Rule::kw_emit)?;
        let event = self.place(parts.expect(Rule::place)?)?;
        let args = parts.next_if(Rule::call_args)?.map(|args| self.call_args(args)).transpose()?;
        let delay = match parts.has(Rule::kw_after)? {
            true => Some(Box::new(self.time(parts.expect(Rule::expr)?)?)),
            false => None,
        };
        Ok(ActionKind::Emit { event, args: args.unwrap_or_default(), delay })
    }

    fn branches(&mut self, mut parts: Parts<'_>) -> Result<ActionKind, Unread> {
        let mut branches = Vec::new();
        let mut otherwise = None;
        loop {
            if parts.has(Rule::kw_if)? {
                let condition = self.expr(parts.expect(Rule::expr)?)?;
                branches.push(Branch { condition, actions: self.actions(parts.expect(Rule::actions)?)? });
            } else {
                otherwise = Some(self.actions(parts.expect(Rule::actions)?)?);
            }
            if !parts.has(Rule::kw_else)? {
                branches.shrink_to_fit();
                return Ok(ActionKind::If { branches, otherwise });
            }
        }
    }
}
