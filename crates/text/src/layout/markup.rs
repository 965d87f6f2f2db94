//! Tables and sentences for papers and web pages: Markdown and LaTeX.
use crate::TextTable;

/// A markup language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Markup {
    /// GitHub Flavored Markdown.
    Markdown,
    /// LaTeX with the package `booktabs`.
    Latex,
}

impl Markup {
    /// Escapes text for the markup language.
    pub fn text(self, text: &str) -> String {
        let escape = |letter: char| match self {
            Markup::Markdown => in_markdown(letter),
            Markup::Latex => in_latex(letter),
        };
        text.chars().map(escape).collect()
    }

    /// Returns a sentence as a paragraph. A `~`, which marks a non-breaking space, becomes an
    /// ordinary space.
    pub fn paragraph(self, sentence: &str) -> String {
        let sentence = sentence.replace('~', " ");
        format!("\n{}\n", self.text(&sentence))
    }

    /// Returns a table. Its first column has the labels.
    pub fn table(self, table: &TextTable) -> String {
        let header = row(&table.label, table.columns.iter().map(|it| &it.header));
        let lines = (table.labels.iter().enumerate())
            .map(|(i, label)| row(label, table.columns.iter().map(|it| &it.cells[i])));
        let rows: Vec<Vec<String>> = [header].into_iter().chain(lines).collect();
        match self {
            Markup::Markdown => self.markdown(&rows),
            Markup::Latex => self.latex(&rows),
        }
    }

    fn markdown(self, rows: &[Vec<String>]) -> String {
        let line = |row: &Vec<String>| {
            let cells: Vec<String> = row.iter().map(|cell| self.text(cell)).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut lines = rows.iter().map(line);
        let header = lines.next().unwrap_or_default();
        let columns = rows.first().map_or(0, Vec::len);
        let rule = format!("|---|{}\n", "--:|".repeat(columns.saturating_sub(1)));
        header + &rule + &lines.collect::<String>()
    }

    fn latex(self, rows: &[Vec<String>]) -> String {
        let line = |row: &Vec<String>| {
            let cells: Vec<String> = row.iter().map(|cell| self.text(cell)).collect();
            format!("{} \\\\\n", cells.join(" & "))
        };
        let mut lines = rows.iter().map(line);
        let header = lines.next().unwrap_or_default();
        let columns = rows.first().map_or(0, Vec::len);
        format!(
            "\\begin{{tabular}}{{l{}}}\n\\toprule\n{header}\\midrule\n{}\\bottomrule\n\\end{{tabular}}\n",
            "r".repeat(columns.saturating_sub(1)),
            lines.collect::<String>()
        )
    }
}

fn row<'a>(label: &str, cells: impl Iterator<Item = &'a String>) -> Vec<String> {
    let cells = cells.cloned();
    [label.to_owned()].into_iter().chain(cells).collect()
}

fn in_markdown(letter: char) -> String {
    match letter {
        '|' | '_' | '*' | '`' | '<' | '>' | '[' | ']' | '\\' => format!("\\{letter}"),
        '\n' => " ".to_owned(),
        letter => letter.to_string(),
    }
}

fn in_latex(letter: char) -> String {
    let macro_or_sign = match letter {
        '&' => "\\&",
        '%' => "\\%",
        '$' => "\\$",
        '#' => "\\#",
        '_' => "\\_",
        '{' => "\\{",
        '}' => "\\}",
        '~' => "\\textasciitilde{}",
        '^' => "\\textasciicircum{}",
        '\\' => "\\textbackslash{}",
        '<' => "$<$",
        '>' => "$>$",
        '±' => "$\\pm$",
        '≥' => "$\\geq$",
        '−' => "$-$",
        '–' => "--",
        '\n' => " ",
        letter => return letter.to_string(),
    };
    macro_or_sign.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TextColumn;

    #[test]
    fn special_characters_are_escaped() {
        let table = TextTable {
            label: String::new(),
            labels: vec!["mean [s]".to_owned()],
            columns: vec![TextColumn::figures("a_b|c", vec!["≥ 1 ± 2 %".to_owned()])],
            ..TextTable::default()
        };
        assert_eq!(
            Markup::Markdown.table(&table),
            "|  | a\\_b\\|c |\n|---|--:|\n| mean \\[s\\] | ≥ 1 ± 2 % |\n"
        );
        let latex = Markup::Latex.table(&table);
        let rows = " & a\\_b|c \\\\\n\\midrule\nmean [s] & $\\geq$ 1 $\\pm$ 2 \\% \\\\\n";
        assert!(latex.contains(rows), "{latex}");
        assert!(
            latex.starts_with("\\begin{tabular}{lr}\n\\toprule\n"),
            "{latex}"
        );
        assert_eq!(
            Markup::Latex.paragraph("p~=~0.05 in a_b."),
            "\np = 0.05 in a\\_b.\n"
        );
    }
}
