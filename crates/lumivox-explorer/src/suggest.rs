//! What was meant, where a name is wrong.

/// Names must be this alike, of 1, to be suggested.
const ALIKE: f64 = 0.7;

/// How alike names of three letters and more are that one letter too many, too few, another or swapped tells apart.
const ONE_SLIP: f64 = 0.9;

/// The known name that is most like a wrong one, by Jaro and Winkler's measure (Winkler 1990) or by a single slip
/// (Damerau 1964), whatever the case; `None` where nothing is like it.
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

/// What to do about a wrong name, to follow what is wrong: the name like it, or the command that lists all.
pub fn remedy<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>, lister: &str) -> String {
    match like(wrong, known) {
        Some(like) => format!("; did you mean \"{like}\"?"),
        None => format!("; `{lister}` lists them"),
    }
}
