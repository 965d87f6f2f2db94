//! Checks that the 24 rotations form a group and agree with matrices and quaternions.
use nalgebra::Vector3;
use proptest::prelude::*;
use stochc_control::Orientation;
use stochc_ir::Face;
use stochc_runtime::world::rotation::{matrix, quaternion};

fn orientation() -> impl Strategy<Value = Orientation> {
    prop::sample::select(Orientation::all().collect::<Vec<_>>())
}

fn face() -> impl Strategy<Value = Face> {
    prop::sample::select(Face::ALL.to_vec())
}

fn normal(face: Face) -> Vector3<f64> {
    Vector3::from(face.normal()).cast()
}

#[test]
fn there_are_24_orientations() {
    let all: std::collections::BTreeSet<_> = Orientation::all().collect();
    assert_eq!(all.len(), 24);
    assert_eq!(Orientation::all().next(), Some(Orientation::IDENTITY));
    for orientation in all {
        assert_eq!(matrix(orientation).determinant(), 1.0);
    }
}

proptest! {
    #[test]
    fn orientations_are_a_group(a in orientation(), b in orientation(), c in orientation()) {
        prop_assert_eq!(a.after(b).after(c), a.after(b.after(c)));
        prop_assert_eq!(a.after(Orientation::IDENTITY), a);
        prop_assert_eq!(Orientation::IDENTITY.after(a), a);
        prop_assert_eq!(a.after(a.inverse()), Orientation::IDENTITY);
        prop_assert_eq!(a.inverse().after(a), Orientation::IDENTITY);
    }

    #[test]
    fn orientations_act_on_faces_like_matrices(a in orientation(), b in orientation(), own in face()) {
        let there = a.to_structure(own);
        prop_assert_eq!(a.to_own(there), own);
        prop_assert_eq!(a.after(b).to_structure(own), a.to_structure(b.to_structure(own)));
        prop_assert_eq!(a.to_structure(own.opposite()), there.opposite());
        prop_assert_eq!(matrix(a) * normal(own), normal(there));
        prop_assert!((quaternion(a) * normal(own) - normal(there)).norm() < 1e-12);
        prop_assert_eq!(matrix(a.after(b)), matrix(a) * matrix(b));
    }

    #[test]
    fn docking_brings_two_faces_together(
        parent in orientation(),
        parent_face in face(),
        child_face in face(),
        turn in 0u8..4,
    ) {
        let docked = |turn| Orientation::docked(parent, parent_face, child_face, turn);
        let towards = parent.to_structure(parent_face);
        prop_assert_eq!(docked(turn).to_structure(child_face), towards.opposite());
        // Two successive turns differ by a quarter turn, positive about the parent's outward
        // normal.
        let quarter = Orientation::turned(towards, 1);
        prop_assert_eq!(docked((turn + 1) % 4), quarter.after(docked(turn)));
        let angle = quaternion(quarter);
        prop_assert!((angle.scaled_axis() - normal(towards) * std::f64::consts::FRAC_PI_2).norm() < 1e-12);
        // In the frame of the parent, the orientation of the parent does not matter.
        let plain = Orientation::docked(Orientation::IDENTITY, parent_face, child_face, turn);
        prop_assert_eq!(docked(turn), parent.after(plain));
    }
}
