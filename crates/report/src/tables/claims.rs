//! Tables of tested claims.
use serde_json::{Value, json};
use stochc_experiments::{ClaimedQuantity, TestedClaim, Verdict};
use stochc_runtime::Model;
use stochc_text::{TextColumn, TextTable, number, paragraph};

/// A tested claim of a program.
#[derive(Clone, Debug)]
pub struct ReportedClaim {
    /// Name of the program.
    pub program: String,
    /// The claim as text.
    pub claim: String,
    /// Result of the test.
    pub tested: TestedClaim,
    /// Model of the runs.
    pub model: Model,
}

impl ReportedClaim {
    /// Returns the claim as JSON. Infinite limits are null.
    pub fn to_json(&self) -> Value {
        let TestedClaim {
            verdict,
            quantity,
            estimate,
            limits: (low, high),
            runs,
            cpu,
        } = &self.tested;
        json!({
            "program": self.program,
            "claim": self.claim,
            "verdict": verdict,
            "quantity": quantity,
            "estimate": estimate,
            "low": low,
            "high": high,
            "runs": runs,
            "cpu_seconds": cpu,
            "model": self.model.name(),
        })
    }

    /// Returns a value of the claimed quantity as text.
    fn value(&self, value: f64) -> String {
        if value.is_infinite() {
            return if value > 0.0 { "∞" } else { "-∞" }.to_owned();
        }
        match self.tested.quantity {
            ClaimedQuantity::Probability => format!("{value:.3}"),
            ClaimedQuantity::Mean => number(value),
            ClaimedQuantity::Difference => format!("{:.1} %", 100.0 * value),
        }
    }
}

/// Returns a table of claims for each program. `width` is the width of the terminal
/// \[characters\].
pub fn claims_to_text(claims: &[ReportedClaim], width: usize) -> String {
    let mut text = String::new();
    for claims in claims.chunk_by(|a, b| a.program == b.program) {
        if !text.is_empty() {
            text.push('\n');
        }
        text += &table(claims).text(width, false);
    }
    text.push('\n');
    text + &paragraph(&summary(claims), width)
}

fn table(claims: &[ReportedClaim]) -> TextTable {
    let column = |show: &dyn Fn(&ReportedClaim) -> String| claims.iter().map(show).collect();
    let verdict = |it: &ReportedClaim| match it.tested.verdict {
        Verdict::Holds => "holds".to_owned(),
        Verdict::Fails => "FAILS".to_owned(),
        Verdict::Undecided => "undecided".to_owned(),
    };
    let estimate = |it: &ReportedClaim| it.tested.estimate.map_or("?".to_owned(), |x| it.value(x));
    let limits = |it: &ReportedClaim| {
        let (low, high) = it.tested.limits;
        format!("{} to {}", it.value(low), it.value(high))
    };
    let cpu = |it: &ReportedClaim| {
        it.tested
            .cpu
            .map_or("?".to_owned(), |s| format!("{s:.2} s"))
    };
    TextTable {
        label: claims[0].program.clone(),
        labels: column(&|it| it.claim.clone()),
        columns: vec![
            TextColumn::words("", column(&verdict)),
            TextColumn::figures("estimate", column(&estimate)),
            TextColumn::figures("limits", column(&limits)),
            TextColumn::figures("runs", column(&|it| it.tested.runs.to_string())),
            TextColumn::figures("CPU time", column(&cpu)),
            TextColumn::words("model", column(&|it| it.model.name().to_owned())),
        ],
        red: Vec::new(),
    }
}

fn summary(claims: &[ReportedClaim]) -> String {
    let count = |verdict| {
        claims
            .iter()
            .filter(|it| it.tested.verdict == verdict)
            .count()
    };
    let [holds, fails, undecided] = [Verdict::Holds, Verdict::Fails, Verdict::Undecided].map(count);
    format!("{holds} hold, {fails} fail, {undecided} undecided.")
}
