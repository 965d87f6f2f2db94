//! Tables in Arrow's memory format, exported through the C stream interface.
use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::builder::{Int64Builder, ListBuilder, StringBuilder};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int32Array, Int64Array, RecordBatch,
    RecordBatchIterator, StringArray, UInt64Array,
};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use serde_json::{Value, json};
use stochc::results::{ColumnShape, ColumnValues, TableShape};

/// Table with rows in one or more batches.
#[pyclass(frozen, name = "Table", module = "stochc._native")]
#[derive(Debug)]
pub struct PythonTable {
    shape: TableShape,
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

/// Name of the elements of lists, as in Parquet files.
const ELEMENT: &str = "element";

impl PythonTable {
    /// Returns a table with metadata and without rows.
    pub fn new(shape: TableShape, about: &[(&str, String)]) -> PythonTable {
        let own = [
            ("stochc.table", shape.name.clone()),
            ("stochc.row", shape.row.clone()),
        ];
        let metadata = own.iter().chain(about);
        let metadata: HashMap<_, _> = metadata
            .map(|(key, value)| ((*key).to_owned(), value.clone()))
            .collect();
        let fields: Vec<Field> = shape.columns.iter().map(field).collect();
        let schema = Schema::new(fields).with_metadata(metadata).into();
        PythonTable {
            shape,
            schema,
            batches: Vec::new(),
        }
    }

    /// Adds rows, given column by column.
    ///
    /// # Errors
    ///
    /// If the rows do not match the columns of the table.
    pub fn add(&mut self, columns: Vec<ColumnValues<'_>>) -> Result<(), String> {
        let arrays = columns.into_iter().map(array).collect();
        let batch = RecordBatch::try_new(self.schema.clone(), arrays);
        self.batches.push(batch.map_err(|error| error.to_string())?);
        Ok(())
    }
}

fn field(column: &ColumnShape) -> Field {
    let list = |of| DataType::List(Field::new(ELEMENT, of, false).into());
    let kind = match column.kind {
        "bool" => DataType::Boolean,
        "int32" => DataType::Int32,
        "int64" => DataType::Int64,
        "uint64" => DataType::UInt64,
        "float64" => DataType::Float64,
        "list of int64" => list(DataType::Int64),
        "list of text" => list(DataType::Utf8),
        _ => DataType::Utf8,
    };
    let mut metadata = HashMap::from([("meaning".to_owned(), column.meaning.clone())]);
    if !column.unit.is_empty() {
        metadata.insert("unit".to_owned(), column.unit.clone());
    }
    if let Some(null) = &column.null {
        metadata.insert("null".to_owned(), null.clone());
    }
    Field::new(&column.name, kind, column.null.is_some()).with_metadata(metadata)
}

fn array(values: ColumnValues<'_>) -> ArrayRef {
    let element = |of| Field::new(ELEMENT, of, false);
    match values {
        ColumnValues::Bool(values) => Arc::new(BooleanArray::from(values)),
        ColumnValues::Int32(values) => Arc::new(Int32Array::from(values)),
        ColumnValues::Int64(values) => Arc::new(Int64Array::from(values)),
        ColumnValues::UInt64(values) => Arc::new(UInt64Array::from(values)),
        ColumnValues::Float64(values) => Arc::new(Float64Array::from(values)),
        ColumnValues::Text(values) => Arc::new(StringArray::from(values)),
        ColumnValues::Int64Lists(lists) => {
            let items = Int64Builder::new();
            let mut builder = ListBuilder::new(items).with_field(element(DataType::Int64));
            for list in lists {
                builder.values().append_slice(&list);
                builder.append(true);
            }
            Arc::new(builder.finish())
        }
        ColumnValues::TextLists(lists) => {
            let items = StringBuilder::new();
            let mut builder = ListBuilder::new(items).with_field(element(DataType::Utf8));
            for list in lists {
                list.iter()
                    .for_each(|text| builder.values().append_value(text));
                builder.append(true);
            }
            Arc::new(builder.finish())
        }
    }
}

/// Returns the value of a column in a row as JSON.
fn value(array: &dyn Array, row: usize) -> Value {
    macro_rules! value {
        ($($kind:ty),*) => {
            $(if let Some(array) = array.as_any().downcast_ref::<$kind>() {
                return json!(array.is_valid(row).then(|| array.value(row)));
            })*
        };
    }
    value!(
        BooleanArray,
        Int32Array,
        Int64Array,
        UInt64Array,
        Float64Array,
        StringArray
    );
    if let Some(lists) = array.as_any().downcast_ref::<arrow_array::ListArray>() {
        let list = lists.value(row);
        return (0..list.len()).map(|i| value(&*list, i)).collect();
    }
    Value::Null
}

#[pymethods]
impl PythonTable {
    /// Returns the description of the table as JSON: its name, the meaning of a row, and the
    /// columns.
    fn shape_json(&self) -> String {
        json!(self.shape).to_string()
    }

    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    /// Returns up to `most` rows as JSON, starting at row `first`. Each row is a list.
    fn rows_json(&self, first: usize, most: usize) -> String {
        let mut left_out = first;
        let mut rows: Vec<Value> = Vec::new();
        for batch in &self.batches {
            let begin = left_out.min(batch.num_rows());
            left_out -= begin;
            let end = batch.num_rows().min(begin + (most - rows.len()));
            rows.extend((begin..end).map(|row| {
                let columns = batch.columns().iter();
                columns.map(|column| value(column, row)).collect::<Value>()
            }));
        }
        Value::from(rows).to_string()
    }

    /// Returns the schema through Arrow's C interface.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(&*self.schema);
        let schema = schema.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// Returns all batches as a stream of Arrow's C interface, without copying. Ignores
    /// `requested_schema`.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let batches = self.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, self.schema.clone());
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}
