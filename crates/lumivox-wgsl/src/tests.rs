use crate::{ShaderLibrary, parse};

const LIGHT: &str = "import package::grid::{grid, edge};
import package::constants::WIDTH;

// A structure whose member is named like an import.
struct Light { grid: f32, color: vec3f, }

/* A comment of
   two lines. */
fn shade(light: Light) -> f32 {
    return light.grid * edge(grid) + 1e-5 + 0x1fu;
}

@compute @workgroup_size(WIDTH, 2)
fn main(@builtin(position) position: vec3u) {
    let used = shade(Light());
}

fn unused() {}
";

fn library() -> ShaderLibrary {
    let mut library = ShaderLibrary::default();
    library.constant_u32("WIDTH", 8).add("light::one", LIGHT).add(
        "grid",
        "struct Grid { size: f32 }
         @group(0) @binding(0) var<uniform> grid: Grid;
         fn edge(of: Grid) -> f32 { return of.size; }",
    );
    library
}

#[test]
fn linking_keeps_reachable_items_under_unique_names() {
    let linked = library().link("light::one").unwrap();
    let source = &linked.source;
    assert!(source.contains("fn light_one_shade(light: light_one_Light) -> f32 {"), "{source}");
    assert!(
        source.contains("return light.grid * grid_edge(grid_grid) + 1e-5 + 0x1fu;"),
        "{source}"
    );
    assert!(source.contains("struct light_one_Light { grid: f32, color: vec3f, }"), "{source}");
    assert!(source.contains("var<uniform> grid_grid: grid_Grid;"), "{source}");
    assert!(source.contains("@builtin(position) position"), "{source}");
    assert!(source.contains("const WIDTH: u32 = 8u;"), "{source}");
    assert!(!source.contains("unused"), "{source}");
    assert_eq!(linked.entries, [("main".to_owned(), [8, 2, 1])]);
    assert!(library().link_whole("light::one").unwrap().source.contains("light_one_unused"));
}

#[test]
fn linked_lines_map_to_module_lines() {
    let linked = library().link("light::one").unwrap();
    let line = linked.source.lines().position(|line| line.contains("1e-5")).unwrap() as u32 + 1;
    assert_eq!(linked.place_of(line), Some(("light::one", Some(10))));
    assert_eq!(
        LIGHT.lines().nth(9).unwrap().trim(),
        "return light.grid * edge(grid) + 1e-5 + 0x1fu;"
    );
}

#[test]
fn built_text_has_no_comments_or_empty_lines() {
    let module = parse("light::one", LIGHT, false).unwrap();
    assert!(
        module.declarations.iter().all(|d| !d.text.contains("comment") && !d.text.contains("\n\n"))
    );
}

#[test]
fn errors_name_module_and_line() {
    let message = |source: &str| {
        library().add("mine", source).link_whole("mine").map(drop).unwrap_err().to_string()
    };
    let cases = [
        (
            "import package::gird::grid;\nfn f() { _ = grid; }",
            "`package::gird`, and there is no such module",
        ),
        (
            "import package::grid::gird;\nfn f() { _ = gird; }",
            "imports `gird` from `package::grid`",
        ),
        ("import package::constants::HEIGHT;\nfn f() { _ = HEIGHT; }", "no constant `HEIGHT`"),
        ("import grid::grid;", "line 1: an import starts with `package::`"),
        ("import package::grid;", "line 1: `grid` is a module"),
        ("import package::grid::grid as g;", "line 1: `::`, `,` or `;` is missing before `as`"),
        ("import package::grid\nimport package::a::b;", "line 2: `::`, `,` or `;` is missing"),
        ("import package:grid grid;", "line 1: `::`, `,` or `;` is missing before `grid`"),
        ("fn f() {}\n/* /* */ fn g() {}", "line 2: `/*` is not closed"),
        (
            "import package::grid::edge;\nfn f() {\n let grid_edge = 1; }",
            "line 3: `grid_edge` is what",
        ),
        (
            "@compute @workgroup_size(8 * 8) fn f() {}",
            "line 1: the workgroup size `8*8` is neither",
        ),
        ("import package::grid::{grid, grid};", "line 1: `grid` is imported twice"),
        ("\nfn f() {\n    g(;\n}\n", "line 4: unexpected `}`"),
        ("fn f() {}\n\nfn f() {}", "line 3: `f` is declared or imported twice"),
        ("fn f() {\n", "line 1: `{` is not closed"),
        ("const A = 1u", "line 1: this declaration has no end"),
        ("fun f() {}", "line 1: `fun` starts no declaration"),
        ("fn () {}", "line 1: a name is missing after `fn`"),
        ("var<private> read: u32;", "line 1: `read` is a word of WGSL"),
        ("fn f() {\n    _ = package::grid::grid;\n}", "line 2: a path in code"),
        ("@compute @workgroup_size(N + 1) fn f() {}", "line 1: the workgroup size `N+1`"),
    ];
    for (source, expected) in cases {
        let message = message(source);
        assert!(
            message.starts_with("shader mine: ") && message.contains(expected),
            "{source}\n{message}"
        );
    }
    let missing = library().link("mine").unwrap_err();
    assert_eq!(missing.to_string(), "shader mine: there is no such module");
}

#[test]
fn directives_come_first_and_nested_imports_are_found() {
    let mut library = library();
    library.add("a::b", "enable f16;\nfn c() {}\n");
    library.add(
        "root",
        "import package::{a::b::c, grid::{edge, grid}};
const_assert 1 < 2;
@vertex fn v() { c(); _ = edge(grid); }",
    );
    let linked = library.link("root").unwrap();
    assert!(linked.source.starts_with("enable f16 ;\n"), "{}", linked.source);
    assert!(linked.source.contains("const_assert 1 < 2;"));
    assert!(linked.source.contains("a_b_c(); _ = grid_edge(grid_grid);"));
    assert_eq!(linked.entries, [("v".to_owned(), [0; 3])]);
    let line = linked.source.lines().position(|line| line.contains("@vertex")).unwrap() as u32 + 1;
    assert_eq!(linked.place_of(line), Some(("root", Some(3))));
}

#[test]
fn float_constants_keep_their_bits() {
    for value in [0.1, 1024.0, 1e-30, f32::MAX, -std::f32::consts::PI] {
        let mut library = ShaderLibrary::default();
        library.constant_f32("A", value);
        library.add("root", "import package::constants::A;\nfn f() -> f32 { return A; }");
        let source = library.link_whole("root").unwrap().source;
        let text = source.strip_prefix("const A: f32 = ").unwrap().split("f;").next().unwrap();
        assert_eq!(text.parse::<f32>().unwrap().to_bits(), value.to_bits(), "{source}");
    }
}

#[test]
fn libraries_are_equal_by_content() {
    assert!(library() == library());
    let mut other = library();
    other.constant_u32("WIDTH", 16);
    assert!(library() != other);
}

#[test]
fn a_slot_module_missing_an_item_is_blamed() {
    let mut caller =
        parse("caller", "import package::slot::part;\nfn f() { part(); }", false).unwrap();
    caller.is_built = true;
    let mut library = ShaderLibrary::default();
    library.add_built(Vec::leak(vec![caller])).add("slot", "fn other() {}");
    let error = library.link_whole("caller").unwrap_err().to_string();
    let expected =
        "shader slot: it does not declare `part`, which `package::caller` imports from it";
    assert_eq!(error, expected);
}

#[test]
fn workgroup_sizes_may_use_numbers_and_constants() {
    for (size, expected) in [
        ("64", [64, 1, 1]),
        ("0x8u, 4,", [8, 4, 1]),
        ("A, WIDTH, 2u", [16, 8, 2]),
        ("B", [16, 1, 1]),
    ] {
        let source = format!(
            "import package::constants::WIDTH;
            const A:u32=16; const B = A;
            @compute @workgroup_size({size}) fn main() {{ let workgroup_size = A * B * WIDTH; }}"
        );
        let entries = library().add("mine", source).link("mine").unwrap().entries;
        assert_eq!(entries, [("main".to_owned(), expected)], "{size}");
    }
    let mut library = library();
    let vertex = library.add("v", "@vertex fn v() { let workgroup_size = f32(2.0); }");
    assert_eq!(vertex.link("v").unwrap().entries, [("v".to_owned(), [0; 3])]);
}

#[test]
fn comments_separate_words_and_byte_order_marks_are_skipped() {
    let module = parse("m", "\u{feff}fn f() { return/* x */b; }", false).unwrap();
    assert_eq!(module.declarations[0].text, "fn m_f() { return b; }");
}
