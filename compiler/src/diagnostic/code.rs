use serde::{Serialize, Serializer};

/// How bad a finding is; the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The program cannot be run.
    Error,
    /// The program can be run, but something in it is probably not meant.
    Warning,
}

/// Declares the codes, with their names, severities and pages.
macro_rules! codes {
    ($($severity:ident $variant:ident $name:literal)*) => {
        /// The kind of a finding.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[allow(missing_docs, reason = "every code has a page of its own, printed by `explain`")]
        pub enum Code {
            $($variant,)*
        }

        impl Code {
            /// Every code, in the order of the stages that find it.
            pub const ALL: &'static [Code] = &[$(Code::$variant,)*];

            /// The name that messages show and `stochc explain` takes.
            pub const fn name(self) -> &'static str {
                match self { $(Code::$variant => $name,)* }
            }

            /// How bad it is, unless the file or the command line says otherwise.
            pub const fn severity(self) -> Severity {
                match self { $(Code::$variant => Severity::$severity,)* }
            }

            /// Its page, in Markdown.
            pub const fn page(self) -> &'static str {
                match self {
                    $(Code::$variant => include_str!(concat!("pages/", $name, ".md")),)*
                }
            }
        }
    };
}

codes! {
    Error NotUtf8 "not-utf8"
    Error FileTooLarge "file-too-large"
    Error Syntax "syntax"
    Error UnclosedBrace "unclosed-brace"
    Error MissingBrace "missing-brace"
    Error StrayBrace "stray-brace"
    Error Misplaced "misplaced"
    Error ReservedWord "reserved-word"
    Error FaceMisused "face-misused"
    Error NumberTooLarge "number-too-large"
    Error TooDeep "too-deep"
    Error StatementTooLong "statement-too-long"
    Error MissingReason "missing-reason"
    Error DanglingDoc "dangling-doc"
    Error TooManyErrors "too-many-errors"

    Error ImportMissing "import-missing"
    Error ImportOutside "import-outside"
    Error ImportCycle "import-cycle"

    Error UnknownName "unknown-name"
    Error DuplicateName "duplicate-name"
    Error WrongKind "wrong-kind"
    Error WrongArguments "wrong-arguments"
    Error MissingFace "missing-face"
    Error RangeMisused "range-misused"
    Error Arithmetic "arithmetic"
    Error RecursivePattern "recursive-pattern"
    Error ExpansionLimit "expansion-limit"
    Error MissingPlate "missing-plate"
    Error SeedOutsidePlate "seed-outside-plate"

    Error CapturedTwice "captured-twice"
    Error ReleasedTwice "released-twice"
    Error ReleasedAbsent "released-absent"
    Error ReleasedSeed "released-seed"
    Error AbsentBlock "absent-block"
    Warning UnusedSeed "unused-seed"
    Warning RedundantAfter "redundant-after"
    Warning EmptyPhase "empty-phase"

    Error Cycle "cycle"

    Error EmbeddedFace "embedded-face"
    Error AnchoringFace "anchoring-face"
    Error BelowPlate "below-plate"
    Error OccupiedCell "occupied-cell"
    Error Adrift "adrift"
    Error SealedCavity "sealed-cavity"
    Warning TightApproach "tight-approach"
    Warning CrowdedCaptures "crowded-captures"
    Warning ReachUndecided "reach-undecided"
    Error ShapeMismatch "shape-mismatch"
    Error ShapeMalformed "shape-malformed"

    Warning UnplannedBond "unplanned-bond"
    Warning BlockedRelease "blocked-release"

    Error TooFewBlocks "too-few-blocks"
    Warning TooManyBlocks "too-many-blocks"
    Error OutsideEnclosure "outside-enclosure"
    Error CannotAggregate "cannot-aggregate"
    Warning BuoyantBlocks "buoyant-blocks"
    Warning NoAgitation "no-agitation"
    Warning CoarseStep "coarse-step"
    Warning SoftContact "soft-contact"
    Warning StokesDrag "stokes-drag"
    Warning ShortTimeout "short-timeout"

    Error InternalError "internal-error"

    Error UnknownScene "unknown-scene"
    Error UnknownTerm "unknown-term"
    Error MissingTerm "missing-term"
    Error DuplicateTerm "duplicate-term"
    Error ConflictingTerms "conflicting-terms"
    Error WrongDimension "wrong-dimension"
    Error WrongValue "wrong-value"

    Warning UnusedLet "unused-let"
    Warning UnusedPattern "unused-pattern"
    Warning UnusedShape "unused-shape"
    Warning UnusedScene "unused-scene"

    Error UnknownCode "unknown-code"
    Error FixedLevel "fixed-level"
    Warning UnusedAllow "unused-allow"
    Warning TooManyWarnings "too-many-warnings"
}

impl Code {
    /// Whether it is about how a scene is simulated. Runs with other steps may not have it.
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

    /// Whether it is about text that the program would do as well without.
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

    /// The name most like one that no code has, if one is near enough.
    pub fn nearest(name: &str) -> Option<&'static str> {
        let known = Code::ALL.iter().map(|code| code.name());
        stochc_ir::suggest::nearest(name, known)
            .and_then(|meant| Code::from_name(&meant.word).map(Code::name))
    }

    /// The code with a name.
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
