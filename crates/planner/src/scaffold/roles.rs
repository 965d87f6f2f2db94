//! Assignment of sites to the target, to segments and to masts.
use stochc_ir::{Cell, Face};

use super::Scaffolding;
use crate::space::sites::{NONE, Sites};

/// Part of a plan that contains a site.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SitePart {
    /// Target block that its final parent captures from the start.
    Own,
    /// Target block on a mast until its hand-over. Contains the number of its segment.
    Held(u32),
    /// Block of a mast. Contains the number of the mast.
    Mast(u32),
}

/// Parts of a plan, by site.
#[derive(Debug)]
pub struct SiteRoles {
    part: Vec<SitePart>,
    /// The only direction of a site's first capture, if it is fixed.
    direction: Vec<Option<Face>>,
    segments: Vec<SiteSegment>,
    /// Number of target sites that are first captured on masts, plus the number of mast sites.
    temporary: usize,
}

/// Segment on a mast, as sites instead of cells.
#[derive(Debug)]
pub struct SiteSegment {
    /// Sites in hand-over order, with the direction from the final parent.
    pub sites: Vec<(u32, Face)>,
    /// Final parent of the first site.
    pub join: u32,
    pub mast: u32,
}

impl SiteRoles {
    /// Assigns each site to the target, a segment or a mast.
    pub fn new(sites: &Sites<'_>, scaffolding: &Scaffolding) -> SiteRoles {
        let mut part = vec![SitePart::Own; sites.len()];
        let mut direction = vec![None; sites.len()];
        let masts = scaffolding.masts();
        for (&((x, y), height), number) in masts.iter().zip(0..) {
            for z in 1..=height {
                let site = sites.at(Cell::new(x, y, z)) as usize;
                (part[site], direction[site]) = (SitePart::Mast(number), Some(Face::Up));
            }
        }
        let segments = scaffolding
            .segments
            .iter()
            .zip(0..)
            .map(|(segment, number)| {
                for (cell, from) in segment.grown() {
                    let site = sites.at(cell) as usize;
                    (part[site], direction[site]) = (SitePart::Held(number), Some(from));
                }
                let handed_over = segment.handed_over();
                let mast = masts.iter().position(|(foot, _)| *foot == segment.foot);
                SiteSegment {
                    sites: handed_over
                        .map(|(cell, direction)| (sites.at(cell), direction))
                        .collect(),
                    join: sites.at(segment.join),
                    mast: mast.map_or(NONE, |mast| mast as u32),
                }
            });
        let segments = segments.collect();
        SiteRoles {
            temporary: part.iter().filter(|part| **part != SitePart::Own).count(),
            part,
            direction,
            segments,
        }
    }

    pub fn part(&self, site: u32) -> SitePart {
        self.part[site as usize]
    }

    /// Returns the only possible direction of a site's first capture. Returns `None` if any block
    /// that is attached to its final parent may capture the site.
    pub fn direction(&self, site: u32) -> Option<Face> {
        self.direction[site as usize]
    }

    pub fn segments(&self) -> &[SiteSegment] {
        &self.segments
    }

    pub fn temporary(&self) -> usize {
        self.temporary
    }

    /// Returns, for each site that is handed over, the site that must be captured before its
    /// hand-over. The chain of joined segments ends at this target site. [`NONE`] for all other
    /// sites.
    pub(crate) fn roots(&self) -> Vec<u32> {
        let mut roots = vec![NONE; self.part.len()];
        for segment in &self.segments {
            let mut join = segment.join;
            while let SitePart::Held(number) = self.part(join) {
                join = self.segments[number as usize].join;
            }
            for &(site, _) in &segment.sites {
                roots[site as usize] = join;
            }
        }
        roots
    }
}
