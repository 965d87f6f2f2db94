//! Tables of tested claims.
use serde_json::{Value, json};
use stochc_experiments::{ClaimMethod, ClaimedQuantity, TestedClaim, Verdict};
use stochc_runtime::Model;
use stochc_text::{TextColumn, TextTable, counted, number, paragraph};

/// A tested claim of a program.
#[derive(Clone, Debug)]
pub struct ReportedClaim {
    /// Name of the program.
    pub program: String,
    /// File of the program. `None` for a program in compiled form.
    pub file: Option<String>,
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
            method,
        } = &self.tested;
        json!({
            "program": self.program,
            "file": self.file,
            "claim": self.claim,
            "verdict": verdict,
            "quantity": quantity,
            "estimate": estimate,
            "low": low,
            "high": high,
            "runs": runs,
            "cpu_seconds": cpu,
            "model": self.model.name(),
            "method": method,
        })
    }

    /// Returns the estimate, the limits and the number of runs as text.
    pub fn evidence(&self) -> String {
        let runs = counted(self.tested.runs as usize, "run");
        format!(
            "estimate {}, limits {}, {runs}, model {}",
            self.estimate(),
            self.limits(),
            self.method()
        )
    }

    fn method(&self) -> String {
        let method = match self.tested.method {
            ClaimMethod::Runs => "",
            ClaimMethod::Convolution => ", no runs",
        };
        format!("{}{method}", self.model.name())
    }

    fn estimate(&self) -> String {
        let estimate = self.tested.estimate;
        estimate.map_or("?".to_owned(), |value| self.value(value))
    }

    fn limits(&self) -> String {
        let (low, high) = self.tested.limits;
        format!("{} to {}", self.value(low), self.value(high))
    }

    /// Returns a value of the claimed quantity as text.
    fn value(&self, value: f64) -> String {
        if value.is_infinite() {
            return if value > 0.0 { "∞" } else { "-∞" }.to_owned();
        }
        match self.tested.quantity {
            ClaimedQuantity::Probability => probability(value),
            ClaimedQuantity::Mean => number(value),
            ClaimedQuantity::Difference => format!("{:.1} %", 100.0 * value),
        }
    }
}

/// Returns a probability as text with at least three decimals. A probability near 0 or 1 has two
/// digits of its distance from 0 or 1.
fn probability(value: f64) -> String {
    /// Largest number of decimals.
    const MOST: usize = 12;
    let distance = value.min(1.0 - value);
    let decimals = if distance > 0.0 {
        1.0 - distance.log10().floor()
    } else {
        0.0
    };
    let decimals = (decimals as usize).clamp(3, MOST);
    format!("{value:.decimals$}")
}

/// Returns a table of claims for each program. `width` is the width of the terminal
/// \[characters\].
pub fn claims_to_text(all: &[ReportedClaim], width: usize) -> String {
    let mut text = String::new();
    for (label, claims) in claims_by_program(all) {
        if !text.is_empty() {
            text.push('\n');
        }
        text += &table(claims, &label).text(width, false);
    }
    text.push('\n');
    text + &paragraph(&summary(all), width)
}

/// Returns the claims of each program, with a label of the program.
pub fn claims_by_program(
    all: &[ReportedClaim],
) -> impl Iterator<Item = (String, &[ReportedClaim])> {
    let claims = all.chunk_by(|a, b| (&a.program, &a.file) == (&b.program, &b.file));
    claims.map(|claims| (label(&claims[0], all), claims))
}

/// Returns the name of a claim's program, with its file if another file has a program of this name.
fn label(claim: &ReportedClaim, all: &[ReportedClaim]) -> String {
    let is_other = |it: &ReportedClaim| it.program == claim.program && it.file != claim.file;
    match &claim.file {
        Some(file) if all.iter().any(is_other) => format!("{} ({file})", claim.program),
        _ => claim.program.clone(),
    }
}

fn table(claims: &[ReportedClaim], label: &str) -> TextTable {
    let column = |show: &dyn Fn(&ReportedClaim) -> String| claims.iter().map(show).collect();
    let verdict = |it: &ReportedClaim| match it.tested.verdict {
        Verdict::Holds => "holds".to_owned(),
        Verdict::Fails => "FAILS".to_owned(),
        Verdict::Undecided => "undecided".to_owned(),
    };
    let cpu = |it: &ReportedClaim| match it.tested.cpu {
        Some(seconds) => format!("{seconds:.2} s"),
        None if it.tested.method == ClaimMethod::Convolution => String::new(),
        None => "?".to_owned(),
    };
    TextTable {
        label: label.to_owned(),
        labels: column(&|it| it.claim.clone()),
        columns: vec![
            TextColumn::words("", column(&verdict)),
            TextColumn::figures("estimate", column(&ReportedClaim::estimate)),
            TextColumn::figures("limits", column(&ReportedClaim::limits)),
            TextColumn::figures("runs", column(&|it| it.tested.runs.to_string())),
            TextColumn::figures("CPU time", column(&cpu)),
            TextColumn::words("model", column(&ReportedClaim::method)),
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

#[cfg(test)]
mod tests {
    use super::probability;

    #[test]
    fn small_probabilities_have_two_digits() {
        let cases = [
            (0.5, "0.500"),
            (0.0, "0.000"),
            (1.0, "1.000"),
            (0.012_34, "0.012"),
            (0.000_123, "0.00012"),
            (0.999_987_6, "0.999988"),
        ];
        for (value, text) in cases {
            assert_eq!(probability(value), text);
        }
    }
}
