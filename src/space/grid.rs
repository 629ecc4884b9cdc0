//! The background grid: equal square cells, numbered row by row from the lower left.

/// Sides of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
    Base,
    Top,
}

impl Side {
    pub const ALL: [Side; 4] = [Side::Left, Side::Right, Side::Base, Side::Top];

    /// Axis across the side.
    pub fn axis(self) -> usize {
        match self {
            Side::Left | Side::Right => 0,
            Side::Base | Side::Top => 1,
        }
    }

    /// Component of the inward normal on that axis.
    pub fn inward(self) -> f64 {
        match self {
            Side::Left | Side::Base => 1.0,
            Side::Right | Side::Top => -1.0,
        }
    }

    /// Name as the case file has it.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Base => "base",
            Side::Top => "top",
        }
    }
}

/// Geometry of the grid. It stores nothing per cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Lower left corner (m).
    pub origin: [f64; 2],
    /// Cell size h (m).
    pub h: f64,
    /// Cells along x and y.
    pub cells: [u32; 2],
}

impl Grid {
    /// Nodes along x.
    #[inline(always)]
    pub fn row(&self) -> u32 {
        self.cells[0] + 1
    }

    /// Nodes in all.
    pub fn nodes(&self) -> usize {
        self.row() as usize * (self.cells[1] as usize + 1)
    }

    /// Upper right corner (m).
    pub fn far(&self) -> [f64; 2] {
        [self.origin[0] + self.h * f64::from(self.cells[0]), self.origin[1] + self.h * f64::from(self.cells[1])]
    }

    /// Whether a position lies strictly inside. Not a number is not inside.
    #[inline(always)]
    pub fn contains(&self, x: [f64; 2]) -> bool {
        let far = self.far();
        (x[0] > self.origin[0]) & (x[0] < far[0]) & (x[1] > self.origin[1]) & (x[1] < far[1])
    }

    /// The grid whose cells are the squares around the nodes of this one: the points of a cell of it have
    /// the same nearest node.
    pub fn around_nodes(&self) -> Grid {
        Grid { origin: self.origin.map(|o| o - 0.5 * self.h), cells: self.cells.map(|n| n + 1), ..*self }
    }

    /// Column and row of a node.
    pub fn node_place(&self, node: u32) -> [u32; 2] {
        [node % self.row(), node / self.row()]
    }

    /// Position of a node (m).
    pub fn node_position(&self, node: u32) -> [f64; 2] {
        let p = self.node_place(node);
        [self.origin[0] + self.h * f64::from(p[0]), self.origin[1] + self.h * f64::from(p[1])]
    }

    /// Whether the node at `place` lies on `side`.
    pub fn on_side(&self, place: [u32; 2], side: Side) -> bool {
        match side {
            Side::Left => place[0] == 0,
            Side::Right => place[0] == self.cells[0],
            Side::Base => place[1] == 0,
            Side::Top => place[1] == self.cells[1],
        }
    }
}
