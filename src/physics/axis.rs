use std::ops::{Index, IndexMut};

/// A coordinate axis; an index into pairs `[x, y]`. Worlds are two-dimensional, so there will be no third.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Axis {
    /// Horizontal, to the right.
    X,
    /// Vertical, downwards.
    Y,
}

impl Axis {
    /// Both axes, x first.
    pub const BOTH: [Axis; 2] = [Axis::X, Axis::Y];

    /// The perpendicular axis.
    #[inline]
    pub const fn other(self) -> Axis {
        match self {
            Axis::X => Axis::Y,
            Axis::Y => Axis::X,
        }
    }
}

/// A direction along an axis; an index into pairs `[low, high]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Side {
    /// Towards lower coordinates: left or up.
    Low,
    /// Towards higher coordinates: right or down.
    High,
}

impl Side {
    /// Both sides, the low one first.
    pub const BOTH: [Side; 2] = [Side::Low, Side::High];

    /// The reverse direction.
    #[inline]
    pub const fn opposite(self) -> Side {
        match self {
            Side::Low => Side::High,
            Side::High => Side::Low,
        }
    }

    /// −1 for [`Side::Low`], 1 for [`Side::High`].
    #[inline]
    pub const fn sign(self) -> f64 {
        match self {
            Side::Low => -1.0,
            Side::High => 1.0,
        }
    }
}

impl<T> Index<Axis> for [T; 2] {
    type Output = T;

    #[inline]
    fn index(&self, axis: Axis) -> &T {
        &self[axis as usize]
    }
}

impl<T> IndexMut<Axis> for [T; 2] {
    #[inline]
    fn index_mut(&mut self, axis: Axis) -> &mut T {
        &mut self[axis as usize]
    }
}

impl<T> Index<Side> for [T; 2] {
    type Output = T;

    #[inline]
    fn index(&self, side: Side) -> &T {
        &self[side as usize]
    }
}

impl<T> IndexMut<Side> for [T; 2] {
    #[inline]
    fn index_mut(&mut self, side: Side) -> &mut T {
        &mut self[side as usize]
    }
}
