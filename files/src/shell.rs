//! Commands that can be copied into a shell.

/// A word as a POSIX shell reads it, in quotes where it needs them, and with control characters by their numbers.
pub fn quoted(word: &str) -> String {
    let plain = |sign: char| sign.is_ascii_alphanumeric() || "_-./:=+,@%".contains(sign);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    if word.chars().any(char::is_control) {
        let spelled = word.chars().map(|sign| match sign {
            '\'' | '\\' => format!("\\{sign}"),
            _ if sign.is_ascii_control() => format!("\\{:03o}", u32::from(sign)),
            _ => sign.to_string(),
        });
        return format!("$'{}'", spelled.collect::<String>());
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// An argument that names a file: never taken for an option.
pub fn file(path: &str) -> String {
    if path.starts_with('-') {
        quoted(&format!("./{path}"))
    } else {
        quoted(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_needs_them_gets_quotes() {
        assert_eq!(quoted("results/five_tower"), "results/five_tower");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("it's\ta\\b\n"), r"$'it\'s\011a\\b\012'");
        assert_eq!(file("-rf"), "./-rf");
    }
}
