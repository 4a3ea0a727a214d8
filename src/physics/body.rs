use super::{Material, Rect, Vector};

/// The number of a body: how many bodies were created before it in the run, walls included.
///
/// Never used twice, so bodies sorted by it stand in creation order.
pub type BodyId = u32;

/// A box: a rectangle with a mass, a velocity and a force.
///
/// What changes at every step lies in one cache line.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Body {
    /// Where it is, m.
    pub rect: Rect,
    /// m/s.
    pub velocity: Vector,
    /// kg; infinity for what is never pushed.
    pub mass: f64,
    /// 1/mass, kg⁻¹; 0 for an infinite mass.
    pub inverse_mass: f64,
    /// The sum of the forces since the last step, N (the handout's accumulator).
    pub force: Vector,
    /// The force it carries at all times, N.
    pub constant_force: Vector,
    /// Its number in creation order.
    pub id: BodyId,
    /// What it is made of, for the restitution table.
    pub material: Material,
    /// Unique among the bodies alive; what errors and pictures call it.
    pub name: String,
}

impl Body {
    /// Whether it is never pushed: it keeps its velocity for life.
    pub const fn is_infinite(&self) -> bool {
        self.mass == f64::INFINITY
    }

    /// Whether its position or velocity can ever change: an infinite mass at rest stays there.
    pub fn can_move(&self) -> bool {
        !self.is_infinite() || self.velocity != Vector::ZERO
    }
}
