//! Suggestions for misspelt names.

/// The least similarity of a suggestion, 0 to 1.
const ALIKE: f64 = 0.7;

/// The similarity of names of three or more letters that differ by one slip: an additional, missing
/// or wrong letter, or two letters swapped.
const ONE_SLIP: f64 = 0.9;

/// The known name most similar to a wrong one, by the measure of Jaro and Winkler (Winkler 1990) or
/// by a single slip (Damerau 1964), ignoring case; `None` if none is similar.
pub fn like<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let wrong = wrong.to_lowercase();
    let alike = |name: &str| {
        let name = name.to_lowercase();
        let has_one_slip = wrong.len() >= 3 && strsim::damerau_levenshtein(&wrong, &name) <= 1;
        let alike = strsim::jaro_winkler(&wrong, &name);
        if has_one_slip { alike.max(ONE_SLIP) } else { alike }
    };
    known
        .into_iter()
        .map(|name| (alike(name), name))
        .filter(|(alike, _)| *alike >= ALIKE)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, name)| name.to_owned())
}

/// The remedy for a wrong name, as the end of an error message: a similar name, or the command that
/// lists all.
pub fn remedy<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>, lister: &str) -> String {
    match like(wrong, known) {
        Some(like) => format!("; did you mean \"{like}\"?"),
        None => format!("; `{lister}` lists them"),
    }
}
