//! Random numbers from a seed.

use glam::{DQuat, DVec4, Quat, Vec3};
use lumivox_scene::builtin::build::{chance, pick};

/// A sequence of random numbers; each is the hash of the seed and of its index.
pub(super) struct Dice {
    seed: u32,
    drawn: u32,
}

impl Dice {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, drawn: 0 }
    }

    /// A number from 0 to below 1.
    pub(super) fn draw(&mut self) -> f32 {
        self.drawn += 1;
        chance(self.seed, self.drawn, 0)
    }

    pub(super) fn is(&mut self, probability: f32) -> bool {
        self.draw() < probability
    }

    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.draw()
    }

    /// One of the numbers from `low` to `high`.
    pub(super) fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + (self.draw() * (high - low + 1) as f32) as u32
    }

    pub(super) fn pick<T: Copy>(&mut self, things: &[T]) -> T {
        pick(things, self.draw())
    }

    /// A point of a box; also a colour.
    pub(super) fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| self.between(low[axis], high[axis])))
    }

    /// A uniformly random rotation: the direction of a point in the four-dimensional ball.
    pub(super) fn rotation(&mut self) -> Quat {
        loop {
            let point = [(); 4].map(|()| f64::from(self.between(-1.0, 1.0)));
            let length = DVec4::from_array(point).length();
            if (0.1..=1.0).contains(&length) {
                return DQuat::from_array(point.map(|part| part / length)).as_quat();
            }
        }
    }
}
