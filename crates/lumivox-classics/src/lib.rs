//! Renderers of the literature, standing on Lumivox's public hooks ([`lumivox::hooks`]): here to be compared with it,
//! and as examples of what the hooks can do. Lumivox knows nothing of this crate.

pub mod photons;
