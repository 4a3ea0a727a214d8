use super::*;

fn solved(bodies: &[(f64, f64, [bool; 2])], contacts: &[[usize; 2]]) -> Vec<f64> {
    let mut group = ContactGroup::default();
    for (free, mass, supported) in bodies {
        let body = group.add((*free).into(), *mass);
        Side::BOTH.into_iter().filter(|side| supported[*side]).for_each(|side| group.support(body, side));
    }
    contacts.iter().for_each(|pair| group.connect(*pair));
    group.solve().iter().map(|acceleration| acceleration.high).collect()
}

const FREE: [bool; 2] = [false; 2];

#[test]
fn bodies_pressed_together_move_as_one() {
    assert_eq!(solved(&[(3.0, 1.0, FREE), (-1.0, 3.0, FREE)], &[[0, 1]]), [0.0, 0.0]);
    assert_eq!(solved(&[(5.0, 1.0, FREE), (1.0, 3.0, FREE)], &[[0, 1]]), [2.0, 2.0]);
}

#[test]
fn bodies_pulled_apart_separate() {
    assert_eq!(solved(&[(-1.0, 1.0, FREE), (2.0, 3.0, FREE)], &[[0, 1]]), [-1.0, 2.0]);
}

#[test]
fn contacts_transmit_no_tension() {
    let bodies = [(4.0, 1.0, FREE), (0.0, 1.0, FREE), (9.0, 1.0, FREE)];
    assert_eq!(solved(&bodies, &[[0, 1], [1, 2]]), [2.0, 2.0, 9.0]);
}

#[test]
fn a_box_on_two_is_pressed_by_both() {
    let bodies = [(6.0, 1.0, FREE), (3.0, 1.0, FREE), (0.0, 1.0, FREE)];
    assert_eq!(solved(&bodies, &[[0, 2], [1, 2]]), [3.0, 3.0, 3.0]);
    assert_eq!(solved(&[(6.0, 1.0, FREE), (1.0, 1.0, FREE), (0.0, 1.0, FREE)], &[[0, 2], [1, 2]]), [3.0, 1.0, 3.0]);
}

#[test]
fn a_supported_body_rests_unless_it_is_pulled_away() {
    let supported = [false, true];
    assert_eq!(solved(&[(5.0, 1.0, FREE), (5.0, 1.0, supported)], &[[0, 1]]), [0.0, 0.0]);
    assert_eq!(solved(&[(-5.0, 1.0, FREE), (5.0, 1.0, supported)], &[[0, 1]]), [-5.0, 0.0]);
    assert_eq!(solved(&[(1.0, 1.0, FREE), (-7.0, 1.0, supported)], &[[0, 1]]), [-3.0, -3.0]);
}

#[test]
fn a_stack_is_solved_like_a_partial_order() {
    let bodies: Vec<(f64, f64, [bool; 2])> =
        (0..9_u32).map(|index| (f64::from(index * 7 % 5) - 2.0, f64::from(index % 3 + 1), FREE)).collect();
    let contacts: Vec<[usize; 2]> = (0..8).map(|index| [index, index + 1]).collect();
    let mut group = ContactGroup::default();
    bodies.iter().for_each(|(free, mass, _)| _ = group.add((*free).into(), *mass));
    contacts.iter().for_each(|pair| group.connect(*pair));
    let general = group.solve_partial_order();
    for (chain, general) in group.solve().iter().zip(general) {
        assert!((*chain - general).high.abs() < 1e-28);
    }
}

#[test]
fn random_groups_satisfy_the_optimality_conditions() {
    let mut state = 12345_u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    for _ in 0..200 {
        let bodies: Vec<_> = (0..6).map(|_| (random() * 10.0 - 5.0, 0.5 + random(), FREE)).collect();
        let contacts: Vec<[usize; 2]> =
            (0..6).flat_map(|j| (0..j).map(move |i| [i, j])).filter(|_| random() < 0.4).collect();
        let a = solved(&bodies, &contacts);
        let slack = 1e-12;
        assert!(contacts.iter().all(|[i, j]| a[*j] >= a[*i] - slack), "no contact is penetrated");
        let force = |i: usize| bodies[i].1 * (a[i] - bodies[i].0);
        assert!((0..6).map(force).sum::<f64>().abs() < 1e-9, "contact forces cancel");
        assert!(
            (0..6).map(|i| force(i) * a[i]).sum::<f64>().abs() < 1e-9,
            "contact forces act only between bodies that stay together"
        );
        for from in 0..64_u32 {
            let closed = contacts.iter().all(|[i, j]| from >> i & 1 == 0 || from >> j & 1 == 1);
            let pushed: f64 = (0..6).filter(|i| from >> i & 1 == 1).map(force).sum();
            assert!(!closed || pushed > -1e-9, "contact forces only push");
        }
    }
}
