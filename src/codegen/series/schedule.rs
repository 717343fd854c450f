//! How long rows are, and in which order their recurrences are done.
//!
//! In: instructions, operands before users but for what waits for a later round. A row is short where its series ends: the
//! time has two coefficients, a polynomial of it some more, so that `sin(w time + p)` costs a multiplication a coefficient.

use crate::codegen::series::{ENDLESS, Fixed, Instruction, ORDER_MAX, Recurrence, RowId, SeriesTape};

/// Of each row, how many of its first coefficients can differ from 0: the least that is known.
pub fn lengths(instructions: &[Instruction], n_rows: usize) -> Vec<u32> {
    let mut lengths = vec![ENDLESS; n_rows];
    // Every round settles a row or is the last; a state of a chain waits for the rate that stands after it.
    loop {
        let before = lengths.clone();
        for instruction in instructions {
            let own = length(&instruction.recurrence, &lengths);
            lengths[instruction.to as usize] = own;
            match instruction.recurrence {
                Recurrence::Div { inverse, .. } | Recurrence::Root { inverse, .. } => {
                    lengths[inverse as usize] = 1;
                }
                Recurrence::SinCos { cosine, .. } => lengths[cosine as usize] = own,
                _ => {}
            }
        }
        if lengths == before {
            return lengths;
        }
    }
}

fn length(recurrence: &Recurrence, lengths: &[u32]) -> u32 {
    let of = |row: RowId| lengths[row as usize];
    let longer = |length: u32| if length == ENDLESS { ENDLESS } else { length + 1 };
    let product = |a: u32, b: u32| match (a, b) {
        (0, _) | (_, 0) => 0,
        (ENDLESS, _) | (_, ENDLESS) => ENDLESS,
        (a, b) => a.saturating_add(b - 1),
    };
    let endless_unless = |is_short: bool| if is_short { 1 } else { ENDLESS };
    match *recurrence {
        Recurrence::State { rate, .. } => longer(of(rate)),
        Recurrence::Time => 2,
        Recurrence::Lift(_) | Recurrence::Truth(_) => 1,
        Recurrence::Neg(a) | Recurrence::Scale(a, _) | Recurrence::Over { a, .. } => of(a),
        Recurrence::Shift(a, _) | Recurrence::From(_, a) => of(a).max(1),
        Recurrence::Add(a, b) | Recurrence::Sub(a, b) | Recurrence::Choose(_, a, b) => of(a).max(of(b)),
        Recurrence::Mul(a, b) => product(of(a), of(b)),
        Recurrence::Square(a) => product(of(a), of(a)),
        Recurrence::Div { a, b, .. } => match (of(a), of(b)) {
            (a, 0 | 1) => a,
            (0, _) => 0,
            _ => ENDLESS,
        },
        Recurrence::Root { a, .. } => endless_unless(of(a) <= 1),
        Recurrence::Derive(a) => match of(a) {
            ENDLESS => ENDLESS,
            a => a.saturating_sub(1),
        },
        Recurrence::Integrate { a, .. } => longer(of(a)),
        Recurrence::Exp { a, .. } | Recurrence::SinCos { a, .. } => endless_unless(of(a) == 0),
        Recurrence::Turn { turned, plain, .. } => of(turned).max(of(plain)),
    }
}

/// For each order, how many arithmetic operations an expansion takes.
pub fn operations(tape: &SeriesTape) -> Vec<u64> {
    let fixed = tape.fixed.iter().filter(|fixed| matches!(fixed, Fixed::Apply(..))).count() as u64;
    let of_order = |order: usize| {
        let of = |instruction: &Instruction| {
            (0..tape.count(instruction, order)).map(|m| cost(tape, instruction, m as u64)).sum::<u64>()
        };
        if order == 0 { fixed } else { fixed + tape.instructions.iter().map(of).sum::<u64>() }
    };
    (0..=ORDER_MAX).map(of_order).collect()
}

/// How many arithmetic operations coefficient m takes.
fn cost(tape: &SeriesTape, instruction: &Instruction, m: u64) -> u64 {
    let length = |row: RowId| u64::from(tape.lengths[row as usize]);
    // Coefficient m of a product: so many products, and sums of them.
    let product = |a: u64, b: u64, m: u64| 2 * (a.min(m + 1) + b.min(m + 1)).saturating_sub(m + 1);
    let own = length(instruction.to);
    match instruction.recurrence {
        Recurrence::Time | Recurrence::Lift(_) | Recurrence::Choose(..) | Recurrence::Turn { .. } => 0,
        Recurrence::State { .. } => m.min(1),
        Recurrence::Shift(..) => 1 - m.min(1),
        Recurrence::Neg(_) | Recurrence::Add(..) | Recurrence::Sub(..) | Recurrence::From(..) => 1,
        Recurrence::Scale(..) | Recurrence::Over { .. } | Recurrence::Derive(_) => 1,
        Recurrence::Integrate { .. } | Recurrence::Truth(_) => 1,
        Recurrence::Mul(a, b) => product(length(a), length(b), m).saturating_sub(1),
        Recurrence::Square(a) => product(length(a), length(a), m).div_ceil(2) + 1,
        Recurrence::Div { .. } | Recurrence::Root { .. } if m == 0 => 2,
        Recurrence::Div { b, .. } => product(length(b) - 1, own, m - 1) + 1,
        Recurrence::Root { .. } => m + 1,
        Recurrence::Exp { .. } if m == 0 => 1,
        Recurrence::Exp { a, .. } => product(length(a), own, m - 1),
        Recurrence::SinCos { .. } if m == 0 => 2,
        Recurrence::SinCos { a, .. } => 2 * product(length(a), own, m - 1),
    }
}

/// Puts first what waits for nothing but what stands before it, and last what nothing before it waits for; between them
/// stands what is done round by round: the range that is returned.
pub fn order(instructions: &mut Vec<Instruction>, n_rows: usize) -> std::ops::Range<usize> {
    let n = instructions.len();
    let mut maker = vec![usize::MAX; n_rows];
    for (k, instruction) in instructions.iter().enumerate() {
        maker[instruction.to as usize] = k;
        if let Some(row) = instruction.recurrence.fills() {
            maker[row as usize] = k;
        }
    }
    let edges: Vec<(usize, usize)> = instructions
        .iter()
        .enumerate()
        .flat_map(|(user, instruction)| {
            instruction.recurrence.operands().into_iter().map(move |row| (row, user))
        })
        .map(|(row, user)| (maker[row as usize], user))
        .collect();
    let backwards: Vec<(usize, usize)> = edges.iter().map(|&(maker, user)| (user, maker)).collect();
    let first = peel(n, &edges, &vec![false; n]);
    let mut taken = vec![false; n];
    first.iter().for_each(|&k| taken[k] = true);
    let last = peel(n, &backwards, &taken);
    last.iter().for_each(|&k| taken[k] = true);
    let middle = (0..n).filter(|&k| !taken[k]);
    let sorted: Vec<Instruction> = first
        .iter()
        .copied()
        .chain(middle)
        .chain(last.iter().rev().copied())
        .map(|k| instructions[k])
        .collect();
    *instructions = sorted;
    first.len()..n - last.len()
}

/// All but `gone` that can be reached from nothing that is on a cycle or behind one, each after those before it.
fn peel(n: usize, edges: &[(usize, usize)], gone: &[bool]) -> Vec<usize> {
    let mut waits = vec![0_usize; n];
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); n];
    for &(before, after) in edges {
        if !gone[before] && !gone[after] {
            waits[after] += 1;
            users[before].push(after);
        }
    }
    let mut ready: Vec<usize> = (0..n).filter(|&k| !gone[k] && waits[k] == 0).collect();
    let mut next = 0;
    while let Some(&k) = ready.get(next) {
        next += 1;
        for &user in &users[k] {
            waits[user] -= 1;
            if waits[user] == 0 {
                ready.push(user);
            }
        }
    }
    ready
}
