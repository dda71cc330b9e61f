//! A builder that passes all work to another builder, and remembers the buffers of the octree.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use lumivox::gpu::{BindGroup, Buffer, Pipelines, Recorder};
use lumivox::hooks::{OctreeBuilder, OctreeBuilding, OctreeParts, TreeToBuild};
use lumivox::{GiError, Grid};

use crate::testing::nodes::{NODE_WORDS, NodeAt, walk_nodes};
use crate::testing::read;

/// Wraps another builder.
#[derive(Debug)]
pub(super) struct Watched {
    inner: Arc<dyn OctreeBuilding>,
    /// Groups of nodes to report as missed.
    missed: u32,
    /// The octree and its sites, of the last binding.
    seen: Arc<Mutex<Option<[Buffer; 2]>>>,
}

impl Watched {
    pub(super) fn new(inner: Arc<dyn OctreeBuilding>) -> Arc<Self> {
        Self::blamed(inner, 0)
    }

    /// A builder that reports missed groups of nodes.
    pub(super) fn blamed(inner: Arc<dyn OctreeBuilding>, missed: u32) -> Arc<Self> {
        Arc::new(Self { inner, missed, seen: Arc::default() })
    }

    /// The places of the nodes that were built.
    pub(super) fn nodes(
        &self,
        (device, queue): &(Pipelines, wgpu::Queue),
        grid: &Grid,
    ) -> BTreeMap<NodeAt, u32> {
        let seen = self.seen.lock().expect("nobody panicked");
        let [octree, sites] = seen.as_ref().expect("it was bound");
        let words: Vec<u32> = read(device, queue, octree, (octree.size() / 4) as usize);
        let sites: Vec<[u32; 2]> = read(device, queue, sites, (sites.size() / 8) as usize);
        let table_words = words.len() as u32 - sites.len() as u32 * NODE_WORDS;
        walk_nodes((&words, table_words), &sites, grid.morton_edge(0).ilog2())
    }
}

impl OctreeBuilding for Watched {
    fn name(&self) -> &'static str {
        "watched"
    }

    fn make(&self, parts: &OctreeParts<'_>) -> Result<Box<dyn OctreeBuilder>, GiError> {
        let inner = self.inner.make(parts)?;
        Ok(Box::new(WatchedBuilder { inner, missed: self.missed, seen: self.seen.clone() }))
    }
}

#[derive(Debug)]
struct WatchedBuilder {
    inner: Box<dyn OctreeBuilder>,
    missed: u32,
    seen: Arc<Mutex<Option<[Buffer; 2]>>>,
}

impl OctreeBuilder for WatchedBuilder {
    fn bind(&mut self, device: &wgpu::Device, tree: &TreeToBuild<'_>) -> Result<(), GiError> {
        let buffers = [tree.octree.clone(), tree.sites.clone()];
        *self.seen.lock().expect("nobody panicked") = Some(buffers);
        self.inner.bind(device, tree)
    }

    fn release(&mut self) {
        self.inner.release();
    }

    fn build(&self, recorder: &mut Recorder<'_>, globals: &BindGroup) {
        self.inner.build(recorder, globals);
    }

    fn counters(&self) -> Option<&Buffer> {
        self.inner.counters()
    }

    fn check(&self, counters: &[u32], groups: u32) -> Result<Vec<(&'static str, u64)>, GiError> {
        self.inner.check(counters, groups + self.missed)
    }
}
