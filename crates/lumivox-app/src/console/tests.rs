use super::*;

#[test]
fn names_are_unique() {
    let mut names: Vec<&str> = COMMANDS
        .iter()
        .flat_map(|c| [c.name].into_iter().chain(c.aliases.iter().copied()))
        .collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}
