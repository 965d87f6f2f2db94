//! The state of something that is under way, as bytes: whoever takes it over goes on as if it had never stopped.
//!
//! The bytes do not say which value is which: they are for the build alone that has written them.
use std::io::{self, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Something whose state can be taken over by another one that has been made in the same way.
pub trait State {
    /// Writes it down.
    ///
    /// # Errors
    /// Those of the writer, and where it does not know how.
    fn save(&self, _to: &mut StateWriter<'_>) -> Result<(), StateError> {
        Err(StateError::unknown())
    }

    /// Takes over what [`State::save`] has written; after an error it is of no use any more.
    ///
    /// # Errors
    /// Those of the reader, and where it is not what was written.
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Err(StateError::unknown())
    }
}

/// What has no state.
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

/// Why a state cannot be written or read.
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

/// Writes values one after the other, each with its length.
pub struct StateWriter<'a>(&'a mut dyn Write);

impl<'a> StateWriter<'a> {
    /// Writes to `to`.
    pub fn new(to: &'a mut dyn Write) -> StateWriter<'a> {
        StateWriter(to)
    }

    /// Writes a value.
    ///
    /// # Errors
    /// Those of what it writes to.
    pub fn put<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), StateError> {
        let bytes = postcard::to_extend(value, Vec::new())?;
        self.copy(bytes.len() as u64, &*bytes)
    }

    /// Writes so many bytes.
    ///
    /// # Errors
    /// Those of both ends, and where there are fewer.
    pub fn copy(&mut self, length: u64, from: impl Read) -> Result<(), StateError> {
        self.0.write_all(&length.to_le_bytes())?;
        if io::copy(&mut from.take(length), self.0)? == length {
            Ok(())
        } else {
            Err(io::Error::from(io::ErrorKind::UnexpectedEof).into())
        }
    }
}

/// Reads what a [`StateWriter`] has written.
pub struct StateReader<'a>(&'a mut dyn Read);

impl<'a> StateReader<'a> {
    /// Reads from `from`.
    pub fn new(from: &'a mut dyn Read) -> StateReader<'a> {
        StateReader(from)
    }

    /// Reads the next value.
    ///
    /// # Errors
    /// Those of what it reads from, and where there is another value, as far as that can be seen.
    pub fn take<T: DeserializeOwned>(&mut self) -> Result<T, StateError> {
        let mut bytes = Vec::new();
        self.copy(&mut bytes)?;
        Ok(postcard::from_bytes(&bytes)?)
    }

    /// Reads what [`StateWriter::copy`] has written.
    ///
    /// # Errors
    /// Those of both ends, and where there are fewer bytes than it says.
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

/// Says of each field of a type whether its state is a value (`values`), in it (`parts`), or nothing that would not be the same in
/// another one that has been made in the same way (`same`). A field of which nothing is said does not compile.
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
