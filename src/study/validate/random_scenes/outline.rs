//! Outlines of the soil: convex or not, thin, with corners beside grid lines.

use std::f64::consts::TAU;

use super::draw::Draw;

/// Corners in order.
pub(super) type Polygon = Vec<[f64; 2]>;

/// Shapes; a shape that stands more than once is more likely.
const SHAPES: [fn(&mut Draw, Room) -> Polygon; 12] =
    [block, block, block, slope, slope, star, star, notch, notch, beside_lines, beside_lines, sliver];

/// Where an outline may lie (m).
#[derive(Clone, Copy)]
pub(super) struct Room {
    pub low: [f64; 2],
    pub high: [f64; 2],
    /// Cell (m).
    pub h: f64,
}

impl Room {
    /// A place by its shares of width and height.
    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let along = |axis: usize, s: f64| self.low[axis] + s * (self.high[axis] - self.low[axis]);
        [along(0, x), along(1, y)]
    }
}

/// One outline in each of `count` strips of the room.
pub(super) fn outlines(draw: &mut Draw, room: Room, count: u32) -> Vec<Polygon> {
    let mut left = room.low[0];
    let mut found = Vec::new();
    for k in 0..count {
        let share = draw.between(0.5, 1.5) / f64::from(count - k);
        let right = if k + 1 == count { room.high[0] } else { left + share.min(0.9) * (room.high[0] - left) };
        let strip = Room { low: [left, room.low[1]], high: [right, room.high[1]], ..room };
        let shape = draw.pick(&SHAPES);
        found.push(shape(draw, strip));
        left = right;
    }
    found
}

fn block(draw: &mut Draw, room: Room) -> Polygon {
    let (right, top) = (draw.between(0.4, 1.0), draw.between(0.2, 1.0));
    vec![room.at(0.0, 0.0), room.at(right, 0.0), room.at(right, top), room.at(0.0, top)]
}

fn slope(draw: &mut Draw, room: Room) -> Polygon {
    let (crest, top) = (draw.between(0.05, 0.9), draw.between(0.3, 1.0));
    vec![room.at(0.0, 0.0), room.at(1.0, 0.0), room.at(crest, top), room.at(0.0, top)]
}

/// Corners at rising angles about the middle: simple, and mostly not convex.
fn star(draw: &mut Draw, room: Room) -> Polygon {
    let corners = draw.whole(3, 12);
    let corner = |k: u32| {
        let angle = TAU * (f64::from(k) + draw.between(-0.3, 0.3)) / f64::from(corners);
        let radius = 0.5 * draw.between(0.2, 1.0);
        room.at(0.5 + radius * angle.cos(), 0.5 + radius * angle.sin())
    };
    (0..corners).map(corner).collect()
}

/// A block with a notch in its top.
fn notch(draw: &mut Draw, room: Room) -> Polygon {
    let (from, to) = (draw.between(0.1, 0.5), draw.between(0.55, 0.9));
    let (top, ground) = (draw.between(0.4, 1.0), draw.between(0.05, 0.35));
    let corners =
        [(0.0, 0.0), (1.0, 0.0), (1.0, top), (to, top), (to, ground), (from, ground), (from, top), (0.0, top)];
    corners.map(|(x, y)| room.at(x, y)).to_vec()
}

/// Much thinner than a cell.
fn sliver(draw: &mut Draw, room: Room) -> Polygon {
    let thin = room.h * draw.spread(1e-3, 0.5);
    let end = draw.pick(&[0.0, 1.0]);
    let [x, y] = room.low;
    if draw.chance(0.5) {
        vec![[x, y], [room.high[0], y], [room.high[0], y + end * thin], [x, y + thin]]
            .into_iter()
            .enumerate()
            .filter(|(k, _)| *k != 2 || end > 0.0)
            .map(|(_, corner)| corner)
            .collect()
    } else {
        vec![[x, y], [(x + thin).min(room.high[0]), y], [x, room.high[1]]]
    }
}

/// A block whose sides miss grid lines by next to nothing.
fn beside_lines(draw: &mut Draw, room: Room) -> Polygon {
    let mut beside = |axis: usize, share: f64| {
        let place = room.low[axis] + share * (room.high[axis] - room.low[axis]);
        let off = draw.pick(&[-1.0, 1.0]) * room.h * draw.spread(1e-12, 1e-1);
        let line = (place / room.h).round() * room.h + off;
        line.clamp(room.low[axis], room.high[axis])
    };
    let (left, right, base, top) = (beside(0, 0.0), beside(0, 0.9), beside(1, 0.0), beside(1, 0.7));
    vec![[left, base], [right, base], [right, top], [left, top]]
}
