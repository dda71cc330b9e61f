use proptest::prelude::*;

use super::*;

fn read_text(text: &str) -> Result<(Block<'_>, Vec<String>), String> {
    let mut notes = Notes::default();
    let read = read(Path::new("a.scene"), text, &mut notes);
    read.map(|(block, _)| (block, notes.warnings)).map_err(|error| error.to_string())
}

/// `key=word` and `key{...}`, without places.
fn short(block: &Block<'_>) -> String {
    let entry = |entry: &Entry<'_>| match &entry.value {
        Value::Word(word) => format!("{}={}", entry.key.text, word.text),
        Value::Block(block) => format!("{}{{{}}}", entry.key.text, short(block)),
    };
    block.entries.iter().map(entry).collect::<Vec<_>>().join(" ")
}

#[test]
fn names_have_values_or_blocks() {
    let text = "scene { name = room\nmodel {\n} light = { color { r = 1, } } }";
    let (block, warnings) = read_text(text).unwrap();
    assert_eq!(short(&block), "scene{name=room model{} light{color{r=1,}}}");
    assert_eq!(warnings, [""; 0]);
    let Value::Block(scene) = &block.entries[0].value else { panic!("no block") };
    assert_eq!(scene.at, Place { line: 1, column: 7 });
    assert_eq!(scene.entries[1].key.at, Place { line: 2, column: 1 });
}

#[test]
fn stray_tokens_are_ignored_with_a_warning() {
    let (block, warnings) = read_text("oh scene { dear name = a b\n c= d={ } }").unwrap();
    assert_eq!(short(&block), "scene{name=a}");
    let expected = [
        "1:1: \"oh\" was ignored: neither `=` nor `{` follows it",
        "1:12: \"dear\" was ignored: neither `=` nor `{` follows it",
        "1:26: \"b\" was ignored: neither `=` nor `{` follows it",
        "2:2: \"c=\" was ignored: `=`, `{` and `}` need white space around them",
        "2:5: \"d={\" was ignored: `=`, `{` and `}` need white space around them",
        "2:11: \"}\" was ignored: no block is open there",
    ];
    assert_eq!(warnings, expected);
    let words = "word ".repeat(1000);
    let (block, warnings) = read_text(&words).unwrap();
    assert_eq!(block.entries, []);
    assert_eq!(warnings.len(), MOST_STRAYS + 1);
    assert_eq!(warnings[MOST_STRAYS], "980 more stray tokens were ignored");
}

#[test]
fn errors_name_place_found_token_and_expectation() {
    for (text, message) in [
        ("scene {", "a.scene:1:8: found the end of the file, expected `}` for the `{` at 1:7"),
        (
            "scene {\n a {\n } \n",
            "a.scene:4:1: found the end of the file, expected `}` for the `{` at 1:7",
        ),
        ("a =", "a.scene:1:4: found the end of the file, expected a value for \"a\""),
        ("a = }", "a.scene:1:5: found `}`, expected a value for \"a\""),
        ("a = = b", "a.scene:1:5: found `=`, expected a value for \"a\""),
        ("= b", "a.scene:1:1: found `=`, expected a name before it, such as `name =`"),
        ("a = b = c", "a.scene:1:7: found `=`, expected a name before it, such as `name =`"),
        ("scene\n{ { } }", "a.scene:2:3: found `{`, expected a name before it, such as `model {`"),
    ] {
        assert_eq!(read_text(text).unwrap_err(), message, "{text}");
    }
}

#[test]
fn excessive_nesting_and_entries_are_refused() {
    let fault = read_text(&"a { ".repeat(1_000_000)).unwrap_err();
    assert!(fault.starts_with("a.scene:1:131: found a block within 32 others"), "{fault}");
    let deepest = format!("{}{}", "a { ".repeat(DEEPEST), "} ".repeat(DEEPEST));
    assert!(read_text(&deepest).is_ok());
    let fault = read_text(&"a = b ".repeat(MOST_ENTRIES + 1)).unwrap_err();
    assert!(fault.contains("found name 1048577 of the file, expected at most 1048576"), "{fault}");
    // Long tokens are shortened in messages.
    let long = "x".repeat(1 << 20);
    let (_, warnings) = read_text(&long).unwrap();
    assert!(warnings[0].len() < 200);
    assert!(read_text(&format!("{long} = }}")).unwrap_err().len() < 200);
}

/// A tree without places.
#[derive(Clone, Debug, PartialEq)]
enum Node {
    Word(String, String),
    Block(String, Vec<Node>),
}

fn word() -> impl Strategy<Value = String> {
    let any = any::<String>().prop_map(|text| {
        text.chars().filter(|&c| !super::super::token::is_space(c) && c != '\u{feff}').collect()
    });
    prop_oneof!["[a-z_]{1,9}", "-?[0-9.]{1,5}f?,?", any]
        .prop_filter("a sign", |word: &String| !matches!(word.as_str(), "" | "=" | "{" | "}"))
}

fn nodes() -> impl Strategy<Value = Vec<Node>> {
    let leaf = (word(), word()).prop_map(|(key, value)| Node::Word(key, value));
    let node = leaf.prop_recursive(5, 60, 6, |inner| {
        (word(), prop::collection::vec(inner, 0..6)).prop_map(|(key, all)| Node::Block(key, all))
    });
    prop::collection::vec(node, 0..6)
}

/// Appends random white space, and returns a random bit.
fn space(seed: &mut u64, text: &mut String) -> bool {
    // Knuth 1998, "The art of computer programming", volume 2, section 3.3.4, table 1.
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
    text.push_str([" ", "\n", "\t \r\n", "\u{b}", "\r", "\u{c}  "][(*seed >> 33) as usize % 6]);
    (*seed >> 40).is_multiple_of(2)
}

/// Writes a tree.
fn print(nodes: &[Node], seed: &mut u64, text: &mut String) {
    for node in nodes {
        match node {
            Node::Word(key, value) => {
                text.push_str(key);
                space(seed, text);
                text.push('=');
                space(seed, text);
                text.push_str(value);
            }
            Node::Block(key, all) => {
                text.push_str(key);
                if space(seed, text) {
                    text.push('=');
                    space(seed, text);
                }
                text.push('{');
                space(seed, text);
                print(all, seed, text);
                text.push('}');
            }
        }
        space(seed, text);
    }
}

fn nodes_of(block: &Block<'_>) -> Vec<Node> {
    let node = |entry: &Entry<'_>| match &entry.value {
        Value::Word(word) => Node::Word(entry.key.text.to_owned(), word.text.to_owned()),
        Value::Block(block) => Node::Block(entry.key.text.to_owned(), nodes_of(block)),
    };
    block.entries.iter().map(node).collect()
}

proptest! {
    #[test]
    fn printed_trees_round_trip(nodes in nodes(), mut seed in any::<u64>()) {
        let mut text = String::new();
        print(&nodes, &mut seed, &mut text);
        let (block, warnings) = read_text(&text).unwrap();
        prop_assert_eq!(nodes_of(&block), nodes);
        prop_assert!(warnings.is_empty());
    }

    #[test]
    fn any_text_is_a_tree_or_an_error(text in any::<String>(), words in "([a-c]|=|\\{|\\}| |\n){0,60}") {
        for text in [text, words] {
            let _ = read_text(&text);
        }
    }
}
