/// A program that cannot be run; its findings say why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wrong;

impl std::fmt::Display for Wrong {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("the program is wrong; see its findings")
    }
}

impl std::error::Error for Wrong {}
