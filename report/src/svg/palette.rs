//! Colours as classes, for light and for dark.

/// Colours of things that are compared; told apart by the commonest kinds of colour blindness too.
const COLOURS: usize = 6;

/// Dashes of their lines, so that colour is never the only difference.
pub(crate) const DASHES: [&str; COLOURS] = ["", "7 3", "2 3", "9 3 2 3", "4 4", "1 4"];

/// What a picture needs to be shown alone. `s0` to `s5` are the compared ones.
pub(crate) const STYLE: &str = "\
.paper{fill:#fcfcfa}.ink{fill:#222}.dim{fill:#5c5c5c}.axis{stroke:#666}.grid{stroke:#e2e2de}\
.mark{stroke:#222}.grey{fill:#d0d0ca}.faint{stroke:none;opacity:.45}.halo{stroke:#fcfcfa;stroke-width:3;paint-order:stroke}.rest{fill:#9a9a96;stroke:#9a9a96}.hot{fill:#b5303a;stroke:#b5303a}.bar{stroke:none}\
.s0{fill:#1f6fb5;stroke:#1f6fb5}.s1{fill:#b85a00;stroke:#b85a00}.s2{fill:#1d7f58;stroke:#1d7f58}\
.s3{fill:#8646a6;stroke:#8646a6}.s4{fill:#6b6f1a;stroke:#6b6f1a}.s5{fill:#a2376b;stroke:#a2376b}\
.curve{fill:none;stroke-width:1.8}.band{stroke:none;opacity:.16}.word{stroke:none}\
@media screen and (prefers-color-scheme:dark){\
.paper{fill:#15171c}.ink{fill:#e8e8e4}.dim{fill:#a9adb4}.axis{stroke:#a0a4ab}.grid{stroke:#2c3038}\
.mark{stroke:#e8e8e4}.grey{fill:#3a3f48}.faint{stroke:none}.halo{stroke:#15171c}.rest{fill:#767b84;stroke:#767b84}.hot{fill:#ff7a83;stroke:#ff7a83}\
.s0{fill:#6db3f2;stroke:#6db3f2}.s1{fill:#f0a050;stroke:#f0a050}.s2{fill:#5fcf9a;stroke:#5fcf9a}\
.s3{fill:#c79be3;stroke:#c79be3}.s4{fill:#cfd06a;stroke:#cfd06a}.s5{fill:#f08ab8;stroke:#f08ab8}\
.curve{fill:none}.bar,.band,.word{stroke:none}}";

/// The class of number `i` of what is compared.
pub(crate) fn class(i: usize) -> &'static str {
    ["s0", "s1", "s2", "s3", "s4", "s5"][i % COLOURS]
}
