//! Columns in memory to a Parquet file in memory.
use std::sync::Arc;

use ::parquet::basic::{Compression, GzipLevel};
use ::parquet::data_type::{ByteArray, ByteArrayType, Int32Type, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::parser::parse_message_type;

/// One column of a table; all columns of a table have the same number of rows.
pub(super) enum Column<'a> {
    /// 32 bit integers, for coordinates.
    Small(Vec<i32>),
    /// 64 bit integers.
    Integers(Vec<i64>),
    /// 64 bit integers without a sign.
    Unsigned(Vec<u64>),
    /// 64 bit integers, some of which are null.
    MaybeIntegers(Vec<Option<i64>>),
    /// Text in UTF-8.
    Texts(Vec<&'a str>),
    /// Text in UTF-8, some of which is null.
    MaybeTexts(Vec<Option<&'a str>>),
    /// Lists of 64 bit integers, which may be empty.
    Lists(Vec<&'a [u64]>),
}

/// The table of `columns` as the bytes of a file, with `ensemble` in its metadata.
pub(super) fn file(name: &str, ensemble: &str, columns: &[(&str, Column)]) -> Vec<u8> {
    let mut schema = format!("message {name} {{\n");
    for (name, column) in columns {
        schema.push_str(&column.declaration(name));
    }
    schema.push('}');
    let schema = parse_message_type(&schema).expect("every declaration is one of a few");
    let properties = WriterProperties::builder()
        .set_compression(Compression::GZIP(GzipLevel::default()))
        .set_key_value_metadata(Some(vec![KeyValue::new(
            "stochc.ensemble".to_owned(),
            ensemble.to_owned(),
        )]))
        .build();
    let mut bytes = Vec::new();
    let write = || -> Result<(), ParquetError> {
        let mut file =
            SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
        let mut rows = file.next_row_group()?;
        for (_, column) in columns {
            let mut writer = rows
                .next_column()?
                .expect("one writer for each declaration");
            column.write(&mut writer)?;
            writer.close()?;
        }
        rows.close()?;
        file.close()?;
        Ok(())
    };
    write().expect("memory takes every column of its declared type");
    bytes
}

/// Integers of results are counts and ticks, far below 2^63.
pub(super) fn integer(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

impl Column<'_> {
    fn declaration(&self, name: &str) -> String {
        match self {
            Column::Small(_) => format!("  REQUIRED INT32 {name};\n"),
            Column::Integers(_) => format!("  REQUIRED INT64 {name};\n"),
            Column::Unsigned(_) => format!("  REQUIRED INT64 {name} (INTEGER(64,false));\n"),
            Column::MaybeIntegers(_) => format!("  OPTIONAL INT64 {name};\n"),
            Column::Texts(_) => format!("  REQUIRED BYTE_ARRAY {name} (STRING);\n"),
            Column::MaybeTexts(_) => format!("  OPTIONAL BYTE_ARRAY {name} (STRING);\n"),
            Column::Lists(_) => format!(
                "  REQUIRED GROUP {name} (LIST) {{\n    REPEATED GROUP list {{\n      \
                 REQUIRED INT64 element;\n    }}\n  }}\n"
            ),
        }
    }

    fn write(&self, writer: &mut SerializedColumnWriter) -> Result<(), ParquetError> {
        match self {
            Column::Small(values) => {
                writer
                    .typed::<Int32Type>()
                    .write_batch(values, None, None)?;
            }
            Column::Integers(values) => {
                writer
                    .typed::<Int64Type>()
                    .write_batch(values, None, None)?;
            }
            Column::Unsigned(values) => {
                // The format keeps the bits, and the declaration says that there is no sign.
                let bits: Vec<i64> = values.iter().map(|value| value.cast_signed()).collect();
                writer.typed::<Int64Type>().write_batch(&bits, None, None)?;
            }
            Column::MaybeIntegers(values) => {
                let present: Vec<i64> = values.iter().flatten().copied().collect();
                let levels = presence(values);
                writer
                    .typed::<Int64Type>()
                    .write_batch(&present, Some(&levels), None)?;
            }
            Column::Texts(values) => {
                let texts: Vec<ByteArray> = values.iter().map(|text| (*text).into()).collect();
                writer
                    .typed::<ByteArrayType>()
                    .write_batch(&texts, None, None)?;
            }
            Column::MaybeTexts(values) => {
                let present = values.iter().flatten();
                let present: Vec<ByteArray> = present.map(|text| (*text).into()).collect();
                let levels = presence(values);
                writer
                    .typed::<ByteArrayType>()
                    .write_batch(&present, Some(&levels), None)?;
            }
            Column::Lists(lists) => {
                let (values, definition, repetition) = levels(lists);
                writer.typed::<Int64Type>().write_batch(
                    &values,
                    Some(&definition),
                    Some(&repetition),
                )?;
            }
        }
        Ok(())
    }
}

/// The definition level of each row: 1 is there, 0 is null.
fn presence<T>(values: &[Option<T>]) -> Vec<i16> {
    values
        .iter()
        .map(|value| i16::from(value.is_some()))
        .collect()
}

/// Lists as values with a definition level (0: of an empty list, 1: of a value) and a repetition
/// level (0: begins a row, 1: goes on with it).
fn levels(lists: &[&[u64]]) -> (Vec<i64>, Vec<i16>, Vec<i16>) {
    let (mut values, mut definition, mut repetition) = (Vec::new(), Vec::new(), Vec::new());
    for list in lists {
        if list.is_empty() {
            definition.push(0);
            repetition.push(0);
        }
        for (i, &value) in list.iter().enumerate() {
            values.push(integer(value));
            definition.push(1);
            repetition.push(i16::from(i > 0));
        }
    }
    (values, definition, repetition)
}
