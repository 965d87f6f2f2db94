//! Rows of a log, from comma-separated values or JSON Lines.
use std::borrow::Cow;

use csv::StringRecord;
use serde_json::{Map, Value};

use super::error::{LogError, RowError};

/// Largest time \[seconds or ticks\].
const MAX: f64 = 1e15;

/// Columns of a log, and keys of its objects.
const COLUMNS: [&str; 7] = ["run", "seconds", "ticks", "event", "block", "by", "body"];

/// Columns that contain tracked positions.
const POSITIONS: [&str; 3] = ["x", "y", "z"];

/// Message for other JSON than JSON Lines.
const NO_OBJECT: &str = "it is not an object of JSON; JSON Lines have one object per line";

/// Row of a log.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// Line in the log, from 1.
    pub line: u64,
    pub run: u64,
    /// Time \[ticks\], not yet rounded.
    pub ticks: f64,
    pub event: LogEvent,
    /// Block or phase of the event.
    pub block: String,
    /// Face of the capturing block, or the releasing block.
    pub by: String,
    /// Number of the block.
    pub body: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LogEvent {
    Phase,
    Opened,
    Captured,
    Released,
    Rejected,
    Timeout,
    End,
}

impl LogEvent {
    fn from_word(word: &str) -> Option<LogEvent> {
        Some(match word {
            "phase" => LogEvent::Phase,
            "opened" => LogEvent::Opened,
            "captured" => LogEvent::Captured,
            "released" => LogEvent::Released,
            "rejected" => LogEvent::Rejected,
            "timeout" => LogEvent::Timeout,
            "end" => LogEvent::End,
            _ => return None,
        })
    }
}

/// Iterator over the rows of a log.
pub(super) type Rows<'a> = Box<dyn Iterator<Item = Result<Row, LogError>> + Send + 'a>;

/// Returns the rows of a log. A log that begins with `{` is JSON Lines. `tick` is the length of a
/// tick \[s\].
pub(super) fn rows(bytes: &[u8], tick: f64) -> Result<Rows<'_>, LogError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match text.trim_ascii_start().first() {
        Some(b'{') => Ok(Box::new(json_rows(text, tick))),
        Some(b'[') => Err(RowError::Syntax(NO_OBJECT).at(1)),
        _ => csv_rows(text, tick),
    }
}

fn json_rows(text: &[u8], tick: f64) -> impl Iterator<Item = Result<Row, LogError>> {
    let lines = (1..).zip(text.split(|byte| *byte == b'\n'));
    let lines = lines.filter(|(_, line)| !line.trim_ascii().is_empty());
    lines.map(move |(number, line)| json_row(number, line, tick).map_err(|it| it.at(number)))
}

fn json_row(number: u64, line: &[u8], tick: f64) -> Result<Row, RowError> {
    let object: Map<String, Value> =
        serde_json::from_slice(line).map_err(|_| RowError::Syntax(NO_OBJECT))?;
    if let Some(key) = object.keys().find(|key| !COLUMNS.contains(&key.as_str())) {
        if POSITIONS.contains(&key.as_str()) {
            return Err(RowError::Position(key.clone()));
        }
        return Err(RowError::Key(key.clone()));
    }
    let cell = |name: &str| match object.get(name) {
        None | Some(Value::Null) => None,
        Some(Value::String(text)) => Some(Cow::Borrowed(text.as_str())),
        Some(other) => Some(Cow::Owned(other.to_string())),
    };
    row(number, cell, tick)
}

fn csv_rows(text: &[u8], tick: f64) -> Result<Rows<'_>, LogError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text);
    let header = reader.headers().map_err(|error| invalid(&error))?.clone();
    let position = |name: &str| header.iter().position(|column| column == name);
    if header.is_empty() {
        return Err(LogError::Empty);
    }
    let is_known = |column: &str| COLUMNS.contains(&column);
    let count = |name: &str| header.iter().filter(|column| *column == name).count();
    let required = ["run", "event", "block", "by"];
    let is_valid = required.iter().all(|it| count(it) <= 1)
        && count("seconds") + count("ticks") <= 1
        && count("body") <= 1;
    if let Some(column) = header.iter().find(|column| POSITIONS.contains(column)) {
        return Err(RowError::Position(column.to_owned()).at(1));
    }
    if !is_valid || !header.iter().all(is_known) {
        let columns: Vec<&str> = header.iter().collect();
        return Err(LogError::Columns(columns.join(",")));
    }
    if let Some(missing) = required.into_iter().find(|it| count(it) == 0) {
        return Err(LogError::MissingColumn(missing));
    }
    if count("seconds") + count("ticks") == 0 {
        return Err(LogError::MissingColumn("seconds` or `ticks"));
    }
    let positions = COLUMNS.map(position);
    let rows = reader.into_records().map(move |record| {
        let record: StringRecord = record.map_err(|error| invalid(&error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |name: &str| {
            let column = COLUMNS.iter().position(|column| *column == name)?;
            let text = record.get(positions[column]?)?;
            (!text.is_empty()).then_some(Cow::Borrowed(text))
        };
        row(line, cell, tick).map_err(|reason| reason.at(line))
    });
    Ok(Box::new(rows))
}

fn invalid(error: &csv::Error) -> LogError {
    let reason = match error.kind() {
        csv::ErrorKind::UnequalLengths { .. } => RowError::Cells,
        _ => RowError::Syntax("it is not valid text"),
    };
    reason.at(error.position().map_or(1, csv::Position::line))
}

/// Returns a row from its cells. `cell` returns the cell of a column, or `None` if it is empty.
fn row<'a>(
    line: u64,
    cell: impl Fn(&str) -> Option<Cow<'a, str>>,
    tick: f64,
) -> Result<Row, RowError> {
    let required = |name: &'static str| cell(name).ok_or(RowError::Missing(name));
    let (time, unit) = match (cell("seconds"), cell("ticks")) {
        (Some(seconds), None) => (seconds, tick),
        (None, Some(ticks)) => (ticks, 1.0),
        (Some(_), Some(_)) => {
            return Err(RowError::Syntax("its time is in `seconds` and in `ticks`"));
        }
        (None, None) => return Err(RowError::Missing("seconds")),
    };
    let ticks = time
        .parse::<f64>()
        .ok()
        .filter(|it| (0.0..=MAX).contains(it))
        .map(|it| it / unit)
        .filter(|it| *it <= MAX)
        .ok_or_else(|| RowError::Time(time.to_string()))?;
    if cell("ticks").is_some() && ticks.fract() != 0.0 {
        return Err(RowError::Ticks(time.into_owned()));
    }
    let event = required("event")?;
    let body = cell("body").map(|text| whole("body", &text)).transpose()?;
    Ok(Row {
        line,
        run: whole("run", &required("run")?)?,
        ticks,
        event: LogEvent::from_word(&event).ok_or_else(|| RowError::Event(event.into_owned()))?,
        block: cell("block").unwrap_or_default().into_owned(),
        by: cell("by").unwrap_or_default().into_owned(),
        body,
    })
}

fn whole<T: std::str::FromStr>(column: &'static str, text: &str) -> Result<T, RowError> {
    text.parse().map_err(|_| RowError::Number {
        column,
        text: text.to_owned(),
    })
}
