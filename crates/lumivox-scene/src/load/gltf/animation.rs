//! Animations: channels that move nodes along key frames (glTF 2.0, section 3.11).

use std::collections::HashMap;
use std::sync::Arc;

use gltf::json;
use gltf::json::validation::Checked;

use super::node::Tree;
use super::{Loader, name_or_index};
use crate::SceneError;
use crate::pose::{Animation, Channel, Interpolation, Local, Property, Track};

/// Numbers that were already read, by accessor and numbers per element: many channels have the same
/// times.
type Known = HashMap<(usize, usize), Arc<[f32]>>;

impl Loader<'_> {
    /// Reads all animations into the rig. Channels of nodes outside the rig are dropped. Broken
    /// channels are dropped with a warning, so that the mesh is still shown.
    pub(super) fn load_animations(&mut self, tree: &Tree) {
        let mut known = Known::new();
        for (i, animation) in self.root().animations.iter().enumerate() {
            let name = name_or_index(animation.name.as_deref(), "animation", i);
            let mut channels = Vec::new();
            let mut faults = Vec::new();
            for (j, channel) in animation.channels.iter().enumerate() {
                let part = format!("animation \"{name}\", channel {j}");
                match self.channel(&part, animation, channel, tree, &mut known) {
                    Ok(channel) => channels.extend(channel),
                    Err(error) => faults.push((part, error)),
                }
            }
            if let Some((part, error)) = faults.first() {
                let reason = self.without_file(error);
                let place =
                    if reason.starts_with(part) { String::new() } else { part.clone() + ": " };
                self.notes.warn(format!(
                    "animation \"{name}\": {} of its {} channels were left out; {place}{reason}",
                    faults.len(),
                    animation.channels.len()
                ));
            }
            let ends = channels.iter().filter_map(|channel| channel.track.times_s.last());
            let duration_s = ends.copied().fold(0.0, f32::max);
            self.rig.animations.push(Animation { name, duration_s, channels });
        }
    }

    /// Reads a channel; `None` if it does not move anything in the rig.
    fn channel(
        &mut self,
        part: &str,
        animation: &json::Animation,
        channel: &json::animation::Channel,
        tree: &Tree,
        known: &mut Known,
    ) -> Result<Option<Channel>, SceneError> {
        let number = channel.target.node.value();
        // The JSON library does not validate this.
        if number >= self.root().nodes.len() {
            return Err(SceneError::IndexOutOfRange {
                file: self.file.to_owned(),
                part: format!("{part}, its node"),
                index: number,
                count: self.root().nodes.len(),
                target: "nodes",
            });
        }
        let Some(node) = tree.place(number) else { return Ok(None) };
        let sampler = &animation.samplers[channel.sampler.value()];
        let Some((property, components)) = self.property(part, channel, node, tree)? else {
            return Ok(None);
        };
        let Some(track) = self.track(part, sampler, components, known)? else {
            return Ok(None);
        };
        if property == Property::Rotation
            && let Some(key) = track.first_zero_rotation()
        {
            let reason = format!("key {key} is a rotation of length zero");
            return Err(self.malformed(part, &reason));
        }
        if property != Property::Weights {
            self.split_matrix(node)?;
        }
        Ok(Some(Channel { node, property, track }))
    }

    /// The animated property, and the number of components of its values. `None`, with a warning,
    /// if it is not supported.
    fn property(
        &mut self,
        part: &str,
        channel: &json::animation::Channel,
        node: usize,
        tree: &Tree,
    ) -> Result<Option<(Property, usize)>, SceneError> {
        use json::animation::Property as Path;
        Ok(match channel.target.path {
            Checked::Valid(Path::Translation) => Some((Property::Translation, 3)),
            Checked::Valid(Path::Rotation) => Some((Property::Rotation, 4)),
            Checked::Valid(Path::Scale) => Some((Property::Scale, 3)),
            Checked::Valid(Path::MorphTargetWeights) => match tree.targets(self.root(), node) {
                0 => {
                    self.notes.warn(format!(
                        "{part}: it moves the weights of {}, which has no morph targets; it was \
                         ignored",
                        self.rig.nodes[node].name
                    ));
                    None
                }
                count => {
                    // Missing weights are zero.
                    let missing = count - self.rig.nodes[node].weights.len();
                    self.spend_weights(part, missing)?;
                    self.rig.nodes[node].weights.resize(count, 0.0);
                    Some((Property::Weights, count))
                }
            },
            Checked::Invalid => {
                self.notes.warn(format!(
                    "{part}: only translation, rotation, scale and weights can move; it was ignored"
                ));
                None
            }
        })
    }

    fn track(
        &mut self,
        part: &str,
        sampler: &json::animation::Sampler,
        components: usize,
        known: &mut Known,
    ) -> Result<Option<Track>, SceneError> {
        let interpolation = match sampler.interpolation {
            Checked::Valid(json::animation::Interpolation::Step) => Interpolation::Step,
            Checked::Valid(json::animation::Interpolation::Linear) => Interpolation::Linear,
            Checked::Valid(json::animation::Interpolation::CubicSpline) => {
                Interpolation::CubicSpline
            }
            Checked::Invalid => {
                return Err(self.malformed(part, "its interpolation is unknown"));
            }
        };
        let times_s = self.numbers::<1>(part, sampler.input.value(), "times", known)?;
        if times_s.is_empty() {
            self.notes.warn(format!("{part}: it has no keys and was ignored"));
            return Ok(None);
        }
        if let Some(key) = times_s.windows(2).position(|pair| pair[1] < pair[0]) {
            let reason = format!(
                "the times of its keys fall from {} to {} s at key {}",
                times_s[key],
                times_s[key + 1],
                key + 1
            );
            return Err(self.malformed(part, &reason));
        }
        let output = sampler.output.value();
        let values = match components {
            3 if !self.is_scalar(output) => self.numbers::<3>(part, output, "values", known)?,
            4 if !self.is_scalar(output) => self.numbers::<4>(part, output, "values", known)?,
            _ => self.numbers::<1>(part, output, "values", known)?,
        };
        let per_key = components.checked_mul(interpolation.values_per_key());
        if per_key.and_then(|n| n.checked_mul(times_s.len())) != Some(values.len()) {
            let reason = format!(
                "it has {} numbers for {} keys of {} numbers each",
                values.len(),
                times_s.len(),
                per_key.unwrap_or(0)
            );
            return Err(self.malformed(part, &reason));
        }
        Ok(Some(Track { times_s, values, components, interpolation }))
    }

    fn is_scalar(&self, accessor: usize) -> bool {
        let scalar = Checked::Valid(json::accessor::Type::Scalar);
        self.root().accessors.get(accessor).is_some_and(|accessor| accessor.type_ == scalar)
    }

    fn numbers<const N: usize>(
        &self,
        part: &str,
        accessor: usize,
        what: &str,
        known: &mut Known,
    ) -> Result<Arc<[f32]>, SceneError> {
        if let Some(known) = known.get(&(accessor, N)) {
            return Ok(Arc::clone(known));
        }
        let numbers = self.read_floats::<N>(accessor, what)?.into_flattened();
        if let Some(i) = numbers.iter().position(|number| !number.is_finite()) {
            let part = format!("{part}, number {i} of its {what},");
            return Err(SceneError::NotFinite { file: self.file.to_owned(), part });
        }
        let numbers: Arc<[f32]> = numbers.into();
        known.insert((accessor, N), Arc::clone(&numbers));
        Ok(numbers)
    }

    /// Splits the matrix of an animated node into translation, rotation and scale: some exporters
    /// write one, which glTF forbids.
    fn split_matrix(&mut self, node: usize) -> Result<(), SceneError> {
        let node = &mut self.rig.nodes[node];
        let Local::Matrix(matrix) = node.rest else { return Ok(()) };
        let name = node.name.clone();
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        let parts = Local::Parts { translation, rotation, scale };
        if matrix.determinant() == 0.0 || !parts.to_matrix().is_finite() {
            return Err(self.malformed(&name, "an animation moves it, but its matrix is flat"));
        }
        node.rest = parts;
        self.notes.warn(format!(
            "{name}: an animation moves it, so its matrix was split into translation, rotation and \
             scale; shear is lost"
        ));
        Ok(())
    }
}
