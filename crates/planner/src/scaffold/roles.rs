//! What the cells of a target with its scaffolds are for.
use stochc_ir::{Cell, Face};

use super::Scaffolding;
use crate::sites::{NONE, Sites};

/// What a site is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SitePart {
    /// The target, held as in the end from the beginning on.
    Own,
    /// The target, held by a mast until it is handed over: the number of its piece.
    Held(u32),
    /// A mast, by its number.
    Mast(u32),
}

/// The parts of all sites.
#[derive(Debug)]
pub struct SiteRoles {
    part: Vec<SitePart>,
    /// The only way in which a site is captured at first.
    way: Vec<Option<Face>>,
    pieces: Vec<SitePiece>,
    /// Sites of the target that a mast holds, and masts.
    temporary: usize,
}

/// A piece by its sites.
#[derive(Debug)]
pub struct SitePiece {
    /// The sites with the way into each in the end, in the order in which they are handed over.
    pub sites: Vec<(u32, Face)>,
    /// What holds the first of these in the end.
    pub join: u32,
    /// The mast.
    pub mast: u32,
}

impl SiteRoles {
    /// Of the sites of a target together with its masts.
    pub fn new(sites: &Sites<'_>, scaffolding: &Scaffolding) -> SiteRoles {
        let mut part = vec![SitePart::Own; sites.len()];
        let mut way = vec![None; sites.len()];
        let masts = scaffolding.masts();
        for (&((x, y), height), number) in masts.iter().zip(0..) {
            for z in 1..=height {
                let site = sites.at(Cell::new(x, y, z)) as usize;
                (part[site], way[site]) = (SitePart::Mast(number), Some(Face::Up));
            }
        }
        let pieces = scaffolding.pieces.iter().zip(0..).map(|(piece, number)| {
            for (cell, from) in piece.grown() {
                let site = sites.at(cell) as usize;
                (part[site], way[site]) = (SitePart::Held(number), Some(from));
            }
            let handed_over = piece.handed_over();
            let mast = masts.iter().position(|(foot, _)| *foot == piece.foot);
            SitePiece {
                sites: handed_over
                    .map(|(cell, way)| (sites.at(cell), way))
                    .collect(),
                join: sites.at(piece.join),
                mast: mast.map_or(NONE, |mast| mast as u32),
            }
        });
        let pieces = pieces.collect();
        SiteRoles {
            temporary: part.iter().filter(|part| **part != SitePart::Own).count(),
            part,
            way,
            pieces,
        }
    }

    /// What a site is for.
    pub fn part(&self, site: u32) -> SitePart {
        self.part[site as usize]
    }

    /// The only way in which a site may be captured at first; `None`: any from a block of the target that is held as in the end.
    pub fn way(&self, site: u32) -> Option<Face> {
        self.way[site as usize]
    }

    /// The pieces.
    pub fn pieces(&self) -> &[SitePiece] {
        &self.pieces
    }

    /// How many sites belong to masts, or hang on them at first.
    pub fn temporary(&self) -> usize {
        self.temporary
    }

    /// Of each site, the block that has to be there for it to be handed over: the one that the first piece on the way to the
    /// plate joins. [`NONE`] for what is not handed over.
    pub fn roots(&self) -> Vec<u32> {
        let mut roots = vec![NONE; self.part.len()];
        for piece in &self.pieces {
            let mut join = piece.join;
            while let SitePart::Held(number) = self.part(join) {
                join = self.pieces[number as usize].join;
            }
            for &(site, _) in &piece.sites {
                roots[site as usize] = join;
            }
        }
        roots
    }
}
