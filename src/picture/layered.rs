//! Boxes and arrows laid out in layers, from top to bottom, after K. Sugiyama, S. Tagawa and M. Toda, 1981.
//!
//! Arrows that would close a circle are turned round, and those to the first box, which lies on top; all others lie below those
//! from which an arrow comes. Every arrow goes
//! through a place of its own in each layer between, and its text has one: nothing lies upon anything else.

/// Space between two neighbours of a layer.
const GAP_X: f64 = 26.0;
/// Space between two layers.
const GAP_Y: f64 = 22.0;
/// How often the layers are put in order and moved.
const SWEEPS: usize = 24;

/// A box to be laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    pub width: f64,
    pub height: f64,
}

/// An arrow between two different boxes, with the size of its text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    pub from: usize,
    pub to: usize,
    pub text: Size,
}

/// A point of the plane; y grows downwards.
pub type Point = (f64, f64);

/// Where everything lies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// The upper left corner of each box.
    pub boxes: Vec<Point>,
    /// For each edge the points that it goes through, from the box it leaves to the one it leads to.
    pub routes: Vec<Vec<Point>>,
    /// For each edge the upper left corner of its text.
    pub texts: Vec<Point>,
    /// The size of the whole.
    pub width: f64,
    pub height: f64,
}

/// Lays boxes out; those that stand first come first where there is a choice.
pub fn lay_out(sizes: &[Size], edges: &[Edge]) -> Layout {
    let reversed = reversed(sizes.len(), edges);
    let ranks = ranks(sizes.len(), edges, &reversed);
    let mut web = Web::new(sizes, edges, &reversed, &ranks);
    web.order();
    web.place();
    web.layout(sizes, edges, &reversed)
}

/// Which edges close a circle, as a walk in depth from the first box finds them, or lead to the first box.
fn reversed(n: usize, edges: &[Edge]) -> Vec<bool> {
    let mut reversed = vec![false; edges.len()];
    // 0: not seen, 1: on the way, 2: done
    let mut state = vec![0_u8; n];
    for start in 0..n {
        let mut stack = vec![(start, 0)];
        while let Some((node, next)) = stack.pop() {
            if next == 0 && state[node] == 0 {
                state[node] = 1;
            } else if next == 0 {
                continue;
            }
            let Some(k) = (next..edges.len()).find(|&k| edges[k].from == node) else {
                state[node] = 2;
                continue;
            };
            stack.push((node, k + 1));
            match state[edges[k].to] {
                0 => stack.push((edges[k].to, 0)),
                1 => reversed[k] = true,
                _ => {}
            }
        }
    }
    // the first box stands on top
    for (edge, reversed) in edges.iter().zip(&mut reversed) {
        *reversed |= edge.to == 0;
    }
    reversed
}

/// The layer of each box: even numbers, so that the text of an edge has a layer between.
fn ranks(n: usize, edges: &[Edge], reversed: &[bool]) -> Vec<usize> {
    let mut ranks = vec![0; n];
    for _ in 0..n {
        for (edge, &reversed) in edges.iter().zip(reversed) {
            let (upper, lower) = if reversed { (edge.to, edge.from) } else { (edge.from, edge.to) };
            ranks[lower] = ranks[lower].max(ranks[upper] + 2);
        }
    }
    ranks
}

/// A thing that has a place in a layer: a box, a text, or a point where an edge passes.
struct Node {
    width: f64,
    height: f64,
    rank: usize,
    /// The left end.
    x: f64,
    above: Vec<usize>,
    below: Vec<usize>,
    /// How far from its left end an edge passes.
    port: f64,
}

struct Web {
    nodes: Vec<Node>,
    layers: Vec<Vec<usize>>,
    /// For each edge, its nodes from top to bottom, without the boxes; one of them is its text.
    chains: Vec<Vec<usize>>,
    texts: Vec<usize>,
}

impl Web {
    fn new(sizes: &[Size], edges: &[Edge], reversed: &[bool], ranks: &[usize]) -> Self {
        let node = |size: Size, rank, port| Node {
            width: size.width,
            height: size.height,
            rank,
            x: 0.0,
            above: Vec::new(),
            below: Vec::new(),
            port,
        };
        let boxes = sizes.iter().zip(ranks).map(|(&size, &rank)| node(size, rank, size.width / 2.0));
        let mut web =
            Self { nodes: boxes.collect(), layers: Vec::new(), chains: Vec::new(), texts: Vec::new() };
        for (edge, &reversed) in edges.iter().zip(reversed) {
            let (upper, lower) = if reversed { (edge.to, edge.from) } else { (edge.from, edge.to) };
            // a text stands beside the box that its arrow leaves
            let text_rank = if reversed { ranks[lower] - 1 } else { ranks[upper] + 1 };
            let mut chain = Vec::new();
            for rank in ranks[upper] + 1..ranks[lower] {
                let number = web.nodes.len();
                if rank == text_rank {
                    web.texts.push(number);
                    web.nodes.push(node(edge.text, rank, 0.0));
                } else {
                    web.nodes.push(node(Size { width: 1.0, height: 0.0 }, rank, 0.0));
                }
                chain.push(number);
            }
            let ends = [&[upper], &chain[..], &[lower]].concat();
            for pair in ends.windows(2) {
                web.nodes[pair[0]].below.push(pair[1]);
                web.nodes[pair[1]].above.push(pair[0]);
            }
            web.chains.push(chain);
        }
        let n_layers = web.nodes.iter().map(|node| node.rank + 1).max().unwrap_or(0);
        web.layers = vec![Vec::new(); n_layers];
        for (number, node) in web.nodes.iter().enumerate() {
            web.layers[node.rank].push(number);
        }
        web
    }

    /// Puts each layer in the order of the means of its neighbours, up and down in turn; keeps what crosses least.
    fn order(&mut self) {
        let mut best = (self.crossings(), self.layers.clone());
        for sweep in 0..SWEEPS {
            let downwards = sweep % 2 == 0;
            let n = self.layers.len();
            for k in 0..n {
                let layer = if downwards { k } else { n - 1 - k };
                let places = self.places();
                let mean = |number: usize| {
                    let node = &self.nodes[number];
                    let near = if downwards { &node.above } else { &node.below };
                    let sum: f64 = near.iter().map(|&other| places[other]).sum();
                    if near.is_empty() { places[number] } else { sum / near.len() as f64 }
                };
                let mut sorted: Vec<(f64, usize)> =
                    self.layers[layer].iter().map(|&number| (mean(number), number)).collect();
                sorted.sort_by(|one, other| one.0.total_cmp(&other.0));
                self.layers[layer] = sorted.into_iter().map(|(_, number)| number).collect();
            }
            let crossings = self.crossings();
            if crossings < best.0 {
                best = (crossings, self.layers.clone());
            }
        }
        self.layers = best.1;
    }

    /// Where in its layer each node is, from 0 to 1.
    fn places(&self) -> Vec<f64> {
        let mut places = vec![0.0; self.nodes.len()];
        for layer in &self.layers {
            for (k, &number) in layer.iter().enumerate() {
                places[number] = (k as f64 + 0.5) / layer.len() as f64;
            }
        }
        places
    }

    fn crossings(&self) -> usize {
        let places = self.places();
        let mut count = 0;
        for layer in &self.layers {
            let lines: Vec<(f64, f64)> = layer
                .iter()
                .flat_map(|&upper| self.nodes[upper].below.iter().map(move |&lower| (upper, lower)))
                .map(|(upper, lower)| (places[upper], places[lower]))
                .collect();
            for (k, one) in lines.iter().enumerate() {
                count +=
                    lines[k + 1..].iter().filter(|other| (one.0 - other.0) * (one.1 - other.1) < 0.0).count();
            }
        }
        count
    }

    /// Moves nodes towards the mean of their neighbours, as far as the order and the gaps allow.
    fn place(&mut self) {
        for layer in 0..self.layers.len() {
            let mut x = 0.0;
            for k in 0..self.layers[layer].len() {
                let node = &mut self.nodes[self.layers[layer][k]];
                node.x = x;
                x += node.width + GAP_X;
            }
        }
        for sweep in 0..SWEEPS {
            for k in 0..self.layers.len() {
                let layer = if sweep % 2 == 0 { k } else { self.layers.len() - 1 - k };
                self.settle(layer);
            }
        }
        let left = self.nodes.iter().map(|node| node.x).fold(f64::INFINITY, f64::min);
        for node in &mut self.nodes {
            node.x -= left;
        }
    }

    /// One layer: every node where it would like to be, then pushed apart from both sides, and the mean of the two.
    fn settle(&mut self, layer: usize) {
        let order = self.layers[layer].clone();
        let wish = |number: usize| {
            let node = &self.nodes[number];
            let near = node
                .above
                .iter()
                .chain(&node.below)
                .map(|&other| self.nodes[other].x + self.nodes[other].port);
            let (sum, n) = near.fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
            if n == 0 { node.x } else { sum / f64::from(n) - node.port }
        };
        let wishes: Vec<f64> = order.iter().map(|&number| wish(number)).collect();
        let mut from_left = wishes.clone();
        for k in 1..order.len() {
            from_left[k] = from_left[k].max(from_left[k - 1] + self.nodes[order[k - 1]].width + GAP_X);
        }
        let mut from_right = wishes;
        for k in (0..order.len().saturating_sub(1)).rev() {
            from_right[k] = from_right[k].min(from_right[k + 1] - self.nodes[order[k]].width - GAP_X);
        }
        for (k, &number) in order.iter().enumerate() {
            self.nodes[number].x = (from_left[k] + from_right[k]) / 2.0;
        }
    }

    fn layout(&self, sizes: &[Size], edges: &[Edge], reversed: &[bool]) -> Layout {
        let heights: Vec<f64> = self
            .layers
            .iter()
            .map(|layer| layer.iter().map(|&number| self.nodes[number].height).fold(0.0, f64::max))
            .collect();
        let tops: Vec<f64> = heights
            .iter()
            .scan(0.0, |y, height| {
                let top = *y;
                *y += height + GAP_Y;
                Some(top)
            })
            .collect();
        let top_of = |number: usize| {
            let node = &self.nodes[number];
            tops[node.rank] + (heights[node.rank] - node.height) / 2.0
        };
        let mut routes = Vec::new();
        for (k, edge) in edges.iter().enumerate() {
            let (upper, lower) = if reversed[k] { (edge.to, edge.from) } else { (edge.from, edge.to) };
            let chain = &self.chains[k];
            let (first, last) = (chain[0], chain[chain.len() - 1]);
            let mut route = vec![(
                self.port(upper, &self.nodes[upper].below, first),
                top_of(upper) + sizes[upper].height,
            )];
            for &number in chain {
                let (top, height) = (tops[self.nodes[number].rank], heights[self.nodes[number].rank]);
                route.extend([(self.nodes[number].x, top), (self.nodes[number].x, top + height)]);
            }
            route.push((self.port(lower, &self.nodes[lower].above, last), top_of(lower)));
            if reversed[k] {
                route.reverse();
            }
            routes.push(route);
        }
        Layout {
            boxes: (0..sizes.len()).map(|number| (self.nodes[number].x, top_of(number))).collect(),
            routes,
            texts: self.texts.iter().map(|&number| (self.nodes[number].x, top_of(number))).collect(),
            width: self.nodes.iter().map(|node| node.x + node.width).fold(0.0, f64::max),
            height: tops.last().zip(heights.last()).map_or(0.0, |(top, height)| top + height),
        }
    }

    /// Where on its side a box is left: as many places as edges, in the order of where they go.
    fn port(&self, number: usize, neighbours: &[usize], neighbour: usize) -> f64 {
        let mut order = neighbours.to_vec();
        order.sort_by(|&one, &other| self.nodes[one].x.total_cmp(&self.nodes[other].x));
        let k = order.iter().position(|&other| other == neighbour).unwrap_or(0);
        let node = &self.nodes[number];
        node.x + node.width * (k as f64 + 1.0) / (order.len() as f64 + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Size = Size { width: 80.0, height: 30.0 };
    const TEXT: Size = Size { width: 60.0, height: 20.0 };

    fn edge(from: usize, to: usize) -> Edge {
        Edge { from, to, text: TEXT }
    }

    fn overlap((x, y): Point, size: Size, (u, v): Point, other: Size) -> bool {
        x < u + other.width && u < x + size.width && y < v + other.height && v < y + size.height
    }

    #[test]
    fn nothing_lies_upon_anything_else() {
        let complete =
            (0..5).flat_map(|from| (0..5).filter(move |&to| to != from).map(move |to| edge(from, to)));
        let chain = (0..4).map(|k| edge(k, k + 1));
        let none: Vec<Edge> = Vec::new();
        for edges in
            [complete.collect::<Vec<_>>(), chain.collect(), none, vec![edge(0, 1), edge(1, 0), edge(0, 1)]]
        {
            let layout = lay_out(&[BOX; 5], &edges);
            let boxes = layout.boxes.iter().map(|&place| (place, BOX));
            let things: Vec<(Point, Size)> =
                boxes.chain(layout.texts.iter().map(|&place| (place, TEXT))).collect();
            assert_eq!(things.len(), 5 + edges.len());
            for (k, one) in things.iter().enumerate() {
                for other in &things[k + 1..] {
                    assert!(!overlap(one.0, one.1, other.0, other.1), "{one:?} {other:?}");
                }
                let (x, y) = one.0;
                assert!(
                    x >= 0.0
                        && y >= 0.0
                        && x + one.1.width <= layout.width
                        && y + one.1.height <= layout.height
                );
            }
        }
    }

    #[test]
    fn an_arrow_begins_and_ends_at_its_boxes() {
        let edges = [edge(0, 1), edge(1, 2), edge(2, 0), edge(0, 2)];
        let layout = lay_out(&[BOX; 3], &edges);
        for (edge, route) in edges.iter().zip(&layout.routes) {
            for (number, end) in [(edge.from, route[0]), (edge.to, route[route.len() - 1])] {
                let (x, y) = layout.boxes[number];
                assert!(end.0 > x && end.0 < x + BOX.width, "{edge:?}");
                assert!(end.1 == y || end.1 == y + BOX.height, "{edge:?}");
            }
        }
    }
}
