/// The material of a body: an index into the [`Restitution`] table.
///
/// All materials that occur in no pair share the index 0, which has the default restitution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Material(u32);

/// The coefficient of restitution e of each pair of materials.
///
/// An impact with e = 1 conserves kinetic energy; with e = 0 the bodies have the same velocity afterwards.
/// (Values of the handout: steel on steel 19/20, wood on wood 1/2.)
#[doc(alias("coefficient of restitution", "restitution coefficient", "bounciness", "elasticity"))]
#[derive(Clone, Debug, PartialEq)]
pub struct Restitution {
    default: f64,
    /// Sorted names; the index of a material is its position plus one.
    names: Vec<String>,
    /// Square matrix, row by row, with one row more than there are names: row 0 is "any other material".
    table: Vec<f64>,
}

/// A pair of materials and its coefficient of restitution. It will get no further fields, so it can be written as a
/// literal.
#[derive(Clone, Debug, PartialEq)]
pub struct RestitutionPair {
    /// The two materials, in either order.
    pub materials: [String; 2],
    /// Coefficient of restitution, 0 ≤ e ≤ 1.
    pub restitution: f64,
}

impl Restitution {
    /// Creates a table in which every pair not listed has e = `default`. If a pair is listed twice, the
    /// later entry applies.
    ///
    /// # Panics
    /// Panics if a coefficient is not between 0 and 1.
    pub fn new(default: f64, pairs: &[RestitutionPair]) -> Restitution {
        let mut coefficients = pairs.iter().map(|pair| pair.restitution).chain([default]);
        assert!(coefficients.all(|e| (0.0..=1.0).contains(&e)), "a coefficient of restitution is not between 0 and 1");
        let mut names: Vec<String> = pairs.iter().flat_map(|pair| pair.materials.clone()).collect();
        names.sort();
        names.dedup();
        let width = names.len() + 1;
        let table = vec![default; width * width];
        let mut restitution = Restitution { default, names, table };
        for pair in pairs {
            let [a, b] = pair.materials.each_ref().map(|name| restitution.material(name).0 as usize);
            restitution.table[a * width + b] = pair.restitution;
            restitution.table[b * width + a] = pair.restitution;
        }
        restitution
    }

    /// The coefficient of restitution of pairs that are not listed.
    pub fn default_restitution(&self) -> f64 {
        self.default
    }

    /// The materials that occur in a pair, sorted.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// All pairs of the materials in [`Restitution::names`], sorted. [`Restitution::new`] creates an equal table from
    /// them and the default.
    pub fn pairs(&self) -> Vec<RestitutionPair> {
        let mut pairs = Vec::new();
        for (index, a) in self.names.iter().enumerate() {
            for b in &self.names[index..] {
                let restitution = self.between(self.material(a), self.material(b));
                pairs.push(RestitutionPair { materials: [a.clone(), b.clone()], restitution });
            }
        }
        pairs
    }

    /// The material with a name. The name need not occur in a pair.
    pub fn material(&self, name: &str) -> Material {
        match self.names.binary_search_by(|entry| entry.as_str().cmp(name)) {
            Ok(index) => Material(index as u32 + 1),
            Err(_) => Material(0),
        }
    }

    /// The coefficient of restitution of two materials, in either order.
    ///
    /// # Panics
    /// May panic if a material is of another table.
    pub fn between(&self, a: Material, b: Material) -> f64 {
        self.table[self.index(a, b)]
    }

    /// The index in [`Restitution::table`] of two materials.
    #[inline]
    pub(super) fn index(&self, a: Material, b: Material) -> usize {
        a.0 as usize * (self.names.len() + 1) + b.0 as usize
    }

    /// The coefficients of restitution of all pairs of materials.
    pub(super) fn table(&self) -> &[f64] {
        &self.table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: &str, b: &str, restitution: f64) -> RestitutionPair {
        RestitutionPair { materials: [a.into(), b.into()], restitution }
    }

    #[test]
    fn a_pair_applies_in_both_orders_and_all_others_have_the_default() {
        let pairs = [pair("steel", "steel", 19.0 / 20.0), pair("wood", "steel", 0.7), pair("wood", "wood", 0.5)];
        let table = Restitution::new(1.0, &pairs);
        let [steel, wood, other] = ["steel", "wood", "cork"].map(|name| table.material(name));
        assert_eq!(table.between(steel, steel), 0.95);
        assert_eq!(table.between(wood, wood), 0.5);
        assert_eq!((table.between(steel, wood), table.between(wood, steel)), (0.7, 0.7));
        assert_eq!((table.between(other, steel), table.between(other, other)), (1.0, 1.0));
        assert_eq!(Restitution::new(1.0, &table.pairs()), table);
    }
}
