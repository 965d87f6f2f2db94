//! Generator of docs/reference/diagnostics.md: every diagnostic, with its message and a program
//! that causes it.
use std::fmt::Write as _;

use stochc::compiler::diagnostic::{Code, Diagnostic, Renderer, Severity};
use stochc::compiler::{Checked, FileId, Limits, Reader, Sources, Span, check};
use stochc::ir::table::{Action, Tables};
use stochc_grammar::{SyntaxError, SyntaxErrorKind};

const PAGE: &str = "docs/reference/diagnostics.md";

const HEAD: &str = "\
# Diagnostics

This page lists every error and warning of stochc, grouped by topic. Each entry shows a program that causes the
diagnostic, and the message. `stochc explain CODE` explains a diagnostic in more detail and shows a corrected program. A
program with errors cannot be run. Warnings can be [allowed or denied](language.md#warnings).

stochc tests a fix before it offers it: it applies the fix in memory and checks the program again. The fix is safe if
its diagnostic disappears and no new one appears. `stochc check --fix` applies safe fixes. A *possible fix* has not
passed this test, or it is one of several fixes. If a program has more than two million bytes and events, all its fixes
are possible fixes.

*This page is generated from the pages of `stochc explain` and the messages of the compiler.*
";

/// Program that causes a diagnostic, with the conditions of its check.
struct Sample {
    /// Files of the program. The first file is checked.
    files: Vec<(&'static str, Vec<u8>)>,
    /// Source to print on the page. `None` if it is the first file.
    shown: Option<&'static str>,
    /// Limits on the size of the program.
    limits: Limits,
    /// Whether the tables of the program are corrupted before the test.
    corrupted: bool,
}

/// Files of a sample, in the folder `/home/you/towers`.
struct SampleFolder<'a>(&'a [(&'static str, Vec<u8>)]);

impl Reader for SampleFolder<'_> {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        let file = self.0.iter().find(|(name, _)| *name == path);
        file.map(|(_, text)| text.clone())
            .ok_or_else(|| std::io::Error::other("No such file or directory (os error 2)"))
    }

    fn outside(&mut self, path: &str) -> Option<String> {
        path.starts_with('/').then(|| "/home/you/towers".to_owned())
    }
}

impl Sample {
    fn from_text(text: impl Into<Vec<u8>>) -> Sample {
        Sample {
            files: vec![("tower.sa", text.into())],
            shown: None,
            limits: Limits::default(),
            corrupted: false,
        }
    }

    fn shown(mut self, text: &'static str) -> Sample {
        self.shown = Some(text);
        self
    }

    fn check(&self) -> Checked {
        let mut folder = SampleFolder(&self.files);
        let mut checked = check(self.files[0].0, &mut folder, self.limits);
        if self.corrupted {
            for program in &mut checked.programs {
                program.tables = program.tables.as_ref().map(without_notifications);
            }
            stochc::compiler::model_check::try_out(&mut checked);
        }
        checked
    }

    fn text(&self) -> String {
        if let Some(shown) = self.shown {
            return shown.to_owned();
        }
        let parts = self.files.iter().map(|(name, text)| {
            let text = String::from_utf8(text.clone()).unwrap();
            match self.files.len() {
                1 => text,
                _ => format!("// {name}\n{text}"),
            }
        });
        parts.collect::<Vec<_>>().join("\n")
    }
}

/// Source of a small hall. A hall that exceeds the default limits would fill the page.
const TUNNEL: &str = "\
// shown for a search of no cells at all: two million are allowed
assembly tunnel {
    seed plate 3 x 3 {
        for y in 0..2 {
            W[y] at (0, y)
            E[y] at (2, y)
        }
        M at (1, 1)
    }
    phase shell {
        for y in 0..2 {
            W[y].up -> A[y].up -> B[y].east -> R[y]
            E[y].up -> F[y]
        }
    }
    phase core { M.up -> CORE }
}
";

/// Returns tables without messages, as an error of the compiler could produce them.
fn without_notifications(tables: &Tables) -> Tables {
    let duties = tables.duties().map(|duty| {
        let rules = duty.rules().map(|rule| (rule.when.to_vec(), rule.then));
        let rules = rules.filter(|(_, then)| !matches!(then, Action::Notify { .. }));
        (duty.role, duty.phase, duty.trigger, rules.collect())
    });
    Tables::assemble(
        tables.assembly.clone(),
        tables.faces,
        tables.plate.clone(),
        tables.phases.clone(),
        tables.roles.clone(),
        duties.collect(),
    )
}

/// Returns the sample program for a code. Returns `None` if no program can cause the diagnostic.
fn sample(code: Code) -> Option<Sample> {
    if let Some((_, rest)) = code.page().split_once("\nWrong:\n\n```sa\n") {
        return Some(Sample::from_text(
            rest.split("```").next().unwrap_or_default(),
        ));
    }
    Some(match code {
        Code::FileTooLarge => return None,
        Code::NotUtf8 => Sample::from_text(b"let width = 3 // caf\xe9\n").shown(
            "let width = 3 // caf\u{fffd}     the last byte is E9: the text is in Latin-1\n",
        ),
        Code::TooDeep => {
            let depth = 101;
            Sample::from_text(format!(
                "let n = {}1{}\n",
                "(".repeat(depth),
                ")".repeat(depth)
            ))
        }
        Code::StatementTooLong => {
            let mut text = "assembly tower {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase grow {\n        M".to_owned();
            let mut number = 0;
            while text.len() < 9 << 20 {
                number += 1;
                write!(text, ".up -> T{number}").unwrap();
            }
            text.push_str("\n    }\n}\n");
            Sample::from_text(text).shown(
                "assembly tower {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase grow {\n        \
                 M.up -> T1.up -> T2.up -> T3     and so on, for nine million bytes\n    }\n}\n",
            )
        }
        Code::TooManyErrors => {
            let text = format!("let n = 1\n{}", "?\n".repeat(101));
            Sample::from_text(text).shown("let n = 1\n?\n?\n?     and so on, 101 lines\n")
        }
        Code::TooManyWarnings => {
            let text = |seeds: &str| {
                format!(
                    "assembly tower {{\n    seed plate 1001 x 2 {{\n        M at (0, 0)\n        {seeds}\n    }}\n    \
                     phase grow {{ M.up -> A }}\n}}\n"
                )
            };
            let seeds: Vec<String> = (0..1001).map(|i| format!("N{i} at ({i}, 1)")).collect();
            Sample::from_text(text(&seeds.join(" "))).shown(
                "assembly tower {\n    seed plate 1001 x 2 {\n        M at (0, 0)\n        \
                 N0 at (0, 1) N1 at (1, 1)     and so on, 1001 seeds\n    }\n    \
                 phase grow { M.up -> A }\n}\n",
            )
        }
        Code::ReachUndecided => {
            let mut sample = Sample::from_text(TUNNEL);
            sample.limits.search = 0;
            sample
        }
        Code::InternalError => {
            let mut sample = Sample::from_text(
                "// shown for tables without any messages between blocks\n\
                 assembly relay {\n    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }\n    \
                 phase grow {\n        M.up -> A\n        N.up -> B after A\n    }\n}\n",
            );
            sample.corrupted = true;
            sample
        }
        Code::ImportOutside => Sample::from_text("import \"/etc/passwd\"\n"),
        Code::ImportMissing => Sample::from_text("import \"towers.sa\"\n"),
        Code::ImportCycle => Sample {
            files: vec![
                ("plates.sa", b"import \"towers.sa\"\n".to_vec()),
                ("towers.sa", b"import \"plates.sa\"\n".to_vec()),
            ],
            shown: None,
            limits: Limits::default(),
            corrupted: false,
        },
        other => panic!("`{other}` has no wrong program on its page, and none here"),
    })
}

/// Returns the messages of the diagnostics with this code, as `check` draws them.
fn messages(code: Code, diagnostics: &[Diagnostic], sources: &Sources) -> String {
    let renderer = Renderer::new(false, 80);
    let ours = diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.code == code);
    let drawn: Vec<String> = ours
        .map(|diagnostic| renderer.render(diagnostic, sources))
        .collect();
    let lines = drawn.iter().flat_map(|text| text.trim_end().lines());
    lines.map(|line| format!("{}\n", line.trim_end())).collect()
}

fn gallery() -> String {
    let mut page = HEAD.to_owned();
    for (topic, codes) in Code::TOPICS {
        let links = codes.iter().map(|code| format!("[{code}](#{code})"));
        let links: Vec<String> = links.collect();
        write!(page, "\n## {topic}\n\n{}\n", links.join(" · ")).unwrap();
        for &code in *codes {
            page.push_str(&entry(code));
        }
    }
    page
}

fn entry(code: Code) -> String {
    let kind = match code.severity() {
        Severity::Error => "Error",
        Severity::Warning => "Warning",
    };
    let mut text = format!("\n### {code}\n\n{kind}: {}.\n", code.meaning());
    let messages = match sample(code) {
        Some(sample) => {
            write!(text, "\n```sa\n{}```\n", sample.text()).unwrap();
            let checked = sample.check();
            messages(code, &checked.diagnostics, &checked.sources)
        }
        None => {
            let error = SyntaxError {
                kind: SyntaxErrorKind::FileTooLarge,
                span: Span::default(),
            };
            let diagnostic = Diagnostic::from_syntax(FileId(0), &error, "");
            messages(code, &[diagnostic], &Sources::default())
        }
    };
    assert!(
        !messages.is_empty(),
        "the program of `{code}` does not have it"
    );
    write!(text, "\n```text\n{messages}```\n").unwrap();
    text
}

#[test]
fn every_diagnostic_is_in_the_gallery() {
    let page = gallery();
    for &code in Code::ALL {
        assert!(page.contains(&format!("\n### {code}\n")), "{code}");
    }
    crate::pages::assert_page(PAGE, &page);
}
