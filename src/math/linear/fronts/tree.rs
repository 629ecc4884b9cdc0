//! Which nodes are eliminated together, and in which order.

use crate::math::{
    ordering::{elimination_tree, inverted},
    sparse::Pattern,
};

/// No supernode.
pub(super) const NONE: u32 = u32::MAX;

/// Cost of a front beside its arithmetic, in units of a product and sum: finding its way, and adding up what its
/// children leave, by the front and by the value. From measurement at 1,800 and 129,600 cells.
const FRONT: f64 = 8e3;
const VALUE: f64 = 2.0;

/// Nodes that are eliminated together, and the nodes that are coupled with them and come later.
#[derive(Clone, Debug, Default)]
pub(super) struct Supernode {
    /// Places in the order of elimination.
    pub columns: Vec<u32>,
    pub rows: Vec<u32>,
    pub children: Vec<u32>,
}

impl Supernode {
    /// Price of eliminating `columns` nodes with `rows` nodes below: what the padded blocks of eight take.
    fn price(columns: usize, rows: usize) -> f64 {
        let [k, r] = [columns, rows].map(|nodes| (2 * nodes).next_multiple_of(8) as f64);
        FRONT + k * k * k / 6.0 + k * k * r / 2.0 + k * r * r / 2.0 + VALUE * r * r
    }

    /// Whether the column at `place`, with so many rows below, has the structure of the last one of this supernode.
    fn goes_on(&self, place: u32, rows: usize) -> bool {
        self.columns.last().is_some_and(|&last| last + 1 == place) && self.rows.len() == rows + 1
    }
}

/// The supernodes of an order of elimination (nodes by place), children before parents, columns and rows by place in
/// the order that is returned with them: one in which the columns of a supernode stand together.
pub(super) fn supernodes(pattern: &Pattern, order: &[u32]) -> (Vec<Supernode>, Vec<u32>) {
    let mut tree = fundamental(pattern, order);
    merge(&mut tree);
    arrange(tree, order)
}

/// Supernodes of columns that follow each other and have the same rows below. The structure of a column is that of the
/// matrix and of its children in the elimination tree, less itself.
fn fundamental(pattern: &Pattern, order: &[u32]) -> Vec<Supernode> {
    let (parents, inverse) = (elimination_tree(pattern, order), inverted(order));
    let mut supernodes: Vec<Supernode> = Vec::new();
    // supernodes that wait for a parent's column, as lists
    let (mut first, mut next) = (vec![NONE; order.len()], Vec::new());
    let (mut seen, mut rows, mut children) = (vec![NONE; order.len()], Vec::new(), Vec::new());
    for (place, &node) in (0u32..).zip(order) {
        rows.clear();
        let mut note = |row: u32| {
            if row > place && std::mem::replace(&mut seen[row as usize], place) != place {
                rows.push(row);
            }
        };
        pattern.neighbours(node as usize).for_each(|i| note(inverse[i]));
        children.clear();
        let mut child = first[place as usize];
        while child != NONE {
            children.push(child);
            supernodes[child as usize].rows.iter().for_each(|&row| note(row));
            child = next[child as usize];
        }
        let own = match children[..] {
            [only] if supernodes[only as usize].goes_on(place, rows.len()) => only,
            _ => {
                supernodes.push(Supernode { children: children.clone(), ..Supernode::default() });
                next.push(NONE);
                supernodes.len() as u32 - 1
            }
        };
        let supernode = &mut supernodes[own as usize];
        supernode.columns.push(place);
        std::mem::swap(&mut supernode.rows, &mut rows);
        let parent = parents[place as usize];
        if parent != NONE {
            next[own as usize] = std::mem::replace(&mut first[parent as usize], own);
        }
    }
    supernodes
}

/// Makes one supernode of parent and child where that is cheaper, though zeros are then stored. Merged children are
/// left without columns.
fn merge(tree: &mut [Supernode]) {
    for s in 0..tree.len() {
        let mut kept = Vec::new();
        let mut waiting = std::mem::take(&mut tree[s].children);
        waiting.sort_unstable_by(|a, b| b.cmp(a));
        while let Some(c) = waiting.pop() {
            let (child, own) = (&tree[c as usize], &tree[s]);
            let [k, r] = [own.columns.len(), own.rows.len()];
            let apart = Supernode::price(k, r) + Supernode::price(child.columns.len(), child.rows.len());
            if Supernode::price(k + child.columns.len(), r) > apart {
                kept.push(c);
                continue;
            }
            let child = std::mem::take(&mut tree[c as usize]);
            kept.extend(child.children);
            let mut columns = child.columns;
            columns.append(&mut tree[s].columns);
            tree[s].columns = columns;
        }
        tree[s].children = kept;
    }
}

/// Renumbers places so that the columns of each supernode stand together, children first; rows ascend.
fn arrange(tree: Vec<Supernode>, order: &[u32]) -> (Vec<Supernode>, Vec<u32>) {
    let post = postorder(&tree);
    let old: Vec<u32> = post.iter().flat_map(|&s| tree[s as usize].columns.iter().copied()).collect();
    let (place, number) = (inverted(&old), inverted_some(&post, tree.len()));
    let mut tree = tree;
    let arranged = post.iter().map(|&s| {
        let mut s = std::mem::take(&mut tree[s as usize]);
        s.columns.iter_mut().for_each(|c| *c = place[*c as usize]);
        s.rows.iter_mut().for_each(|r| *r = place[*r as usize]);
        s.rows.sort_unstable();
        s.children.iter_mut().for_each(|c| *c = number[*c as usize]);
        s
    });
    (arranged.collect(), old.iter().map(|&p| order[p as usize]).collect())
}

/// The supernodes that have columns, children before parents.
fn postorder(tree: &[Supernode]) -> Vec<u32> {
    let mut child = vec![false; tree.len()];
    tree.iter().flat_map(|s| &s.children).for_each(|&c| child[c as usize] = true);
    let roots = (0..tree.len()).filter(|&s| !child[s] && !tree[s].columns.is_empty());
    let mut sorted = Vec::new();
    for root in roots {
        let mut path = vec![(root, 0)];
        while let Some((s, done)) = path.last_mut() {
            if let Some(&next) = tree[*s].children.get(*done) {
                *done += 1;
                path.push((next as usize, 0));
            } else {
                sorted.push(*s as u32);
                path.pop();
            }
        }
    }
    sorted
}

/// Place of each of `n` numbers in a list; `NONE` for those that are not in it.
fn inverted_some(list: &[u32], n: usize) -> Vec<u32> {
    let mut inverse = vec![NONE; n];
    for (k, &s) in (0..).zip(list) {
        inverse[s as usize] = k;
    }
    inverse
}
