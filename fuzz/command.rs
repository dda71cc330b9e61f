//! Lines of the console: what is split, quoted and read as a value.
//!
//! The console's parser is taken in as a file; it needs nothing else. The values of
//! settings are read by another.

#[allow(dead_code)]
#[path = "../crates/lumivox-console/src/line.rs"]
mod line;
#[allow(dead_code)]
#[path = "../crates/lumivox/src/settings/value.rs"]
mod value;

use value::{Choice, Kind, Value};

const KINDS: [Kind; 6] = [
    Kind::Switch,
    Kind::Whole { low: 16, high: 1024, multiple: 8 },
    Kind::Number { low: -64.0, high: 64.0, words: &["auto", "auto-each"], off: None },
    Kind::Number { low: 0.1, high: 1.0, words: &[], off: Some(0.0) },
    Kind::Vector { low: 0.0, below: 1.0 },
    Kind::Choice(&[Choice::new("dense", ""), Choice::new("octree", "")]),
];

/// Runs one input.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // Completion looks at lines that are not finished.
    let begun = line::commands(text);
    for word in begun.iter().flatten() {
        assert!(text.get(word.range.clone()).is_some_and(|part| !part.is_empty()));
    }
    let split = match line::split(text) {
        Ok(split) => split,
        Err(error) => {
            let marked = text.chars().nth(error.column - 1);
            assert_eq!(marked, Some(error.mark), "{error}");
            return;
        }
    };
    assert_eq!(split, begun);
    for words in &split {
        // A command by itself is the same command, and so are its words when they are quoted.
        let alone = line::split(line::text(text, words)).expect("its marks are closed");
        assert_eq!(texts(&alone), [texts(std::slice::from_ref(words)).concat()]);
        let quoted: Vec<String> = words.iter().map(|word| line::quote(&word.text)).collect();
        let again = line::split(&quoted.join(" ")).expect("quotes close");
        assert_eq!(texts(&again), texts(std::slice::from_ref(words)));
        for word in words {
            for kind in KINDS {
                read(kind, &word.text);
            }
        }
    }
}

/// A value that is read is written so that it is read again, and what is allowed lies in the range.
fn read(kind: Kind, text: &str) {
    let Some(value) = kind.parse(text, "") else { return };
    assert_eq!(kind.parse(&value.to_string(), ""), Some(value), "{text}");
    if let (true, Value::Number(number)) = (kind.allows(value), value) {
        assert!(number.is_finite());
    }
}

fn texts(commands: &[line::Words]) -> Vec<Vec<String>> {
    let texts = |words: &line::Words| words.iter().map(|word| word.text.clone()).collect();
    commands.iter().map(texts).collect()
}
