//! Rows of the system summed up, coefficient by coefficient, from many stars.

use crate::system::{Roles, SplitRow};
use nmt_geom::NodeId;

/// Numbers of nodes that share a word of bits.
const BITS: u32 = u64::BITS;

/// Words of bits in [`Marks`].
const MARKED: usize = 4;

/// The nodes of a star as bits: nodes near each other have numbers near each other, so that a usual star lies in few words.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Marks {
    halves: [[u32; 2]; MARKED], // of the bits, 0 beyond the last word; in halves to be aligned as the rest is
    first: u32,                 // word
    further: [u16; MARKED],     // words by their distance from it; 0 beyond the last
}

impl Marks {
    /// Those of nodes, ascending; none where they lie in more words, or in words far apart.
    #[inline]
    pub fn of(nodes: &[NodeId]) -> Self {
        Self::of_near(nodes).unwrap_or_default()
    }

    #[inline(always)]
    fn of_near(nodes: &[NodeId]) -> Option<Self> {
        let mut marks = Self { first: nodes.first()?.0 / BITS, ..Self::default() };
        let mut k = 0;
        for node in nodes {
            let further = u16::try_from(node.0 / BITS - marks.first).ok()?;
            k += usize::from(further != marks.further[k]);
            *marks.further.get_mut(k)? = further;
            marks.halves[k][(node.0 % BITS / 32) as usize] |= 1 << (node.0 % 32);
        }
        Some(marks)
    }

    /// Each word that has some, by its number, with its bits.
    #[inline(always)]
    fn words(&self) -> impl Iterator<Item = (u32, u64)> {
        let first = self.first;
        let whole = |[low, high]: [u32; 2]| u64::from(low) | u64::from(high) << 32;
        let words = self.further.iter().zip(&self.halves);
        words.map(move |(further, halves)| (first + u32::from(*further), whole(*halves)))
    }

    /// Whether there are none.
    #[inline(always)]
    pub fn is_none(&self) -> bool {
        self.halves[0] == [0, 0]
    }
}

/// Sums coefficients by node, to be used again for the next row; O(entries).
///
/// Which nodes are touched is a bit each, and those bits lie in few words.
#[derive(Clone, Debug)]
pub(crate) struct RowSum {
    sums: Vec<f64>,  // shape (n_nodes,), zero where untouched
    bits: Vec<u64>,  // of the nodes touched
    words: Vec<u32>, // the first `n_words`: of `bits`, those that are not zero; room for more
    n_words: usize,
}

impl RowSum {
    pub fn new(n_nodes: usize) -> Self {
        let n_words = n_nodes.div_ceil(BITS as usize);
        Self { sums: vec![0.0; n_nodes], bits: vec![0; n_words], words: Vec::new(), n_words: 0 }
    }

    /// Adds `coefficient` times the value of `node`.
    #[inline(always)]
    pub fn add(&mut self, node: NodeId, coefficient: f64) {
        self.make_room();
        mark(&mut self.bits, &mut self.words, &mut self.n_words, (node.0 / BITS, 1 << (node.0 % BITS)));
        self.sums[node.index()] += coefficient;
    }

    /// Adds to the coefficients of several nodes, which have these marks.
    #[inline(always)]
    pub fn add_marked<const N: usize>(&mut self, marks: &Marks, nodes: &[NodeId; N], coefficients: &[f64; N]) {
        self.make_room();
        // What is looked up through `self` would be read again after every sum.
        let Self { sums, bits, words, n_words } = self;
        let (sums, bits, words) = (sums.as_mut_slice(), bits.as_mut_slice(), words.as_mut_slice());
        let mut n = *n_words;
        for marked in marks.words() {
            mark(bits, words, &mut n, marked);
        }
        *n_words = n;
        for (node, coefficient) in nodes.iter().zip(coefficients) {
            sums[node.index()] += coefficient;
        }
    }

    /// Adds to the coefficient of a node that is touched already.
    #[inline(always)]
    pub fn add_again(&mut self, node: NodeId, coefficient: f64) {
        debug_assert!(self.bits[(node.0 / BITS) as usize] >> (node.0 % BITS) & 1 == 1, "node {} is new", node.0);
        self.sums[node.index()] += coefficient;
    }

    /// Room for the words of one star.
    #[inline(always)]
    fn make_room(&mut self) {
        if self.words.len() < self.n_words + MARKED {
            self.words.resize(2 * (self.n_words + MARKED), 0);
        }
    }

    /// The words touched so far, in no order.
    #[inline(always)]
    fn words(&self) -> &[u32] {
        &self.words[..self.n_words]
    }

    /// The coefficient of a node so far.
    #[inline(always)]
    pub fn of(&self, node: NodeId) -> f64 {
        self.sums[node.index()]
    }

    /// Number of nodes touched so far.
    #[inline(always)]
    pub fn n_nodes(&self) -> usize {
        self.words().iter().map(|&word| self.bits[word as usize].count_ones() as usize).sum()
    }

    /// No node touched so far comes before this one.
    #[inline(always)]
    pub fn least(&self) -> NodeId {
        NodeId(self.words().iter().min().map_or(0, |word| word * BITS))
    }

    /// The row so far, by role; begins the next one.
    pub fn take(&mut self, roles: &Roles) -> SplitRow {
        let mut row = SplitRow::default();
        self.drain(|node, sum| row.add(roles.of(node), sum));
        row
    }

    /// Hands over (node, sum) by ascending number; begins the next row.
    #[inline(always)]
    pub fn drain(&mut self, mut to: impl FnMut(NodeId, f64)) {
        let (sums, all_bits) = (self.sums.as_mut_slice(), self.bits.as_mut_slice());
        let words = &mut self.words[..std::mem::take(&mut self.n_words)];
        words.sort_unstable();
        for &word in words.iter() {
            let mut bits = std::mem::take(&mut all_bits[word as usize]);
            while bits != 0 {
                let node = NodeId(word * BITS + bits.trailing_zeros());
                bits &= bits - 1;
                to(node, std::mem::take(&mut sums[node.index()]));
            }
        }
    }
}

/// Marks nodes of one word as touched.
#[inline(always)]
fn mark(bits: &mut [u64], words: &mut [u32], n_words: &mut usize, (word, marked): (u32, u64)) {
    let bits = &mut bits[word as usize];
    // Which are new cannot be foreseen: counted, not branched on.
    words[*n_words] = word;
    *n_words += usize::from(*bits == 0);
    *bits |= marked;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// Nine nodes, ascending, from somewhere on.
    fn star() -> impl Strategy<Value = [NodeId; 9]> {
        (0..500u32, prop::array::uniform8(1..60u32)).prop_map(|(first, gaps)| {
            let mut nodes = [NodeId(first); 9];
            (0..8).for_each(|k| nodes[k + 1] = NodeId(nodes[k].0 + gaps[k]));
            nodes
        })
    }

    proptest! {
        #[test]
        fn stars_with_marks_sum_up_as_node_by_node(
            stars in prop::collection::vec((star(), prop::array::uniform9(-1.0..1.0f64)), 0..12),
        ) {
            let mut sum = RowSum::new(1000);
            for _ in 0..2 {
                let mut expected = BTreeMap::new();
                for (nodes, coefficients) in &stars {
                    let marks = Marks::of(nodes);
                    if marks.is_none() {
                        nodes.iter().zip(coefficients).for_each(|(node, c)| sum.add(*node, *c));
                    } else {
                        sum.add_marked(&marks, nodes, coefficients);
                    }
                    sum.add_again(nodes[4], 0.5);
                    nodes.iter().zip(coefficients).for_each(|(node, c)| *expected.entry(*node).or_insert(0.0) += c);
                    *expected.entry(nodes[4]).or_insert(0.0) += 0.5;
                }
                prop_assert_eq!(sum.n_nodes(), expected.len());
                prop_assert!(expected.keys().next().is_none_or(|first| sum.least() <= *first));
                let mut found = Vec::new();
                sum.drain(|node, total| found.push((node, total)));
                prop_assert_eq!(found, expected.into_iter().collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn stars_that_spread_have_no_marks() {
        let is_marked =
            |numbers: &[u32]| !Marks::of(&numbers.iter().copied().map(NodeId).collect::<Vec<_>>()).is_none();
        assert!(is_marked(&[0, 1, 63, 64, 200, 255]), "four words");
        assert!(!is_marked(&[0, 64, 128, 192, 256]), "five words");
        assert!(is_marked(&[5, 64 * 65_535]), "as far as a distance reaches");
        assert!(!is_marked(&[5, 64 * 65_536]), "farther");
        assert!(!is_marked(&[]));
    }
}
