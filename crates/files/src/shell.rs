//! Quoting for shell commands.

/// Returns a word for scripts of any POSIX shell, quoted if necessary.
pub fn quoted(word: &str) -> String {
    let plain = |sign: char| sign.is_ascii_alphanumeric() || "_-./:=+,@%".contains(sign);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Returns a word for copying into an interactive shell. It is quoted like [`quoted`], but control
/// characters are escaped to keep it on one line.
///
/// bash, zsh and ksh accept the form `$'...'`. `/bin/sh` may not.
pub fn visible(word: &str) -> String {
    if !word.chars().any(|sign| sign.is_ascii_control()) {
        return quoted(word);
    }
    let spelled = word.chars().map(|sign| match sign {
        '\'' | '\\' => format!("\\{sign}"),
        _ if sign.is_ascii_control() => format!("\\{:03o}", u32::from(sign)),
        _ => sign.to_string(),
    });
    format!("$'{}'", spelled.collect::<String>())
}

/// Returns a file path as an argument of a displayed command. A path that begins with `-` gets the
/// prefix `./`, so that it is not an option.
pub fn file(path: &str) -> String {
    if path.starts_with('-') {
        visible(&format!("./{path}"))
    } else {
        visible(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_only_if_needed() {
        assert_eq!(quoted("results/five_tower"), "results/five_tower");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("it's\ta\\b\n"), "'it'\\''s\ta\\b\n'");
        assert_eq!(visible("it's\ta\\b\n"), r"$'it\'s\011a\\b\012'");
        assert_eq!(visible("it's"), quoted("it's"));
        assert_eq!(file("-rf"), "./-rf");
    }
}
