//! Files of another kind than their names say: archives, web pages, pointers.

/// The kind of a file that is neither a scene nor a picture, by its first bytes, with a remedy.
pub(crate) fn what(bytes: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 4] = [
        (b"PK\x03\x04", "it is a ZIP archive; unpack it, and give the file that is in it"),
        (b"\x1f\x8b", "it is compressed by gzip; unpack it"),
        (
            b"version https://git-lfs",
            "it is a pointer of Git LFS in the place of the file; fetch the file with: git lfs pull",
        ),
        (b"\xfd7zXZ", "it is compressed by xz; unpack it"),
    ];
    let begins = KINDS.iter().find(|(begin, _)| bytes.starts_with(begin));
    let text = bytes.trim_ascii_start();
    let is_page = ["<!doctype html", "<html"].iter().any(|begin| {
        text.get(..begin.len()).is_some_and(|start| start.eq_ignore_ascii_case(begin.as_bytes()))
    });
    let page = "it is a web page, perhaps an error instead of a download; download the file itself";
    begins.map(|(_, kind)| *kind).or(is_page.then_some(page))
}
