// Combines two adjacent cells along an axis, seen from both sides: the rule for filtering pyramids.
//
// Along a lobe's axis the farther cell adds to the nearer one up to full coverage. The sum
// saturates instead of multiplying transmittances, because coverage comes from clipping: the pieces
// of a wall that straddles two cells are parts of one sheet and add up to exactly one. A cell that
// hides radiance also hides the vector area, so the same weights apply to both.

// The parts of a cell along an axis (parts.wgsl), or those of two cells combined.
struct AxisParts {
    positive: vec4f,
    negative: vec4f,
    tilt: vec4f,
}

// The share of the farther cell that the nearer one leaves visible.
fn uncovered(near: f32, far: f32) -> f32 {
    if far <= 0.0 {
        return 0.0;
    }
    return min(far, 1.0 - near) / far;
}

// `high` is the cell with the larger coordinate: the nearer one for the positive lobe.
fn filter_column(low: AxisParts, high: AxisParts) -> AxisParts {
    let positive_share = uncovered(high.positive.a, low.positive.a);
    let negative_share = uncovered(low.negative.a, high.negative.a);
    return AxisParts(
        high.positive + positive_share * low.positive,
        low.negative + negative_share * high.negative,
        vec4f(
            high.tilt.xy + positive_share * low.tilt.xy,
            low.tilt.zw + negative_share * high.tilt.zw,
        ),
    );
}
