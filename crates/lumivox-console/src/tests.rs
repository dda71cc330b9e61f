use glam::Vec3;

use super::arguments::{angle, degrees, number, toggled, vector};
use super::complete::complete;
use super::line::{commands, quote, split};
use super::*;

#[test]
fn names_are_unique() {
    let mut names: Vec<&str> = COMMANDS.iter().flat_map(Command::names).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn every_command_has_summary_usage_and_example() {
    for command in COMMANDS.iter() {
        let name = command.name;
        assert!(command.summary.len() > 10 && !command.summary.ends_with('.'), "{name}");
        assert!(command.details().is_empty() || command.details().ends_with('.'), "{name}");
        let example = split(command.example).unwrap();
        let [words] = example.as_slice() else { panic!("{name} has no example") };
        assert!(command.names().any(|known| known == words[0].text), "{name}: {}", command.example);
        assert!(command.counts().contains(&(words.len() - 1)), "{name}: {}", command.example);
        assert_eq!(command.usage.is_empty(), command.count == (0, 0), "{name}");
    }
}

/// A command with a setting's name also sets it.
#[test]
fn no_command_hides_a_setting_of_the_same_name() {
    let takes_a_value = |command: &Command| command.counts() == (0..=1);
    let shadowed: Vec<&str> = lumivox_explorer::parameters::PARAMETERS
        .iter()
        .filter(|parameter| Command::find(parameter.name).is_some_and(|c| !takes_a_value(c)))
        .map(|parameter| parameter.name)
        .collect();
    assert!(shadowed.is_empty(), "commands hide the settings {shadowed:?}");
}

fn words(line: &str) -> Vec<Vec<String>> {
    let commands = split(line).unwrap();
    commands.into_iter().map(|words| words.into_iter().map(|word| word.text).collect()).collect()
}

#[test]
fn lines_are_split_into_commands_and_words() {
    assert_eq!(words("  a  b\tc "), [["a", "b", "c"]]);
    assert_eq!(words("a 'b c' \"d \\\" \\\\ \\n\""), [["a", "b c", "d \" \\ \\n"]]);
    assert_eq!(words("a;b ; 'c;d';;"), [["a"], ["b"], ["c;d"]]);
    assert_eq!(words("a # b ; c"), [["a"]]);
    assert_eq!(words("a#b"), [["a#b"]]);
    assert_eq!(words("a b\\c"), [["a", "b\\c"]]);
    assert_eq!(words("a # c\nb"), [["a"], ["b"]]);
    assert_eq!(words("pre'fix'ed \"\""), [["prefixed", ""]]);
    assert!(words("# only a comment").is_empty());
    assert!(words(" ; ;").is_empty());
    let error = split("é 'b").unwrap_err();
    assert_eq!((error.mark, error.column), ('\'', 3));
    assert_eq!(split("a \"b\" \"c").unwrap_err().column, 7);
    assert_eq!(split("echo \"a\\\"b ").unwrap_err().column, 6);
}

#[test]
fn quoting_round_trips_words() {
    for word in [
        "a",
        "",
        "a b",
        "it's",
        "it's \"b\" \\",
        "#a",
        "a;b",
        "\\",
        "a\\",
        "'",
        "\"",
        "a\nb",
        "\x1b[31m\"red\"\\",
        "\u{9b}\u{202e}\\u{1b}",
        "\\u{1b} '",
        "é ü",
    ] {
        let line = format!("x {} y", quote(word));
        assert_eq!(words(&line), [["x", word, "y"]], "{line}");
    }
    assert_eq!(quote("scenes/a.glb"), "scenes/a.glb");
    // Names from files are quoted in printable characters.
    assert_eq!(quote("\x1b[2J\n"), "\"\\u{1b}[2J\\u{a}\"");
    for kept in ["\\u{}", "\\u{110000}", "\\u{d800}", "\\u{1b", "\\u1b", "\\n", "\\u{+1b}"] {
        assert_eq!(words(&format!("\"{kept}\"")), [[kept]], "{kept}");
    }
}

#[test]
fn a_words_range_covers_its_source_text() {
    let line = "a 'b c';d";
    let ranges: Vec<&str> =
        commands(line).into_iter().flatten().map(|word| &line[word.range]).collect();
    assert_eq!(ranges, ["a", "'b c'", "d"]);
}

#[test]
fn numbers_are_read_within_their_range() {
    assert_eq!(number("0.5", "it", 0.0..=1.0).unwrap(), 0.5);
    for text in ["1.1", "-1", "NaN", "inf", "a", "", "0.5 "] {
        let error = number(text, "it", 0.0..=1.0).unwrap_err().to_string();
        assert!(error.contains("it is a number from 0 to 1"), "{error}");
    }
    assert_eq!(vector(&["1,2", "3"], "it", -5.0..=5.0).unwrap(), Vec3::new(1.0, 2.0, 3.0));
    assert!(vector(&["1", "2"], "it", -5.0..=5.0).is_err());
    assert!(toggled(&[], "it", false).unwrap());
    assert!(!toggled(&["off"], "it", false).unwrap());
    assert!(toggled(&["maybe"], "it", false).is_err());
}

#[test]
fn angles_round_trip_through_degrees_bit_exactly() {
    let mut bits = 1_u32;
    for _ in 0..2000 {
        bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let angle_rad = 3.0 * (bits as f32 / u32::MAX as f32);
        let text = degrees(angle_rad);
        let back = angle(&text, "it", -360.0..=360.0).unwrap();
        assert_eq!(back.to_bits(), angle_rad.to_bits(), "{text}");
    }
    assert_eq!(degrees(45.0_f32.to_radians()), "45");
}

fn names() -> Names {
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    Names {
        objects: names(&["tall block", "floor", "fan"]),
        materials: names(&["red", "it's"]),
        scenes: names(&["builtin:cornell", "hall"]),
        ..Names::default()
    }
}

fn completed(line: &str) -> (usize, Vec<String>) {
    let files = |start: &str| {
        let all = ["a.png", "b.glb", "dir/"];
        all.iter().filter(|name| name.starts_with(start)).map(|name| (*name).to_owned()).collect()
    };
    let completion = complete(&names(), &files, line, line.len());
    (completion.start, completion.candidates)
}

#[test]
fn completion_offers_words_valid_at_the_cursor() {
    let strings = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    assert_eq!(completed("transl"), (0, strings(&["translate"])));
    assert_eq!(completed("echo a; transl"), (8, strings(&["translate"])));
    assert_eq!(completed("translate f"), (10, strings(&["floor", "fan"])));
    assert_eq!(completed("translate t"), (10, strings(&["'tall block'"])));
    assert_eq!(completed("translate 'tall b"), (10, strings(&["'tall block'"])));
    assert_eq!(completed("translate floor "), (16, strings(&["x", "y", "z"])));
    assert_eq!(completed("material i"), (9, strings(&["\"it's\""])));
    assert_eq!(completed("material red rough"), (13, strings(&["roughness"])));
    assert_eq!(completed("volume o"), (7, strings(&["octree"])));
    assert_eq!(completed("exposure "), (9, strings(&["auto", "auto-each"])));
    assert_eq!(completed("volume octree "), (14, vec![]));
    assert_eq!(completed("screenshot a"), (11, strings(&["a.png"])));
    assert_eq!(completed("load "), (5, strings(&["builtin:cornell", "hall", "b.glb", "dir/"])));
    assert_eq!(completed("voxs o"), (5, strings(&["on", "off"])));
    assert_eq!(completed("help transl"), (5, strings(&["translate"])));
    assert_eq!(completed("quit "), (5, vec![]));
    assert_eq!(completed("nothing x"), (8, vec![]));
    assert_eq!(completed("echo # tr").1, Vec::<String>::new());
    let all = completed("").1;
    assert!(all.contains(&"bounces".to_owned()) && all.contains(&"translate".to_owned()));
    // Text after the cursor is not part of the word.
    let completion = complete(&names(), &|_| vec![], "transl and more", 6);
    assert_eq!((completion.start, completion.candidates), (0, strings(&["translate"])));
}

#[test]
fn script_commands_carry_file_and_line() {
    let lines = script("a\n# b\n\nc; d # e\n", "file").unwrap();
    let seen: Vec<_> = lines.iter().map(|line| (line.text.as_str(), line.place.as_str())).collect();
    assert_eq!(seen, [("a", "file:1"), ("c", "file:4"), ("d", "file:4")]);
    let error = script("a\n'b", "file").unwrap_err().to_string();
    assert!(error.starts_with("file:2: "), "{error}");
}

#[test]
fn script_lines_run_first_and_are_dropped_on_error() {
    let mut queue = Queue::default();
    queue.add("run it", "");
    queue.add("last", "");
    assert_eq!(queue.take().unwrap().text, "run it");
    queue.interpose(script("a\nb", "it").unwrap()).unwrap();
    assert_eq!(queue.take().unwrap().text, "a");
    queue.abandon();
    assert_eq!(queue.take().unwrap().text, "last");
    assert_eq!(queue.take(), None);
    queue.add("run it", "");
    let depth = std::iter::repeat_with(|| {
        queue.take();
        queue.interpose(script("run it", "it").unwrap())
    });
    assert_eq!(depth.take_while(Result::is_ok).count(), 16);
}

#[test]
fn a_scene_with_defaults_is_written_without_options() {
    let opening = SceneRequest::plain(SceneSource::named("builtin:cornell"), 1.5);
    assert_eq!(commands::files::line(&opening, Some(1.5)), "builtin:cornell");
    assert_eq!(commands::files::line(&opening, Some(2.0)), "builtin:cornell --aspect 1.5");
}
