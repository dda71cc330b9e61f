//! The size of the map, and the part of it that each node gets.

use etagere::{AtlasAllocator, size2};
use glam::{UVec2, Vec2};

use super::charts::Triangle;
use super::{LARGEST, LightmapError, LightmapNode, Resolution, SMALLEST, cover};

/// The edge of the grid on which nodes are compared, if the map's is not known yet.
const GRID: u32 = 1024;
/// The share of covered texels that several nodes may have in a common map.
const SHARED: f64 = 1e-3;
/// Free texels around a node's part, so that filtering does not mix nodes.
const GUTTER: u32 = 1;
/// The least edge of a node's part, in texels.
const LEAST: u32 = 2;

/// Gives nodes their parts of the map, and converts coordinates to texels. Returns the map's edge,
/// and whether each node has a part of its own.
pub(super) fn place(
    nodes: &mut [LightmapNode],
    triangles: &mut [Triangle],
    resolution: Resolution,
) -> Result<(u32, bool), LightmapError> {
    let grid = if let Resolution::Texels(edge) = resolution { edge.min(GRID) } else { GRID };
    let is_packed = nodes.len() > 1 && cover::common(triangles, grid) > SHARED;
    let edge = if is_packed { pack(nodes, resolution)? } else { common_square(nodes, resolution)? };
    for node in nodes.iter_mut() {
        let [u, v] = node.corner.map(|texels| texels as f32 / edge as f32);
        let part = node.edge as f32 / edge as f32;
        node.rect = [u, v, u + part, v + part];
        node.texels_per_metre = (f64::from(node.edge) / unit_m(node)) as f32;
    }
    for triangle in triangles.iter_mut() {
        let node = &nodes[triangle.node as usize];
        let corner = Vec2::from(node.corner.map(|texels| texels as f32));
        triangle.uvs = triangle.uvs.map(|uv| corner + uv * node.edge as f32);
    }
    Ok((edge, is_packed))
}

/// Metres of surface along one unit of texture coordinates, in the mean.
fn unit_m(node: &LightmapNode) -> f64 {
    (node.area_m2 / node.area_uv).sqrt().max(1e-9)
}

/// All nodes get the whole map.
fn common_square(nodes: &mut [LightmapNode], resolution: Resolution) -> Result<u32, LightmapError> {
    let edge = match resolution {
        Resolution::Texels(edge) => edge,
        Resolution::Density(density) => {
            let (m2, uv) = nodes
                .iter()
                .fold((0.0, 0.0), |(m2, uv), node| (m2 + node.area_m2, uv + node.area_uv));
            let texels = f64::from(density) * (m2 / uv).sqrt();
            if texels > f64::from(LARGEST) {
                return Err(LightmapError::Dense { texels: texels.ceil() as u64, most: LARGEST });
            }
            (texels.ceil() as u32).next_multiple_of(4).clamp(SMALLEST, LARGEST)
        }
    };
    for node in nodes {
        node.edge = edge;
    }
    Ok(edge)
}

/// Each node gets a square, of the same density.
fn pack(nodes: &mut [LightmapNode], resolution: Resolution) -> Result<u32, LightmapError> {
    let units: Vec<f64> = nodes.iter().map(unit_m).collect();
    let edges = |density: f64| -> Vec<u32> {
        // A part that is too large for any map is refused below.
        let texels = |unit: &f64| ((density * unit).round() as u32).clamp(LEAST, LARGEST + 1);
        units.iter().map(texels).collect()
    };
    let refuse = |edge: u32| LightmapError::TooMany { nodes: nodes.len(), edge };
    let (edge, edges, corners) = match resolution {
        Resolution::Texels(edge) => {
            // The highest density that fits, by bisection.
            let longest = units.iter().copied().fold(0.0, f64::max);
            let (mut low, mut high) = (0.0, f64::from(edge) / longest);
            let mut found = None;
            for _ in 0..20 {
                let middle = if found.is_none() { low } else { 0.5 * (low + high) };
                match corners(&edges(middle), edge) {
                    Some(places) => {
                        found = Some((edge, edges(middle), places));
                        low = middle;
                    }
                    None if found.is_none() => break,
                    None => high = middle,
                }
            }
            found.ok_or_else(|| refuse(edge))?
        }
        Resolution::Density(density) => {
            let edges = edges(f64::from(density));
            // The smallest map that holds all, in steps of a sixteenth.
            let mut edge = SMALLEST;
            loop {
                if let Some(places) = corners(&edges, edge) {
                    break (edge, edges, places);
                }
                if edge == LARGEST {
                    return Err(refuse(LARGEST));
                }
                edge = (edge + edge / 16).next_multiple_of(4).clamp(edge + 4, LARGEST);
            }
        }
    };
    for ((node, edge), corner) in nodes.iter_mut().zip(edges).zip(corners) {
        (node.edge, node.corner) = (edge, corner.to_array());
    }
    Ok(edge)
}

/// The least corners of squares in a map, the largest placed first; `None` if they do not fit.
fn corners(edges: &[u32], map: u32) -> Option<Vec<UVec2>> {
    let room: u64 = edges.iter().map(|&edge| u64::from(edge + 2 * GUTTER).pow(2)).sum();
    if room > u64::from(map).pow(2) {
        return None;
    }
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by_key(|&node| std::cmp::Reverse(edges[node]));
    let mut atlas = AtlasAllocator::new(size2(map as i32, map as i32));
    let mut corners = vec![UVec2::ZERO; edges.len()];
    for node in order {
        let edge = (edges[node] + 2 * GUTTER) as i32;
        let corner = atlas.allocate(size2(edge, edge))?.rectangle.min;
        corners[node] = UVec2::new(corner.x as u32 + GUTTER, corner.y as u32 + GUTTER);
    }
    Some(corners)
}
