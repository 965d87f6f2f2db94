//! Errors of logs.
/// Reason why a log cannot be imported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LogError {
    /// A row is invalid.
    #[error("line {line}: {reason}")]
    Row {
        /// Line of the log, from 1.
        line: u64,
        /// Reason why the row is invalid.
        reason: RowError,
    },
    /// The header is invalid.
    #[error(
        "its columns are `{0}`; a log has the columns `run`, `seconds` or `ticks`, `event`, `block` and `by`, and may have \
         the column `body`"
    )]
    Columns(String),
    /// A column is missing.
    #[error(
        "the column `{0}` is missing; a log has the columns `run`, `seconds` or `ticks`, `event`, `block` and `by`"
    )]
    MissingColumn(&'static str),
    /// There are no rows.
    #[error("it contains no runs")]
    Empty,
    /// The program is an aggregate.
    #[error(
        "`{0}` is an aggregate, and logs are of assemblies: the blocks of an aggregate have no names"
    )]
    Aggregate(String),
    /// The program has no phase.
    #[error("`{0}` has no phase, so nothing happens in its runs")]
    NoPhase(String),
    /// The scene of the program cannot be set up.
    #[error("`{0}` cannot start: {1}")]
    Program(String, String),
}

/// Reason why a row of a log is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RowError {
    /// The row is not a row of a table or an object of JSON.
    #[error("{0}")]
    Syntax(&'static str),
    /// The number of cells is wrong.
    #[error("the number of cells differs from the number of columns")]
    Cells,
    /// A cell is missing.
    #[error("`{0}` is missing")]
    Missing(&'static str),
    /// A key of an object is unknown.
    #[error(
        "`{0}` is not a key of a log; keys are `run`, `seconds` or `ticks`, `event`, `block`, `by` and `body`"
    )]
    Key(String),
    /// The log contains tracked positions.
    #[error(
        "`{0}` is a position, and a log contains only events; keep tracked positions in a file of their own"
    )]
    Position(String),
    /// The cell is not a whole number.
    #[error("`{text}` in `{column}` is not a whole number")]
    Number {
        /// Name of the column.
        column: &'static str,
        /// Text of the cell.
        text: String,
    },
    /// The cell is not a time.
    #[error("`{0}` is not a time from 0 to 1e15")]
    Time(String),
    /// The time in ticks is not a whole number.
    #[error("`{0}` in `ticks` is not a whole number; give such times in the column `seconds`")]
    Ticks(String),
    /// The event is unknown.
    #[error(
        "`{0}` is not an event; events are `phase`, `opened`, `captured`, `released`, `rejected`, `timeout` and `end`"
    )]
    Event(String),
    /// The runs are not in order.
    #[error(
        "expected run {}{expected}, found run {run}; number the runs 0, 1, 2 ..., and keep the rows of each run together",
        expected.checked_sub(1).map_or(String::new(), |it| format!("{it} or "))
    )]
    RunOrder {
        /// Number of the run in the row.
        run: u64,
        /// Number of the next run.
        expected: u64,
    },
    /// The time is before an earlier row of the run.
    #[error("its time is before the time of line {0}; sort the rows of each run by time")]
    Backwards(u64),
    /// The run has ended.
    #[error("the run has ended in line {0}")]
    Ended(u64),
    /// The program has no such block.
    #[error("the program has no block `{name}`{}", did_you_mean(.near.as_deref()))]
    Block {
        /// Name in the log.
        name: String,
        /// Similar name in the program.
        near: Option<String>,
    },
    /// The program has no such phase.
    #[error("the program has no phase `{name}`{}", did_you_mean(.near.as_deref()))]
    NoPhase {
        /// Name in the log.
        name: String,
        /// Similar name in the program.
        near: Option<String>,
    },
    /// The cell does not name a face.
    #[error("`{0}` in `by` is not a face of a block, such as `A.up`")]
    Face(String),
    /// The program has no such event.
    #[error("the program has no event `{event}`{}", instead.as_ref().map_or(String::new(), |it| format!("; it has `{it}`")))]
    NoEvent {
        /// The event of the row.
        event: String,
        /// Event of the program with the same block.
        instead: Option<String>,
    },
    /// The event has happened before.
    #[error("`{event}` has already happened in line {line}")]
    Repeated {
        /// The event of the row.
        event: String,
        /// Line of the same event.
        line: u64,
    },
    /// The event belongs to another phase than the running one.
    #[error("`{event}` belongs to phase `{phase}`, and phase `{running}` is running: {reason}")]
    OtherPhase {
        /// The event of the row.
        event: String,
        /// Phase of the event.
        phase: String,
        /// Running phase.
        running: String,
        /// Reason why the phase is still running.
        reason: String,
    },
    /// The event waits for another event.
    #[error("`{event}` waits for `{first}`, which has no row before it")]
    TooEarly {
        /// The event of the row.
        event: String,
        /// Event that must come first.
        first: String,
    },
    /// Another block releases the block.
    #[error("`{child}` is attached to `{parent}`, not to `{found}`")]
    Parent {
        /// Released block.
        child: String,
        /// Parent of the block.
        parent: String,
        /// Parent in the log.
        found: String,
    },
    /// The event happens before the run.
    #[error("`{0}` is pre-attached; a log contains only the events of the run")]
    PreAttached(String),
    /// The event belongs to an attempt that has timed out.
    #[error(
        "`{0}` comes after the timeout of its phase; add a row `phase` where the phase begins again"
    )]
    Aborted(String),
    /// All blocks of the scene are attached.
    #[error("all {0} free blocks of the scene are attached already")]
    NoFreeBlock(u32),
    /// The number of the block is too large.
    #[error("block {body} does not exist: the scene has blocks 0 to {}", .blocks.saturating_sub(1))]
    NoSuchBody {
        /// Number in the log.
        body: u32,
        /// Number of free blocks in the scene.
        blocks: u32,
    },
    /// The block is attached.
    #[error("block {0} is attached already; log its release first, or leave out the column `body`")]
    Attached(u32),
    /// The phase comes at the wrong time, or cannot time out.
    #[error("{0}")]
    Phase(String),
    /// The whole run is impossible.
    #[error("the run that ends here is impossible: {0}")]
    Impossible(String),
}

impl RowError {
    pub(super) fn at(self, line: u64) -> LogError {
        LogError::Row { line, reason: self }
    }
}

fn did_you_mean(near: Option<&str>) -> String {
    near.map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}
