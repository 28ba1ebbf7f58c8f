//! Deserializes parameters from TOML values, and locates the value that has a wrong type.
//!
//! The crate is optimized in development builds, and generic deserializers were half of its code. This deserializer
//! has one function for all types of values.

use std::fmt;
use std::slice;

use serde::de::value::StrDeserializer;
use serde::de::{self, DeserializeOwned, DeserializeSeed, IntoDeserializer, Unexpected, Visitor};
use serde::forward_to_deserialize_any;
use toml::{Table, Value};

/// Deserializes a value from TOML.
///
/// # Errors
/// Returns the first error and its location.
pub(crate) fn deserialize<T: DeserializeOwned>(value: &Value) -> Result<T, LocatedError> {
    T::deserialize(ValueDeserializer(value))
}

/// An invalid value and its location.
#[derive(Debug)]
pub(crate) struct LocatedError {
    /// Keys and list indexes that lead to the value, from the innermost to the outermost.
    reversed_path: Vec<String>,
    /// Reason why the value is invalid.
    pub(crate) message: String,
}

impl LocatedError {
    /// Returns the keys and list indexes that lead to the value, separated by dots.
    pub(crate) fn path(&self) -> String {
        self.reversed_path.iter().rev().map(String::as_str).collect::<Vec<_>>().join(".")
    }

    fn nested_under(mut self, part: impl fmt::Display) -> LocatedError {
        self.reversed_path.push(part.to_string());
        self
    }
}

impl fmt::Display for LocatedError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.path(), self.message)
    }
}

impl std::error::Error for LocatedError {}

impl de::Error for LocatedError {
    fn custom<T: fmt::Display>(message: T) -> LocatedError {
        LocatedError { reversed_path: Vec::new(), message: message.to_string() }
    }
}

struct ValueDeserializer<'a>(&'a Value);

impl<'a> ValueDeserializer<'a> {
    fn unexpected(&self) -> Unexpected<'a> {
        match self.0 {
            Value::String(text) => Unexpected::Str(text),
            Value::Integer(number) => Unexpected::Signed(*number),
            Value::Float(number) => Unexpected::Float(*number),
            Value::Boolean(holds) => Unexpected::Bool(*holds),
            Value::Datetime(_) => Unexpected::Other("date"),
            Value::Array(_) => Unexpected::Seq,
            Value::Table(_) => Unexpected::Map,
        }
    }
}

impl<'de> de::Deserializer<'de> for ValueDeserializer<'de> {
    type Error = LocatedError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, LocatedError> {
        match self.0 {
            Value::String(text) => visitor.visit_str(text),
            Value::Integer(number) => visitor.visit_i64(*number),
            Value::Float(number) => visitor.visit_f64(*number),
            Value::Boolean(holds) => visitor.visit_bool(*holds),
            Value::Datetime(_) => Err(de::Error::invalid_type(self.unexpected(), &visitor)),
            Value::Array(values) => {
                let mut elements = Elements { values: values.iter(), read: 0 };
                let list = visitor.visit_seq(&mut elements)?;
                match elements.values.len() {
                    0 => Ok(list),
                    _ => Err(de::Error::invalid_length(values.len(), &"fewer elements in array")),
                }
            }
            Value::Table(table) => visitor.visit_map(Entries { entries: table.iter(), current: None }),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, LocatedError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, LocatedError> {
        visitor.visit_newtype_struct(self)
    }

    /// Enums of parameters have no fields, so they are texts.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, LocatedError> {
        match self.0 {
            Value::String(variant) => {
                let variant: StrDeserializer<'_, LocatedError> = variant.as_str().into_deserializer();
                visitor.visit_enum(variant)
            }
            _ => Err(de::Error::invalid_type(self.unexpected(), &"a string")),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq
        tuple tuple_struct map struct identifier ignored_any
    }
}

struct Elements<'a> {
    values: slice::Iter<'a, Value>,
    read: usize,
}

impl<'de> de::SeqAccess<'de> for Elements<'de> {
    type Error = LocatedError;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, LocatedError> {
        let Some(value) = self.values.next() else { return Ok(None) };
        let element = seed.deserialize(ValueDeserializer(value));
        let element = element.map_err(|error| error.nested_under(self.read))?;
        self.read += 1;
        Ok(Some(element))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.values.len())
    }
}

struct Entries<'a> {
    entries: <&'a Table as IntoIterator>::IntoIter,
    current: Option<(&'a String, &'a Value)>,
}

impl<'de> de::MapAccess<'de> for Entries<'de> {
    type Error = LocatedError;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, LocatedError> {
        self.current = self.entries.next();
        let Some((key, _)) = self.current else { return Ok(None) };
        let name: StrDeserializer<'_, LocatedError> = key.as_str().into_deserializer();
        seed.deserialize(name).map(Some).map_err(|error| error.nested_under(key))
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, LocatedError> {
        let (key, value) = self.current.expect("serde reads a value only after its key");
        seed.deserialize(ValueDeserializer(value)).map_err(|error| error.nested_under(key))
    }
}
