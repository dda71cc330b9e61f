//! Sequences of pictures: their files, and the index of the finished ones.

mod files;
mod index;

pub use files::FrameFiles;
pub use index::{Frame, Index, Start};
