//! Verdicts about claims as JUnit XML.
use std::time::Duration;

use quick_junit::{NonSuccessKind, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};
use stochc_experiments::Verdict;
use stochc_report::tables::{ReportedClaim, claims_by_program};
use stochc_text::visible;

/// Returns a report with a test suite for each program and a test case for each claim. A failed
/// claim is a failure, and an undecided claim is an error.
///
/// # Errors
/// If the report cannot be written as XML.
pub(super) fn claims_to_junit(claims: &[ReportedClaim]) -> Result<String, SerializeError> {
    let mut report = Report::new("stochc test");
    for (label, claims) in claims_by_program(claims) {
        let mut suite = TestSuite::new(visible(&label));
        suite.add_test_cases(claims.iter().map(test_case));
        report.add_test_suite(suite);
    }
    report.to_string()
}

fn test_case(claim: &ReportedClaim) -> TestCase {
    let status = match claim.tested.verdict {
        Verdict::Holds => TestCaseStatus::success(),
        Verdict::Fails => unsuccessful(claim, NonSuccessKind::Failure, "fails"),
        Verdict::Undecided => unsuccessful(claim, NonSuccessKind::Error, "undecided"),
    };
    let mut case = TestCase::new(visible(&claim.claim), status);
    let file = claim.file.as_deref().unwrap_or(&claim.program);
    case.set_classname(visible(file));
    if let Some(cpu) = claim.tested.cpu {
        case.set_time(Duration::from_secs_f64(cpu));
    }
    case
}

fn unsuccessful(claim: &ReportedClaim, kind: NonSuccessKind, verdict: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(verdict).set_message(claim.evidence());
    status
}
