//! Identification of the build of `stochc` that made a run.
//!
//! A version number changes only with a release. Results may change with every change of the
//! protocol, the rates or the runtime. A digest of their sources identifies a build, with the same
//! value on every machine. The manifest contains the output of the compiler.

/// Returns the digest of the sources of this build: 16 hexadecimal digits.
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

/// Returns a message if a build other than this one made some of the existing runs. `builds` lists
/// the builds that made them.
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
    fn warns_only_of_other_builds() {
        let this = this_build();
        assert_eq!(this.len(), 16);
        assert_eq!(other_build(std::slice::from_ref(&this)), None);
        let message = other_build(&[this, "0123456789abcdef".into()]).unwrap();
        assert!(
            message.contains("(0123456789abcdef, and this is"),
            "{message}"
        );
    }
}
