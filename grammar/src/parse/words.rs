//! Names of grammar rules for messages.
use super::Rule;
use super::open_block::{OpenBlock, OpenBlockContent};

/// Returns the phrase for a rule in messages. Returns `None` for rules that messages do not
/// mention.
pub fn word(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::chain | Rule::seat | Rule::instance => "a statement",
        Rule::place => "a block",
        Rule::name | Rule::word => "a name",
        Rule::arrow => "`->`",
        Rule::expr | Rule::integer => "a whole number",
        Rule::range => "a range such as `1..4`",
        Rule::delay | Rule::time => "a time",
        Rule::quantity | Rule::number | Rule::span_of_values => "a value with its unit",
        Rule::string => "a file name in quotation marks",
        Rule::code => "the code of a warning",
        Rule::row => "a row of `#` and `.`",
        Rule::argument => "an argument",
        Rule::subject => "a block to wait for",
        Rule::index | Rule::bracket_open => "`[`",
        Rule::bracket_close => "`]`",
        Rule::paren_open => "`(`",
        Rule::paren_close => "`)`",
        Rule::comma => "`,`",
        Rule::dots => "`..`",
        Rule::equals => "`=`",
        Rule::times => "`x`",
        Rule::open => "`{`",
        Rule::close => "`}`",
        Rule::point => "`at`",
        Rule::after | Rule::kw_after => "`after`",
        Rule::kw_as => "`as`",
        Rule::kw_at => "`at`",
        Rule::kw_from => "`from`",
        Rule::kw_in => "`in`",
        Rule::kw_mirrored => "`mirrored`",
        Rule::turned | Rule::kw_turned => "`turned`",
        Rule::kw_plate => "`plate`",
        Rule::kw_timeout => "`timeout`",
        Rule::aggregate | Rule::kw_aggregate => "`aggregate`",
        Rule::kw_to => "`to`",
        Rule::assembly_head | Rule::kw_assembly => "`assembly`",
        Rule::condition => "a condition such as `n > 2`",
        Rule::condition_operator => "a comparison such as `>`",
        Rule::kw_by => "`by`",
        Rule::kw_captured => "`captured`",
        Rule::kw_complete => "`complete`",
        Rule::kw_completion => "`completion`",
        Rule::kw_else => "`else`",
        Rule::expect | Rule::kw_expect => "`expect`",
        Rule::kw_faster => "`faster`",
        Rule::kw_mean => "`mean`",
        Rule::kw_probability => "`probability`",
        Rule::kw_than => "`than`",
        Rule::kw_with => "`with`",
        Rule::kw_within => "`within`",
        Rule::relation => "`>=` or `<=`",
        Rule::for_head | Rule::kw_for => "`for`",
        Rule::if_head | Rule::kw_if => "`if`",
        Rule::import | Rule::kw_import => "`import`",
        Rule::kw_least => "`least`",
        Rule::layer_head | Rule::kw_layer => "`layer`",
        Rule::let_ | Rule::kw_let => "`let`",
        Rule::pattern_head | Rule::kw_pattern => "`pattern`",
        Rule::handler_head | Rule::kw_on => "`on timeout`",
        Rule::retry | Rule::kw_retry => "`retry`",
        Rule::wait | Rule::kw_wait => "`wait`",
        Rule::phase_head | Rule::kw_phase => "`phase`",
        Rule::release | Rule::kw_release => "`release`",
        Rule::scene_head | Rule::kw_scene => "`scene`",
        Rule::seed_head | Rule::kw_seed => "`seed`",
        Rule::shape_head | Rule::kw_shape => "`shape`",
        Rule::yields | Rule::kw_yields => "`yields`",
        _ => return None,
    })
}

/// Returns the keywords that can begin a statement in the innermost open block.
pub fn beginnings(frame: Option<&OpenBlock>) -> &'static [&'static str] {
    use crate::tree::ItemKind;
    let Some(frame) = frame else {
        return &[
            "`assembly`",
            "`aggregate`",
            "`pattern`",
            "`shape`",
            "`scene`",
            "`let`",
            "`import`",
        ];
    };
    match &frame.content {
        OpenBlockContent::Items(item) => match item.kind {
            ItemKind::Assembly(_) => &[
                "`seed`",
                "`phase`",
                "`expect`",
                "`let`",
                "`for`",
                "`if`",
                "a pattern",
                "`}`",
            ],
            ItemKind::Handler(_) => &["`release`", "`wait`", "`retry`", "`}`"],
            ItemKind::Seed(_) => &[
                "a seed such as `A at (0, 0)`",
                "a pre-attached block such as `A.up -> E`",
                "`for`",
                "`if`",
                "a pattern",
                "`}`",
            ],
            _ => &[
                "a capture such as `A.up -> E`",
                "`release`",
                "`for`",
                "`if`",
                "`let`",
                "a pattern",
                "`}`",
            ],
        },
        OpenBlockContent::Scene(..) | OpenBlockContent::SceneBlock(_) => {
            &["a name", "a value", "`}`"]
        }
        OpenBlockContent::Shape(_) => &["`layer`", "`}`"],
        OpenBlockContent::Layer(_) => &["a row of `#` and `.`", "`}`"],
        OpenBlockContent::Broken(_) => &["a statement", "`}`"],
    }
}

/// Returns the word or sign at a byte, shortened for messages. Returns an empty text at the end of
/// the file.
pub fn found(text: &str, at: usize) -> &str {
    const MAX: usize = 24;
    let rest = &text[at..];
    let mut chars = rest.char_indices();
    let Some((_, first)) = chars.next() else {
        return "";
    };
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    if !is_word(first) {
        let twins = ["->>", "->", "..", "///", "//"];
        return twins
            .into_iter()
            .find(|sign| rest.starts_with(sign))
            .unwrap_or(&rest[..first.len_utf8()]);
    }
    let end = chars
        .take(MAX)
        .take_while(|&(_, c)| is_word(c))
        .last()
        .map_or(first.len_utf8(), |(i, c)| i + c.len_utf8());
    &rest[..end]
}
