//! Many pictures: their files, and the index that tells what is there.

mod files;
mod index;

pub use files::FrameFiles;
pub use index::{Frame, Index, Start};
