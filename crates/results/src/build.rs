//! Which build of `stochc` made a run.
//!
//! A version number changes with a release, what a run makes of its tables and its scene with every change of the
//! protocol, the rates or the runtime. A build is told from others by a digest of their sources, which is the same on every
//! machine. What the compiler makes of a text is in the manifest.

/// The digest of this build: 16 hexadecimal digits.
pub fn this_build() -> String {
    let sources = [
        stochc_ir::SOURCES,
        stochc_estimate::SOURCES,
        stochc_control::SOURCES,
        stochc_runtime::SOURCES,
    ];
    let mut digest = stochc_ir::sha256(&sources);
    digest.truncate(16);
    digest
}

/// What is to be said where this build makes runs that belong to those of others, or makes them again;
/// `None`: there are no others.
pub fn other_build(builds: &[String]) -> Option<String> {
    let this = this_build();
    let other = builds.iter().find(|&build| *build != this)?;
    Some(format!(
        "these runs were made by another build of `stochc` ({other}, and this is {this}); what \
         is run now may come out differently"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_another_build_is_told_of() {
        let this = this_build();
        assert_eq!(this.len(), 16);
        assert_eq!(other_build(std::slice::from_ref(&this)), None);
        let told = other_build(&[this, "0123456789abcdef".into()]).unwrap();
        assert!(told.contains("(0123456789abcdef, and this is"), "{told}");
    }
}
