//! Light for texels without samples.

use glam::Vec3;

/// Spreads light from known texels to the others, ring by ring: each gets the mean of its known
/// neighbours among eight. Light goes only where `may(from, to)` allows it.
pub(super) fn spread(
    light: &mut [Vec3],
    is_known: &mut [bool],
    edge: u32,
    may: impl Fn(usize, usize) -> bool,
) {
    let around = |texel: usize| {
        let edge = edge as usize;
        let (x, y) = (texel % edge, texel / edge);
        let rows = y.saturating_sub(1)..(y + 2).min(edge);
        rows.flat_map(move |row| {
            (x.saturating_sub(1)..(x + 2).min(edge)).map(move |column| row * edge + column)
        })
    };
    let mut ring: Vec<usize> = (0..light.len())
        .filter(|&texel| {
            !is_known[texel] && around(texel).any(|from| is_known[from] && may(from, texel))
        })
        .collect();
    let mut is_listed = is_known.to_vec();
    for &texel in &ring {
        is_listed[texel] = true;
    }
    while !ring.is_empty() {
        let mean = |&texel: &usize| {
            let known = around(texel).filter(|&from| is_known[from] && may(from, texel));
            let (sum, count) = known
                .fold((Vec3::ZERO, 0.0), |(sum, count), from| (sum + light[from], count + 1.0));
            sum / count
        };
        let means: Vec<Vec3> = ring.iter().map(mean).collect();
        let mut next = Vec::new();
        for (&texel, mean) in ring.iter().zip(means) {
            light[texel] = mean;
            is_known[texel] = true;
            for to in around(texel) {
                if !is_listed[to] && may(texel, to) {
                    is_listed[to] = true;
                    next.push(to);
                }
            }
        }
        ring = next;
    }
}
