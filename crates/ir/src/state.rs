//! Serialized state of a running computation, for resuming it.
//!
//! The bytes are not self-describing. Only the build that wrote them can read them.
use std::io::{self, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Object whose state can be saved. The state can be restored in another object that was
/// constructed in the same way.
pub trait State {
    /// Writes the state.
    ///
    /// # Errors
    ///
    /// Errors of the writer, and if the type has no serializable state.
    fn save(&self, _to: &mut StateWriter<'_>) -> Result<(), StateError> {
        Err(StateError::unknown())
    }

    /// Restores the state that [`State::save`] has written. After an error, the instance must not
    /// be used.
    ///
    /// # Errors
    ///
    /// Errors of the reader, and unexpected content.
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Err(StateError::unknown())
    }
}

impl State for () {
    fn save(&self, _to: &mut StateWriter<'_>) -> Result<(), StateError> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Ok(())
    }
}

impl<T: State> State for Option<T> {
    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        self.as_ref().map_or(Ok(()), |it| it.save(to))
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.as_mut().map_or(Ok(()), |it| it.restore(from))
    }
}

/// Error of writing or reading a state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateError(String);

impl StateError {
    fn unknown() -> StateError {
        StateError("it does not say what its state is".to_owned())
    }
}

impl std::fmt::Display for StateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for StateError {}

impl From<io::Error> for StateError {
    fn from(error: io::Error) -> StateError {
        StateError(error.to_string())
    }
}

impl From<postcard::Error> for StateError {
    fn from(_: postcard::Error) -> StateError {
        StateError("it is not as it was written".to_owned())
    }
}

/// Writer of values. The length of each value precedes it.
pub struct StateWriter<'a>(&'a mut dyn Write);

impl<'a> StateWriter<'a> {
    /// Returns a writer to `to`.
    pub fn new(to: &'a mut dyn Write) -> StateWriter<'a> {
        StateWriter(to)
    }

    /// Writes a value.
    ///
    /// # Errors
    ///
    /// Errors of the output.
    pub fn put<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), StateError> {
        let bytes = postcard::to_extend(value, Vec::new())?;
        self.copy(bytes.len() as u64, &*bytes)
    }

    /// Copies `length` bytes from `from` to the output.
    ///
    /// # Errors
    ///
    /// Errors of input and output. An input with fewer bytes is also an error.
    pub fn copy(&mut self, length: u64, from: impl Read) -> Result<(), StateError> {
        self.0.write_all(&length.to_le_bytes())?;
        if io::copy(&mut from.take(length), self.0)? == length {
            Ok(())
        } else {
            Err(io::Error::from(io::ErrorKind::UnexpectedEof).into())
        }
    }
}

/// Reader of the output of a [`StateWriter`].
pub struct StateReader<'a>(&'a mut dyn Read);

impl<'a> StateReader<'a> {
    /// Returns a reader from `from`.
    pub fn new(from: &'a mut dyn Read) -> StateReader<'a> {
        StateReader(from)
    }

    /// Reads the next value.
    ///
    /// # Errors
    ///
    /// Errors of the input, and unexpected content as far as detectable.
    pub fn take<T: DeserializeOwned>(&mut self) -> Result<T, StateError> {
        let mut bytes = Vec::new();
        self.copy(&mut bytes)?;
        Ok(postcard::from_bytes(&bytes)?)
    }

    /// Copies to `to` the bytes that [`StateWriter::copy`] has written.
    ///
    /// # Errors
    ///
    /// Errors of input and output. An input with fewer bytes is also an error.
    pub fn copy(&mut self, to: &mut impl Write) -> Result<(), StateError> {
        let mut length = [0; 8];
        self.0.read_exact(&mut length)?;
        let length = u64::from_le_bytes(length);
        if io::copy(&mut (&mut *self.0).take(length), to)? == length {
            Ok(())
        } else {
            Err(io::Error::from(io::ErrorKind::UnexpectedEof).into())
        }
    }
}

/// Implements [`State`] from a list of all fields: serialized values (`values`), fields with a
/// state (`parts`), and fields determined by construction (`same`). A missing field does not
/// compile.
#[macro_export]
macro_rules! state {
    (
        ($($generics:tt)*) $type:ty;
        values: $($value:ident),*;
        parts: $($part:ident),*;
        same: $($same:ident),*
    ) => {
        impl $($generics)* $crate::state::State for $type {
            fn save(
                &self,
                to: &mut $crate::state::StateWriter<'_>,
            ) -> Result<(), $crate::state::StateError> {
                let Self { $($value,)* $($part,)* $($same: _,)* } = self;
                $(to.put($value)?;)*
                $($crate::state::State::save($part, to)?;)*
                Ok(())
            }

            fn restore(
                &mut self,
                from: &mut $crate::state::StateReader<'_>,
            ) -> Result<(), $crate::state::StateError> {
                $(self.$value = from.take()?;)*
                $($crate::state::State::restore(&mut self.$part, from)?;)*
                Ok(())
            }
        }
    };
}
