/// A material as a body carries it: an index into the restitution table.
///
/// Materials that no pair names share the index 0, whose restitution is the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Material(u32);

/// The coefficient of restitution e of every pair of materials.
///
/// e = 1 keeps the kinetic energy of an impact, e = 0 absorbs all it can (the handout's
/// steel on steel is 19/20, wood on wood 1/2).
#[derive(Clone, Debug, PartialEq)]
pub struct Restitution {
    default: f64,
    /// Sorted names; a name's place plus one is its index.
    names: Vec<String>,
    /// Square, row by row, one row more than there are names: row 0 is "any other material".
    table: Vec<f64>,
}

/// What [`Restitution::new`] is built from: one pair of materials and its e.
#[derive(Clone, Debug, PartialEq)]
pub struct RestitutionPair {
    /// The two materials; their order means nothing.
    pub materials: [String; 2],
    /// Coefficient of restitution, 0 ≤ e ≤ 1.
    pub restitution: f64,
}

impl Restitution {
    /// The table with e = `default` for every pair not listed.
    ///
    /// Of a pair that is listed twice the later one holds.
    pub fn new(default: f64, pairs: &[RestitutionPair]) -> Restitution {
        let mut names: Vec<String> = pairs.iter().flat_map(|pair| pair.materials.clone()).collect();
        names.sort();
        names.dedup();
        let width = names.len() + 1;
        let table = vec![default; width * width];
        let mut restitution = Restitution { default, names, table };
        for pair in pairs {
            let [a, b] = [0, 1].map(|side| restitution.material(&pair.materials[side]).0 as usize);
            restitution.table[a * width + b] = pair.restitution;
            restitution.table[b * width + a] = pair.restitution;
        }
        restitution
    }

    /// The e of pairs that are not listed.
    pub fn default_restitution(&self) -> f64 {
        self.default
    }

    /// The materials that some pair names, sorted.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Every pair of named materials and its e, sorted: [`Restitution::new`] makes an equal
    /// table of them.
    pub fn pairs(&self) -> Vec<RestitutionPair> {
        let mut pairs = Vec::new();
        for (place, a) in self.names.iter().enumerate() {
            for b in &self.names[place..] {
                let restitution = self.between(self.material(a), self.material(b));
                pairs.push(RestitutionPair { materials: [a.clone(), b.clone()], restitution });
            }
        }
        pairs
    }

    /// The material of that name; one that no pair names is all right.
    pub fn material(&self, name: &str) -> Material {
        match self.names.binary_search_by(|known| known.as_str().cmp(name)) {
            Ok(place) => Material(place as u32 + 1),
            Err(_) => Material(0),
        }
    }

    /// The coefficient of restitution between two materials, order indifferent.
    pub fn between(&self, a: Material, b: Material) -> f64 {
        self.table[a.0 as usize * (self.names.len() + 1) + b.0 as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: &str, b: &str, restitution: f64) -> RestitutionPair {
        RestitutionPair { materials: [a.into(), b.into()], restitution }
    }

    #[test]
    fn a_pair_holds_in_both_orders_and_the_rest_is_default() {
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
