//! A line, split into words.

/// A line that cannot be split.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a quotation mark is open at the end of the line; close it, or write \\\" for the mark itself"
)]
pub struct LineError;

/// The words of a line as a shell would split them; none for a comment.
///
/// # Errors
/// [`LineError`].
pub fn split(line: &str) -> Result<Vec<String>, LineError> {
    shlex::split(line).ok_or(LineError)
}
