//! Faults of OBJ statements.

use std::path::Path;

use crate::SceneError;

/// A fault of one statement.
pub(super) enum Fault {
    Text(String),
    Index {
        index: usize,
        count: usize,
    },
    /// A face refers to an index that may be defined later in the file.
    Later,
}

impl Fault {
    /// Converts to an error with the file and the line of the statement.
    pub(super) fn of_line(self, file: &Path, line: u64) -> SceneError {
        let file = file.to_owned();
        let reason = match self {
            Self::Index { index, count } => {
                let part = format!("a corner of line {line}");
                return SceneError::IndexOutOfRange {
                    file,
                    part,
                    index,
                    count,
                    target: "vertices",
                };
            }
            Self::Text(reason) => reason,
            Self::Later => "it names something that does not exist".to_owned(),
        };
        SceneError::Malformed { file, part: format!("line {line}"), reason }
    }
}

impl From<String> for Fault {
    fn from(reason: String) -> Self {
        Self::Text(reason)
    }
}
