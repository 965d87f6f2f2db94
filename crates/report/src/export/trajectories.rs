//! Export of positions as a table, with one row for each block and tick.
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

use ::parquet::basic::{Compression, Encoding, GzipLevel};
use ::parquet::data_type::{ByteArray, ByteArrayType, FloatType, Int32Type, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::parser::parse_message_type;
use ::parquet::schema::types::ColumnPath;
use stochc_ir::table::Tables;
use stochc_runtime::observe::{ObservedEvent, Observer};
use stochc_runtime::world::SpatialWorld;

/// Number of rows in a row group, about 30 MB in memory.
const GROUP: usize = 1 << 20;

/// Byte sequence near the end of every exported table: a pair of its metadata in Thrift's compact
/// protocol.
pub const TRAJECTORIES_MARK: &[u8] = b"stochc.table\x18\x0ctrajectories";

const SCHEMA: &str = "message trajectories {
  REQUIRED INT64 tick;
  REQUIRED INT32 body;
  REQUIRED FLOAT x;
  REQUIRED FLOAT y;
  REQUIRED FLOAT z;
  REQUIRED FLOAT qx;
  REQUIRED FLOAT qy;
  REQUIRED FLOAT qz;
  REQUIRED FLOAT qw;
  OPTIONAL BYTE_ARRAY role (STRING);
}";

/// Writes the positions of all blocks as Parquet, in row groups.
///
/// | column | type | meaning |
/// |---|---|---|
/// | `tick` | integer | tick: every nth tick, starting at 0 |
/// | `body` | integer | number of the block, from 0 |
/// | `x`, `y`, `z` | 32-bit float | position of the block's centre relative to the centre of the plate's upper side \[block lengths\]; z is up |
/// | `qx`, `qy`, `qz`, `qw` | 32-bit float | quaternion from the block's own axes to those of the structure |
/// | `role` | text or null | role of the block while it is part of the structure |
pub struct Trajectories<W: Write + Send> {
    /// Writer of the file. `None` after an error.
    writer: Option<SerializedFileWriter<W>>,
    every: u64,
    names: Vec<String>,
    /// Role of each block that is part of the structure.
    roles: BTreeMap<u32, usize>,
    rows: TrajectoryRows,
    broken: Option<ParquetError>,
}

#[derive(Default)]
struct TrajectoryRows {
    ticks: Vec<i64>,
    bodies: Vec<i32>,
    numbers: [Vec<f32>; 7],
    roles: Vec<Option<usize>>,
}

impl<W: Write + Send> Trajectories<W> {
    /// Begins a table with the positions at every `every`th tick. `about` is stored in its
    /// metadata.
    ///
    /// # Errors
    ///
    /// Errors of `out`.
    pub fn new(
        out: W,
        every: u32,
        tables: &Tables,
        about: &[(&str, String)],
    ) -> Result<Trajectories<W>, ParquetError> {
        let table = [("stochc.table", "trajectories".to_owned())];
        let metadata = table
            .iter()
            .chain(about)
            .map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::GZIP(GzipLevel::default()))
            .set_key_value_metadata(Some(metadata.collect()));
        // Values of these columns rarely repeat, but their high bytes are similar.
        for column in ["x", "y", "z", "qx", "qy", "qz", "qw"] {
            properties = properties
                .set_column_dictionary_enabled(ColumnPath::from(column), false)
                .set_column_encoding(ColumnPath::from(column), Encoding::BYTE_STREAM_SPLIT);
        }
        let schema = Arc::new(parse_message_type(SCHEMA)?);
        let writer = SerializedFileWriter::new(out, schema, Arc::new(properties.build()))?;
        Ok(Trajectories {
            writer: Some(writer),
            every: every.max(1).into(),
            names: tables.roles.iter().map(|role| role.name.clone()).collect(),
            roles: BTreeMap::new(),
            rows: TrajectoryRows::default(),
            broken: None,
        })
    }

    /// Writes the remaining rows.
    ///
    /// # Errors
    ///
    /// The first error since the beginning.
    pub fn finish(mut self) -> Result<W, ParquetError> {
        self.flush();
        match (self.writer, self.broken) {
            (_, Some(error)) => Err(error),
            (Some(writer), None) => writer.into_inner(),
            (None, None) => Err(ParquetError::General("nothing was written".into())),
        }
    }

    fn flush(&mut self) {
        let rows = std::mem::take(&mut self.rows);
        if let (Some(writer), None) = (&mut self.writer, &self.broken)
            && let Err(error) = rows.write(&self.names, writer)
        {
            self.broken = Some(error);
        }
    }
}

impl TrajectoryRows {
    fn write(
        &self,
        names: &[String],
        writer: &mut SerializedFileWriter<impl Write + Send>,
    ) -> Result<(), ParquetError> {
        let mut group = writer.next_row_group()?;
        let mut column = 0;
        while let Some(mut values) = group.next_column()? {
            match column {
                0 => drop(
                    values
                        .typed::<Int64Type>()
                        .write_batch(&self.ticks, None, None)?,
                ),
                1 => drop(
                    values
                        .typed::<Int32Type>()
                        .write_batch(&self.bodies, None, None)?,
                ),
                2..=8 => {
                    let numbers = &self.numbers[column - 2];
                    values
                        .typed::<FloatType>()
                        .write_batch(numbers, None, None)?;
                }
                _ => {
                    let levels: Vec<i16> = (self.roles.iter())
                        .map(|role| i16::from(role.is_some()))
                        .collect();
                    let texts: Vec<ByteArray> = (self.roles.iter().flatten())
                        .map(|&role| names[role].as_str().into())
                        .collect();
                    let typed = values.typed::<ByteArrayType>();
                    typed.write_batch(&texts, Some(&levels), None)?;
                }
            }
            values.close()?;
            column += 1;
        }
        group.close()?;
        Ok(())
    }
}

impl<W: Write + Send> Observer for Trajectories<W> {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        for event in events {
            match *event {
                ObservedEvent::Captured { body, role, .. } => {
                    self.roles.insert(body, role.0 as usize);
                }
                ObservedEvent::Released { body, .. } => {
                    self.roles.remove(&body);
                }
                _ => {}
            }
        }
        let tick = arena.tick();
        if !tick.is_multiple_of(self.every) || self.broken.is_some() {
            return;
        }
        for id in 0..arena.count() {
            let state = arena.state(id);
            let (place, q) = (state.position, state.orientation.coords);
            let numbers = [place.x, place.y, place.z, q.x, q.y, q.z, q.w];
            self.rows.ticks.push(tick.cast_signed());
            self.rows.bodies.push(id.cast_signed());
            for (column, number) in self.rows.numbers.iter_mut().zip(numbers) {
                column.push(number as f32);
            }
            self.rows.roles.push(self.roles.get(&id).copied());
        }
        if self.rows.ticks.len() >= GROUP {
            self.flush();
        }
    }
}
