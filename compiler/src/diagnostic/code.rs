use serde::{Serialize, Serializer};

/// Severity of a diagnostic. Errors come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The program cannot be run.
    Error,
    /// The program can be run, but a part of it is probably a mistake.
    Warning,
}

impl Severity {
    /// Returns the word at the start of messages.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}

/// Declares all codes, grouped by topic, with their severities, names and pages.
macro_rules! codes {
    ($($topic:literal { $($severity:ident $variant:ident $name:literal)* })*) => {
        /// The kind of a diagnostic.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[allow(missing_docs, reason = "every code has a page of its own, printed by `explain`")]
        pub enum Code {
            $($($variant,)*)*
        }

        impl Code {
            /// All codes, grouped by topic.
            pub const ALL: &'static [Code] = &[$($(Code::$variant,)*)*];

            /// All topics with their codes.
            pub const TOPICS: &'static [(&'static str, &'static [Code])] =
                &[$(($topic, &[$(Code::$variant,)*]),)*];

            /// Returns the name for messages and `stochc explain`.
            pub const fn name(self) -> &'static str {
                match self { $($(Code::$variant => $name,)*)* }
            }

            /// Returns the default severity. The file or the command line can change it.
            pub const fn severity(self) -> Severity {
                match self { $($(Code::$variant => Severity::$severity,)*)* }
            }

            /// Returns the page of the code, in Markdown.
            pub const fn page(self) -> &'static str {
                match self {
                    $($(Code::$variant => include_str!(concat!("pages/", $name, ".md")),)*)*
                }
            }
        }
    };
}

codes! {
    "Source text" {
        Error NotUtf8 "not-utf8"
        Error FileTooLarge "file-too-large"
        Error Syntax "syntax"
        Error UnclosedBrace "unclosed-brace"
        Error MissingBrace "missing-brace"
        Error StrayBrace "stray-brace"
        Error Misplaced "misplaced"
        Error ReservedWord "reserved-word"
        Error NumberTooLarge "number-too-large"
        Error TooDeep "too-deep"
        Error StatementTooLong "statement-too-long"
        Error DanglingDoc "dangling-doc"
    }
    "Imports" {
        Error ImportMissing "import-missing"
        Error ImportOutside "import-outside"
        Error ImportCycle "import-cycle"
    }
    "Names, faces and numbers" {
        Error UnknownName "unknown-name"
        Error DuplicateName "duplicate-name"
        Error WrongKind "wrong-kind"
        Error WrongArguments "wrong-arguments"
        Error FaceMisused "face-misused"
        Error MissingFace "missing-face"
        Error RangeMisused "range-misused"
        Error Arithmetic "arithmetic"
        Error RecursivePattern "recursive-pattern"
        Error ExpansionLimit "expansion-limit"
        Warning UnusedLet "unused-let"
        Warning UnusedPattern "unused-pattern"
    }
    "Captures, releases and their order" {
        Error MissingPlate "missing-plate"
        Error SeedOutsidePlate "seed-outside-plate"
        Error CapturedTwice "captured-twice"
        Error ReleasedTwice "released-twice"
        Error ReleasedAbsent "released-absent"
        Error ReleasedSeed "released-seed"
        Error AbsentBlock "absent-block"
        Error Cycle "cycle"
        Error InvalidHandler "invalid-handler"
        Warning RedundantAfter "redundant-after"
        Warning EmptyPhase "empty-phase"
        Warning UnusedSeed "unused-seed"
        Warning ShortTimeout "short-timeout"
    }
    "Cells and access" {
        Error OutOfPlane "out-of-plane"
        Error EmbeddedFace "embedded-face"
        Error AnchoringFace "anchoring-face"
        Error BelowPlate "below-plate"
        Error OccupiedCell "occupied-cell"
        Error Adrift "adrift"
        Error SealedCavity "sealed-cavity"
        Warning TightApproach "tight-approach"
        Warning CrowdedCaptures "crowded-captures"
        Warning ReachUndecided "reach-undecided"
        Warning UnplannedBond "unplanned-bond"
        Warning BlockedRelease "blocked-release"
    }
    "Claims" {
        Error WrongClaim "wrong-claim"
    }
    "Shapes" {
        Error ShapeMismatch "shape-mismatch"
        Error ShapeMalformed "shape-malformed"
        Warning UnusedShape "unused-shape"
    }
    "Scenes" {
        Error UnknownScene "unknown-scene"
        Error UnknownTerm "unknown-term"
        Error MissingTerm "missing-term"
        Error DuplicateTerm "duplicate-term"
        Error ConflictingTerms "conflicting-terms"
        Error WrongDimension "wrong-dimension"
        Error WrongValue "wrong-value"
        Warning UnusedScene "unused-scene"
    }
    "Programs in their scenes" {
        Error TooFewBlocks "too-few-blocks"
        Warning TooManyBlocks "too-many-blocks"
        Error OutsideEnclosure "outside-enclosure"
        Error CannotAggregate "cannot-aggregate"
        Warning OverloadedBond "overloaded-bond"
        Warning BuoyantBlocks "buoyant-blocks"
        Warning NoAgitation "no-agitation"
        Warning CoarseStep "coarse-step"
        Warning SoftContact "soft-contact"
        Warning StokesDrag "stokes-drag"
    }
    "Levels of warnings" {
        Error UnknownCode "unknown-code"
        Error MissingReason "missing-reason"
        Error FixedLevel "fixed-level"
        Warning UnusedAllow "unused-allow"
    }
    "The compiler" {
        Error TooManyErrors "too-many-errors"
        Warning TooManyWarnings "too-many-warnings"
        Error InternalError "internal-error"
    }
}

impl Code {
    /// Returns the meaning of the code in one line: the title of its page without the name.
    pub fn meaning(self) -> &'static str {
        let title = self.page().lines().next().unwrap_or_default();
        title.split_once(": ").map_or(title, |(_, meaning)| meaning)
    }

    /// Returns whether the diagnostic depends on the time step of the runs.
    pub fn is_of_runs(self) -> bool {
        matches!(
            self,
            Code::BuoyantBlocks
                | Code::NoAgitation
                | Code::CoarseStep
                | Code::SoftContact
                | Code::StokesDrag
        )
    }

    /// Returns whether the diagnostic is about source without an effect.
    pub fn is_unnecessary(self) -> bool {
        matches!(
            self,
            Code::UnusedSeed
                | Code::RedundantAfter
                | Code::EmptyPhase
                | Code::UnusedLet
                | Code::UnusedPattern
                | Code::UnusedShape
                | Code::UnusedScene
                | Code::UnusedAllow
        )
    }

    /// Returns the code name that is closest to an unknown name. Returns `None` if no name is
    /// close.
    pub fn nearest(name: &str) -> Option<&'static str> {
        let known = Code::ALL.iter().map(|code| code.name());
        stochc_text::suggest::nearest(name, known)
            .and_then(|suggestion| Code::from_name(&suggestion.word).map(Code::name))
    }

    /// Returns the code with a name. Returns `None` if the name is unknown.
    pub fn from_name(name: &str) -> Option<Code> {
        Code::ALL.iter().copied().find(|code| code.name() == name)
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Code {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
