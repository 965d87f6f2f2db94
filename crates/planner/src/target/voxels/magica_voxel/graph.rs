//! Scene graph of a `.vox` file, which places its models.
use std::collections::BTreeMap;

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::UnreadableVoxels;
use super::bytes::Bytes;
use super::placement::{Malformed, Placement};

/// Nodes of a scene by number.
#[derive(Debug, Default)]
pub struct SceneGraph<'a> {
    nodes: BTreeMap<u32, Node<'a>>,
    hidden_layers: FxHashSet<u32>,
}

#[derive(Debug)]
enum Node<'a> {
    Transform {
        child: u32,
        layer: u32,
        placement: Placement,
        is_hidden: bool,
    },
    Group {
        /// 32-bit numbers of the children.
        children: &'a [u8],
        is_hidden: bool,
    },
    Shape {
        models: Vec<u32>,
        is_hidden: bool,
    },
}

/// Model at a place in the scene.
#[derive(Debug)]
pub struct Instance<'g> {
    /// Number of its shape.
    pub node: u32,
    /// Numbers of its models. Several are an animation.
    pub models: &'g [u32],
    pub placement: Placement,
    /// Whether the model is hidden: by its own node, by an enclosing node or by a layer.
    pub is_hidden: bool,
}

/// Node on the path from a root, with inherited properties.
struct Visit {
    node: u32,
    placement: Placement,
    is_hidden: bool,
}

impl<'a> SceneGraph<'a> {
    /// Returns whether the file has no scene, as in old versions.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub fn add_transform(&mut self, mut content: Bytes<'a>) -> Result<(), UnreadableVoxels> {
        let number = content.number()?;
        let is_hidden = content.attributes()?.is_hidden;
        let child = content.number()?;
        // Reserved.
        content.number()?;
        let layer = content.number()?;
        let mut placement = None;
        for _ in 0..content.number()? {
            let frame = content.attributes()?;
            let read = Placement::read(frame.rotation, frame.translation);
            let read = read.map_err(|malformed| malformed_in(number, malformed))?;
            if *placement.get_or_insert(read) != read {
                return Err(UnreadableVoxels::Moves { node: number });
            }
        }
        let node = Node::Transform {
            child,
            layer,
            placement: placement.unwrap_or(Placement::IDENTITY),
            is_hidden,
        };
        self.add(number, node)
    }

    pub fn add_group(&mut self, mut content: Bytes<'a>) -> Result<(), UnreadableVoxels> {
        let number = content.number()?;
        let is_hidden = content.attributes()?.is_hidden;
        let count = content.number()?;
        let length = (count as usize).checked_mul(4);
        let children = content.take(length.ok_or(UnreadableVoxels::CutOff)?)?;
        self.add(
            number,
            Node::Group {
                children,
                is_hidden,
            },
        )
    }

    pub fn add_shape(&mut self, mut content: Bytes<'a>) -> Result<(), UnreadableVoxels> {
        let number = content.number()?;
        let is_hidden = content.attributes()?.is_hidden;
        let mut models = Vec::new();
        for _ in 0..content.number()? {
            models.push(content.number()?);
            content.attributes()?;
        }
        self.add(number, Node::Shape { models, is_hidden })
    }

    pub fn add_layer(&mut self, mut content: Bytes<'a>) -> Result<(), UnreadableVoxels> {
        let number = content.number()?;
        if content.attributes()?.is_hidden {
            self.hidden_layers.insert(number);
        }
        Ok(())
    }

    fn add(&mut self, number: u32, node: Node<'a>) -> Result<(), UnreadableVoxels> {
        match self.nodes.insert(number, node) {
            None => Ok(()),
            Some(_) => Err(UnreadableVoxels::DuplicateNode { node: number }),
        }
    }

    /// Returns all instances in the scene, including hidden ones.
    ///
    /// # Errors
    ///
    /// If a node is missing or the nodes do not form a tree. This bounds the time by the length of
    /// the file.
    pub fn instances(&self) -> Result<Vec<Instance<'_>>, UnreadableVoxels> {
        let parents = self.parents()?;
        let roots = self.nodes.keys().filter(|node| !parents.contains_key(node));
        let mut open: Vec<Visit> = roots
            .map(|&node| Visit {
                node,
                placement: Placement::IDENTITY,
                is_hidden: false,
            })
            .collect();
        let mut instances = Vec::new();
        let mut visited = FxHashSet::default();
        while let Some(visit) = open.pop() {
            visited.insert(visit.node);
            self.visit(&visit, &mut open, &mut instances);
        }
        // Nodes of a cycle all have parents and are not reached from a root.
        match self.nodes.keys().find(|node| !visited.contains(node)) {
            Some(&node) => Err(UnreadableVoxels::NotATree { node }),
            None => Ok(instances),
        }
    }

    /// Adds the content of a node.
    fn visit<'g>(
        &'g self,
        visit: &Visit,
        open: &mut Vec<Visit>,
        instances: &mut Vec<Instance<'g>>,
    ) {
        match &self.nodes[&visit.node] {
            Node::Transform {
                child,
                layer,
                placement,
                is_hidden,
            } => open.push(Visit {
                node: *child,
                placement: visit.placement.around(placement),
                is_hidden: visit.is_hidden || *is_hidden || self.hidden_layers.contains(layer),
            }),
            Node::Group {
                children,
                is_hidden,
            } => open.extend(numbers(children).map(|node| Visit {
                node,
                placement: visit.placement,
                is_hidden: visit.is_hidden || *is_hidden,
            })),
            Node::Shape { models, is_hidden } => instances.push(Instance {
                node: visit.node,
                models,
                placement: visit.placement,
                is_hidden: visit.is_hidden || *is_hidden,
            }),
        }
    }

    /// Returns the parent of each node that has one.
    fn parents(&self) -> Result<FxHashMap<u32, u32>, UnreadableVoxels> {
        let mut parents = FxHashMap::default();
        let mut insert = |child: u32, parent: u32| {
            if !self.nodes.contains_key(&child) {
                return Err(UnreadableVoxels::MissingNode {
                    from: parent,
                    to: child,
                });
            }
            match parents.insert(child, parent) {
                None => Ok(()),
                Some(_) => Err(UnreadableVoxels::NotATree { node: child }),
            }
        };
        for (&number, node) in &self.nodes {
            match node {
                Node::Transform { child, .. } => insert(*child, number)?,
                Node::Group { children, .. } => {
                    numbers(children).try_for_each(|child| insert(child, number))?;
                }
                Node::Shape { .. } => {}
            }
        }
        Ok(parents)
    }
}

fn numbers(bytes: &[u8]) -> impl Iterator<Item = u32> {
    let (numbers, _) = bytes.as_chunks::<4>();
    numbers.iter().map(|bytes| u32::from_le_bytes(*bytes))
}

fn malformed_in(node: u32, malformed: Malformed<'_>) -> UnreadableVoxels {
    let written = |text| String::from_utf8_lossy(text).chars().take(40).collect();
    match malformed {
        Malformed::Rotation(text) => UnreadableVoxels::Rotation {
            node,
            text: written(text),
        },
        Malformed::Translation(text) => UnreadableVoxels::Translation {
            node,
            text: written(text),
        },
    }
}
