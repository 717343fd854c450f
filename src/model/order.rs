//! The order of things that need each other, found without recursion.

/// All nodes, each after those that it needs (`needs[k]`), otherwise in their own order; an edge that would close a
/// circle is ignored.
pub(super) fn in_order_of_need(needs: &[impl AsRef<[usize]>]) -> Vec<usize> {
    walk(needs).0
}

/// A circle of nodes each of which needs the next, the last one the first; the one that is met first.
pub(super) fn find_circle(needs: &[impl AsRef<[usize]>]) -> Option<Vec<usize>> {
    walk(needs).1
}

/// Depth-first: the order in which nodes are finished, and the first circle.
fn walk(needs: &[impl AsRef<[usize]>]) -> (Vec<usize>, Option<Vec<usize>>) {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; needs.len()];
    let mut order = Vec::with_capacity(needs.len());
    let mut circle = None;
    let mut path: Vec<(usize, usize)> = Vec::new();
    for root in 0..needs.len() {
        if marks[root] == Mark::New {
            marks[root] = Mark::Open;
            path.push((root, 0));
        }
        while let Some((node, next)) = path.last_mut() {
            let Some(&needed) = needs[*node].as_ref().get(*next) else {
                marks[*node] = Mark::Done;
                order.push(*node);
                path.pop();
                continue;
            };
            *next += 1;
            match marks[needed] {
                Mark::New => {
                    marks[needed] = Mark::Open;
                    path.push((needed, 0));
                }
                Mark::Open if circle.is_none() => {
                    let nodes = path.iter().map(|(node, _)| *node);
                    circle = Some(nodes.skip_while(|&node| node != needed).collect());
                }
                Mark::Open | Mark::Done => {}
            }
        }
    }
    (order, circle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_needed_comes_first() {
        assert_eq!(in_order_of_need(&[vec![2], vec![], vec![1]]), [1, 2, 0]);
        assert_eq!(find_circle(&[vec![2], vec![], vec![1]]), None);
    }

    #[test]
    fn a_circle_is_found_without_what_leads_to_it() {
        assert_eq!(find_circle(&[vec![1], vec![2], vec![1]]), Some(vec![1, 2]));
        assert_eq!(find_circle(&[vec![0]]), Some(vec![0]));
    }

    #[test]
    fn a_long_chain_is_no_problem() {
        let needs = (0..100_000).map(|k| if k < 99_999 { vec![k + 1] } else { vec![] }).collect::<Vec<_>>();
        assert_eq!(in_order_of_need(&needs)[0], 99_999);
    }
}
