//! Fenced blocks of a document, and the comments about them.

/// Fenced block of a page.
pub struct Block<'a> {
    /// Line number of the opening fence, from 1.
    pub line: usize,
    /// Language after the opening fence.
    pub language: &'a str,
    /// Text between the opening and the closing fence.
    pub text: &'a str,
    /// Reason why the block is not run, from an HTML comment `<!-- not run: REASON -->` on the line
    /// above. `None` if it is run.
    pub not_run: Option<&'a str>,
    /// Whether a heading separates this block from the previous one.
    pub begins_section: bool,
}

/// Returns all fenced blocks of a page in order.
///
/// # Panics
/// Panics if a fence is not closed, or if no block of commands follows a `not run`.
pub fn blocks(page: &str) -> Vec<Block<'_>> {
    let mut blocks = Vec::new();
    let mut open: Option<(usize, &str, usize, Option<&str>)> = None;
    let (mut at, mut begins_section, mut not_run) = (0, false, None);
    for (number, line) in (1..).zip(page.split_inclusive('\n')) {
        let start = at;
        at += line.len();
        let line = line.trim();
        if let Some(language) = line.strip_prefix("```") {
            match open.take() {
                None => open = Some((number, language, at, not_run.take())),
                Some((line, language, from, not_run)) => {
                    blocks.push(Block {
                        line,
                        language,
                        text: &page[from..start],
                        not_run,
                        begins_section,
                    });
                    begins_section = false;
                }
            }
        } else if open.is_none() {
            assert!(
                not_run.is_none(),
                "line {number}: `not run` stands above no block"
            );
            not_run = line
                .strip_prefix("<!-- not run: ")
                .and_then(|line| line.strip_suffix(" -->"));
            begins_section |= line.starts_with('#');
        }
    }
    assert!(
        open.is_none() && not_run.is_none(),
        "the page ends too early"
    );
    for block in &blocks {
        let commands = block.language == "sh";
        assert!(
            commands || block.not_run.is_none(),
            "line {}: `not run` before a block without commands",
            block.line
        );
    }
    blocks
}

/// Shell command in a block.
pub struct Command<'a> {
    /// Text of the command, of one or more lines.
    pub text: &'a str,
    /// Expected exit status, from a comment after the command. The default is 0.
    pub status: i32,
}

/// Returns the commands of a block. A command has as many lines as the shell requires. `is_whole`
/// returns whether the shell accepts a text as complete.
pub fn commands(block: &str, is_whole: impl Fn(&str) -> bool) -> Vec<Command<'_>> {
    let mut commands = Vec::new();
    let (mut from, mut at) = (0, 0);
    for line in block.split_inclusive('\n') {
        at += line.len();
        let text = block[from..at].trim();
        let continues = text.ends_with('\\') || !is_whole(text);
        if continues && at < block.len() {
            continue;
        }
        from = at;
        if !text.is_empty() && !text.starts_with('#') {
            let comment = text.rsplit_once(" # ").map_or("", |(_, comment)| comment);
            let status = comment.split_once("exit status ").map(|(_, rest)| {
                let digits = rest.split(|it: char| !it.is_ascii_digit()).next();
                digits.unwrap_or_default().parse().expect("a number")
            });
            commands.push(Command {
                text,
                status: status.unwrap_or(0),
            });
        }
    }
    commands
}
