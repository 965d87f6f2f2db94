//! Positions of structure blocks whose faces always attract.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use stochc_control::Orientation;
use stochc_ir::Face;

use crate::world::real::{Real, normal};
use crate::world::{BlockFace, Body};

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct PlacedBlocks<R: Real>(BTreeMap<Body, (Vector3<R>, Orientation)>);

impl<R: Real> PlacedBlocks<R> {
    /// Inserts a block. Returns whether it was absent.
    pub fn insert(&mut self, body: Body, centre: Vector3<R>, orientation: Orientation) -> bool {
        self.0.insert(body, (centre, orientation)).is_none()
    }

    pub fn has(&self, body: Body) -> bool {
        self.0.contains_key(&body)
    }

    pub fn remove(&mut self, body: Body) {
        self.0.remove(&body);
    }

    /// Returns the outward normal of a face.
    pub fn outward(&self, block_face: BlockFace) -> Vector3<R> {
        let pose = self.0.get(&block_face.body);
        pose.map_or_else(Vector3::zeros, |(_, orientation)| {
            normal(orientation.to_structure(block_face.face).normal())
        })
    }

    /// Returns the faces with a free cell in front, above the ground, in the order of sites. Each
    /// comes with its block's centre and orientation.
    pub fn open_faces(&self) -> Vec<(BlockFace, Vector3<R>, Orientation)> {
        let cell = |centre: Vector3<R>| {
            [centre.x, centre.y, centre.z].map(|x| libm::round(2.0 * x.double()) as i64)
        };
        let full: BTreeSet<[i64; 3]> = self.0.values().map(|&(centre, _)| cell(centre)).collect();
        let mut open = Vec::new();
        for (&body, &(centre, orientation)) in &self.0 {
            for face in Face::ALL {
                let before = centre + normal::<R>(orientation.to_structure(face).normal());
                if before.z > R::zero() && !full.contains(&cell(before)) {
                    open.push((BlockFace { body, face }, centre, orientation));
                }
            }
        }
        open.sort_unstable_by_key(|&(block_face, ..)| block_face);
        open
    }
}
