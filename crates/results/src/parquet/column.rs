//! Definition of a column, used for the documentation and for Parquet files.
use std::borrow::Cow;
use std::io::Write;

use ::parquet::basic::{Compression, GzipLevel};
use ::parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type,
};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::parser::parse_message_type;
use rustc_hash::FxHashMap;
use serde::Serialize;

/// Definition of a table. `R` is the type of a row.
pub struct TableDefinition<'a, R> {
    /// Name of the table. Its file is `NAME.parquet`.
    pub name: &'static str,
    /// Description of a row of the table.
    pub row: &'static str,
    /// Columns in their order.
    pub columns: Vec<ColumnDefinition<'a, R>>,
}

/// Definition of a column. `R` is the type of a row, and `'a` the lifetime of its texts.
pub struct ColumnDefinition<'a, R> {
    name: Cow<'static, str>,
    /// Unit of the values. Empty if they have no unit.
    unit: Cow<'static, str>,
    meaning: Cow<'static, str>,
    /// Condition for null values. `None` if values are never null.
    null: Option<&'static str>,
    values: ColumnGetter<'a, R>,
}

/// Function that returns the value of a column in a row; `None` is null.
type Get<'a, R, T> = Box<dyn Fn(&R) -> Option<T> + 'a>;

/// Function that returns the value of a column in a row. The variant is the type of the column.
pub(super) enum ColumnGetter<'a, R> {
    Bool(Get<'a, R, bool>),
    /// Values that are 32-bit integers, for coordinates.
    Small(Get<'a, R, i32>),
    Integer(Get<'a, R, i64>),
    /// Values that are unsigned 64-bit integers.
    Unsigned(Get<'a, R, u64>),
    Real(Get<'a, R, f64>),
    Text(Get<'a, R, &'a str>),
    /// Values that are lists of 64-bit integers, possibly empty and never null.
    Integers(Get<'a, R, &'a [u64]>),
    /// Values that are lists of texts, possibly empty and never null.
    Texts(Get<'a, R, Vec<&'a str>>),
}

/// Values of a column in several rows. `None` is a null value.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues<'a> {
    /// Values of type `bool`.
    Bool(Vec<Option<bool>>),
    /// Values of type `int32`.
    Int32(Vec<Option<i32>>),
    /// Values of type `int64`.
    Int64(Vec<Option<i64>>),
    /// Values of type `uint64`.
    UInt64(Vec<Option<u64>>),
    /// Values of type `float64`.
    Float64(Vec<Option<f64>>),
    /// Values of type `text`.
    Text(Vec<Option<&'a str>>),
    /// Values of type `list of int64`, possibly empty and never null.
    Int64Lists(Vec<Vec<i64>>),
    /// Values of type `list of text`, possibly empty and never null.
    TextLists(Vec<Vec<&'a str>>),
}

/// Makes methods that add a column. Each takes a function that returns a value, or `None` for null.
macro_rules! column_methods {
    ($($kind:ident: $value:ty => $variant:ident;)*) => {
        $(
        /// Adds a column.
        pub fn $kind<V: Into<Option<$value>>>(
            &mut self,
            name: impl Into<Cow<'static, str>>,
            meaning: impl Into<Cow<'static, str>>,
            get: impl Fn(&R) -> V + 'a,
        ) -> &mut ColumnDefinition<'a, R> {
            let values = ColumnGetter::$variant(Box::new(move |row| get(row).into()));
            self.add(name.into(), meaning.into(), values)
        })*
    };
}

impl<'a, R> TableDefinition<'a, R> {
    /// Creates a table without columns.
    pub fn new(name: &'static str, row: &'static str) -> TableDefinition<'a, R> {
        TableDefinition {
            name,
            row,
            columns: Vec::new(),
        }
    }

    column_methods! {
        truth: bool => Bool;
        small: i32 => Small;
        unsigned: u64 => Unsigned;
        real: f64 => Real;
        text: &'a str => Text;
        integers: &'a [u64] => Integers;
        texts: Vec<&'a str> => Texts;
    }

    /// Adds a column of counts or ticks, which are far below 2^63.
    pub fn integer<V: Into<Option<u64>>>(
        &mut self,
        name: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        get: impl Fn(&R) -> V + 'a,
    ) -> &mut ColumnDefinition<'a, R> {
        let signed = |value| i64::try_from(value).unwrap_or(i64::MAX);
        let values = ColumnGetter::Integer(Box::new(move |row| get(row).into().map(signed)));
        self.add(name.into(), meaning.into(), values)
    }

    fn add(
        &mut self,
        name: Cow<'static, str>,
        meaning: Cow<'static, str>,
        values: ColumnGetter<'a, R>,
    ) -> &mut ColumnDefinition<'a, R> {
        self.columns.push(ColumnDefinition {
            name,
            unit: "".into(),
            meaning,
            null: None,
            values,
        });
        let last = self.columns.len() - 1;
        &mut self.columns[last]
    }
}

/// Description of a table, for documentation and metadata.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TableShape {
    /// Name of the table. Its file is `NAME.parquet`.
    pub name: String,
    /// Description of a row of the table.
    pub row: String,
    /// Columns in order.
    pub columns: Vec<ColumnShape>,
}

/// Description of a column.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ColumnShape {
    /// Name of the column.
    pub name: String,
    /// Type of the values: `int32`, `int64`, `uint64`, `float64`, `bool`, `text`, or `list of` one
    /// of these.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Unit of the values. Empty if they have no unit.
    pub unit: String,
    /// Meaning of the values.
    pub meaning: String,
    /// Condition for null values. `None` if values are never null.
    pub null: Option<String>,
}

impl<R> TableDefinition<'_, R> {
    /// Returns the description of the table.
    pub fn shape(&self) -> TableShape {
        TableShape {
            name: self.name.to_owned(),
            row: self.row.to_owned(),
            columns: self.columns.iter().map(ColumnDefinition::shape).collect(),
        }
    }

    /// Begins the Parquet file of the table, with additional `metadata`.
    pub(super) fn begin<W: Write + Send>(
        &self,
        out: W,
        metadata: &[(&str, String)],
    ) -> Result<TableFile<W>, ParquetError> {
        let mut schema = format!("message {} {{\n", self.name);
        for column in &self.columns {
            schema.push_str(&column.declaration());
        }
        schema.push('}');
        let schema = parse_message_type(&schema).expect("every declaration is one of a few");
        let shape = self.shape();
        let json = serde_json::to_string(&shape.columns).expect("shapes are plain data");
        let own = [
            ("stochc.table", shape.name),
            ("stochc.row", shape.row),
            ("stochc.columns", json),
        ];
        let metadata = own.iter().chain(metadata);
        let metadata = metadata
            .map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()))
            .collect();
        let properties = WriterProperties::builder()
            .set_compression(Compression::GZIP(GzipLevel::default()))
            .set_key_value_metadata(Some(metadata))
            .build();
        let writer = SerializedFileWriter::new(out, schema.into(), properties.into())?;
        Ok(TableFile(writer))
    }
}

/// File of a table, written in row groups.
pub(super) struct TableFile<W: Write>(SerializedFileWriter<W>);

impl<W: Write + Send> TableFile<W> {
    /// Writes the next rows of the table as a row group.
    pub fn add<R>(&mut self, table: &TableDefinition<R>, rows: &[R]) -> Result<(), ParquetError> {
        let mut group = self.0.next_row_group()?;
        for column in &table.columns {
            let mut writer = (group.next_column()?).expect("one writer for each declaration");
            column.write(rows, &mut writer)?;
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }

    pub fn is_empty(&self) -> bool {
        self.0.flushed_row_groups().is_empty()
    }

    pub fn finish(self) -> Result<W, ParquetError> {
        self.0.into_inner()
    }
}

impl<'a, R> ColumnDefinition<'a, R> {
    /// Sets the unit of the column's values.
    pub fn unit(&mut self, unit: impl Into<Cow<'static, str>>) -> &mut ColumnDefinition<'a, R> {
        self.unit = unit.into();
        self
    }

    /// Allows null values in the column. `when` describes the condition for null.
    pub fn null(&mut self, when: &'static str) -> &mut ColumnDefinition<'a, R> {
        self.null = Some(when);
        self
    }

    fn shape(&self) -> ColumnShape {
        ColumnShape {
            name: self.name.to_string(),
            kind: match self.values {
                ColumnGetter::Bool(_) => "bool",
                ColumnGetter::Small(_) => "int32",
                ColumnGetter::Integer(_) => "int64",
                ColumnGetter::Unsigned(_) => "uint64",
                ColumnGetter::Real(_) => "float64",
                ColumnGetter::Text(_) => "text",
                ColumnGetter::Integers(_) => "list of int64",
                ColumnGetter::Texts(_) => "list of text",
            },
            unit: self.unit.to_string(),
            meaning: self.meaning.to_string(),
            null: self.null.map(str::to_owned),
        }
    }

    fn declaration(&self) -> String {
        let (name, is) = (
            &self.name,
            match self.null {
                None => "REQUIRED",
                Some(_) => "OPTIONAL",
            },
        );
        let list = |of: &str| {
            format!(
                "  {is} GROUP {name} (LIST) {{\n    REPEATED GROUP list {{\n      \
                 REQUIRED {of};\n    }}\n  }}\n"
            )
        };
        match self.values {
            ColumnGetter::Bool(_) => format!("  {is} BOOLEAN {name};\n"),
            ColumnGetter::Small(_) => format!("  {is} INT32 {name};\n"),
            ColumnGetter::Integer(_) => format!("  {is} INT64 {name};\n"),
            ColumnGetter::Unsigned(_) => format!("  {is} INT64 {name} (INTEGER(64,false));\n"),
            ColumnGetter::Real(_) => format!("  {is} DOUBLE {name};\n"),
            ColumnGetter::Text(_) => format!("  {is} BYTE_ARRAY {name} (STRING);\n"),
            ColumnGetter::Integers(_) => list("INT64 element"),
            ColumnGetter::Texts(_) => list("BYTE_ARRAY element (STRING)"),
        }
    }

    /// Returns the values of the column in these rows, in order.
    pub fn values(&self, rows: &[R]) -> ColumnValues<'a> {
        fn each<R, T>(rows: &[R], get: impl Fn(&R) -> Option<T>) -> Vec<Option<T>> {
            rows.iter().map(get).collect()
        }
        match &self.values {
            ColumnGetter::Bool(get) => ColumnValues::Bool(each(rows, get)),
            ColumnGetter::Small(get) => ColumnValues::Int32(each(rows, get)),
            ColumnGetter::Integer(get) => ColumnValues::Int64(each(rows, get)),
            ColumnGetter::Unsigned(get) => ColumnValues::UInt64(each(rows, get)),
            ColumnGetter::Real(get) => ColumnValues::Float64(each(rows, get)),
            ColumnGetter::Text(get) => ColumnValues::Text(each(rows, get)),
            ColumnGetter::Integers(get) => {
                let signed = |&value: &u64| i64::try_from(value).unwrap_or(i64::MAX);
                let list = |row| get(row).unwrap_or_default().iter().map(signed).collect();
                ColumnValues::Int64Lists(rows.iter().map(list).collect())
            }
            ColumnGetter::Texts(get) => {
                let list = |row| get(row).unwrap_or_default();
                ColumnValues::TextLists(rows.iter().map(list).collect())
            }
        }
    }

    fn write(&self, rows: &[R], writer: &mut SerializedColumnWriter) -> Result<(), ParquetError> {
        let to = (self.null.is_some(), writer);
        match self.values(rows) {
            ColumnValues::Bool(values) => put::<BoolType, _>(to, values, |it| it),
            ColumnValues::Int32(values) => put::<Int32Type, _>(to, values, |it| it),
            ColumnValues::Int64(values) => put::<Int64Type, _>(to, values, |it| it),
            // The format stores only the bits. The schema marks them as unsigned.
            ColumnValues::UInt64(values) => put::<Int64Type, _>(to, values, u64::cast_signed),
            ColumnValues::Float64(values) => put::<DoubleType, _>(to, values, |it| it),
            ColumnValues::Text(values) => {
                let mut known = FxHashMap::default();
                put::<ByteArrayType, _>(to, values, |text| shared(text, &mut known))
            }
            ColumnValues::Int64Lists(lists) => put_lists::<Int64Type, _>(to, lists, |it| it),
            ColumnValues::TextLists(lists) => {
                put_lists::<ByteArrayType, _>(to, lists, ByteArray::from)
            }
        }
    }
}

/// Returns a text for the writer. Copies each distinct text only once, because most texts are
/// repeated names.
fn shared(text: &str, known: &mut FxHashMap<(*const u8, usize), ByteArray>) -> ByteArray {
    let place = (text.as_ptr(), text.len());
    let known = known.entry(place).or_insert_with(|| text.into());
    known.clone()
}

/// Destination of a column's values: whether they may be null, and the writer of the column.
type To<'w, 'x> = (bool, &'w mut SerializedColumnWriter<'x>);

fn put<T: DataType, V>(
    (nullable, writer): To,
    values: Vec<Option<V>>,
    as_written: impl FnMut(V) -> T::T,
) -> Result<(), ParquetError> {
    // Definition level of each row: 1 is a value, 0 is null.
    let level = |value: &Option<V>| i16::from(value.is_some());
    let levels: Option<Vec<i16>> = nullable.then(|| values.iter().map(level).collect());
    let present: Vec<T::T> = values.into_iter().flatten().map(as_written).collect();
    let typed = writer.typed::<T>();
    typed.write_batch(&present, levels.as_deref(), None)?;
    Ok(())
}

/// Writes lists in the encoding of Parquet. Each value has a definition level (0: empty list, 1:
/// value). It also has a repetition level (0: starts a new row, 1: continues the row).
fn put_lists<T: DataType, V>(
    (_, writer): To,
    lists: Vec<Vec<V>>,
    as_written: impl Fn(V) -> T::T,
) -> Result<(), ParquetError> {
    let (mut values, mut definition, mut repetition) = (Vec::new(), Vec::new(), Vec::new());
    for list in lists {
        if list.is_empty() {
            definition.push(0);
            repetition.push(0);
        }
        for (i, value) in list.into_iter().enumerate() {
            values.push(as_written(value));
            definition.push(1);
            repetition.push(i16::from(i > 0));
        }
    }
    let typed = writer.typed::<T>();
    typed.write_batch(&values, Some(&definition), Some(&repetition))?;
    Ok(())
}
