//! SQL's mathematical functions, with the semantics that SQLite documents
//! (<https://www.sqlite.org/lang_mathfunc.html>).
//!
//! The functions are registered on each connection that compiles or runs statements, so that they are available with
//! every build of SQLite. The library `libm` computes the results, which are therefore identical on all machines.

use std::f64::consts::PI;

use rusqlite::Connection;
use rusqlite::functions::{Context, FunctionFlags};
use rusqlite::types::{Value, ValueRef};

type UnaryFunction = fn(f64) -> f64;
type BinaryFunction = fn(f64, f64) -> f64;

/// Functions that return an integer argument unchanged as an integer.
const ROUNDING_FUNCTIONS: [(&str, UnaryFunction); 4] =
    [("ceil", libm::ceil), ("ceiling", libm::ceil), ("floor", libm::floor), ("trunc", libm::trunc)];

/// Functions with one argument. A NaN result becomes NULL.
const UNARY_FUNCTIONS: [(&str, UnaryFunction); 20] = [
    ("acos", libm::acos),
    ("acosh", libm::acosh),
    ("asin", libm::asin),
    ("asinh", libm::asinh),
    ("atan", libm::atan),
    ("atanh", libm::atanh),
    ("cos", libm::cos),
    ("cosh", libm::cosh),
    ("degrees", |x| x * (180.0 / PI)),
    ("exp", libm::exp),
    ("ln", |x| logarithm_of_positive(libm::log, x)),
    ("log", |x| logarithm_of_positive(libm::log10, x)),
    ("log10", |x| logarithm_of_positive(libm::log10, x)),
    ("log2", |x| logarithm_of_positive(libm::log2, x)),
    ("radians", |x| x * (PI / 180.0)),
    ("sin", libm::sin),
    ("sinh", libm::sinh),
    ("sqrt", libm::sqrt),
    ("tan", libm::tan),
    ("tanh", libm::tanh),
];

/// Functions with two arguments. A NaN result becomes NULL.
const BINARY_FUNCTIONS: [(&str, BinaryFunction); 5] = [
    ("atan2", libm::atan2),
    ("log", log_to_base),
    ("mod", libm::fmod),
    ("pow", libm::pow),
    ("power", libm::pow),
];

/// Registers SQL's mathematical functions on a connection.
///
/// # Errors
/// SQLite cannot register a function on the connection.
pub fn register_math_functions(connection: &Connection) -> rusqlite::Result<()> {
    let flags =
        FunctionFlags::SQLITE_UTF8 | FunctionFlags::SQLITE_DETERMINISTIC | FunctionFlags::SQLITE_INNOCUOUS;
    for (name, function) in ROUNDING_FUNCTIONS {
        connection.create_scalar_function(name, 1, flags, move |arguments| {
            Ok(match number_argument(arguments, 0) {
                Some(Number::Real(x)) => Value::Real(function(x)),
                Some(Number::Integer(x)) => Value::Integer(x),
                None => Value::Null,
            })
        })?;
    }
    for (name, function) in UNARY_FUNCTIONS {
        connection.create_scalar_function(name, 1, flags, move |arguments| {
            Ok(number_argument(arguments, 0).map(|x| function(x.as_f64())))
        })?;
    }
    for (name, function) in BINARY_FUNCTIONS {
        connection.create_scalar_function(name, 2, flags, move |arguments| {
            Ok(number_argument(arguments, 0)
                .zip(number_argument(arguments, 1))
                .map(|(x, y)| function(x.as_f64(), y.as_f64())))
        })?;
    }
    connection.create_scalar_function("pi", 0, flags, |_| Ok(PI))
}

/// Applies a logarithm function, which is undefined for arguments of 0 and below.
fn logarithm_of_positive(logarithm: UnaryFunction, x: f64) -> f64 {
    if x > 0.0 { logarithm(x) } else { f64::NAN }
}

/// Returns the logarithm of `x` to a base, which must be greater than 1, as SQLite requires.
fn log_to_base(base: f64, x: f64) -> f64 {
    let divisor = logarithm_of_positive(libm::log, base);
    if divisor > 0.0 { logarithm_of_positive(libm::log, x) / divisor } else { f64::NAN }
}

enum Number {
    Integer(i64),
    Real(f64),
}

impl Number {
    fn as_f64(&self) -> f64 {
        match *self {
            Number::Integer(x) => x as f64,
            Number::Real(x) => x,
        }
    }
}

/// Reads a numeric argument. Returns `None` for NULL, a blob, or text that is not entirely a number.
fn number_argument(arguments: &Context<'_>, at: usize) -> Option<Number> {
    match arguments.get_raw(at) {
        ValueRef::Integer(x) => Some(Number::Integer(x)),
        ValueRef::Real(x) => Some(Number::Real(x)),
        ValueRef::Text(text) => parse_number(text),
        ValueRef::Null | ValueRef::Blob(_) => None,
    }
}

/// Parses a decimal number in SQLite's syntax, with optional surrounding white space.
fn parse_number(text: &[u8]) -> Option<Number> {
    let text = std::str::from_utf8(text).ok()?;
    let text = text.trim_matches([' ', '\t', '\n', '\x0b', '\x0c', '\r']);
    // Rust also parses `inf` and `nan`, which SQLite treats as text.
    if !text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte)) {
        return None;
    }
    let integer = text.parse().ok().map(Number::Integer);
    integer.or_else(|| text.parse().ok().map(Number::Real))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connection() -> Connection {
        let connection = Connection::open_in_memory().expect("memory");
        register_math_functions(&connection).expect("functions");
        connection
    }

    fn value(connection: &Connection, expression: &str) -> Value {
        let value = connection.query_row(&format!("SELECT {expression}"), [], |row| row.get(0));
        value.unwrap_or_else(|error| panic!("{expression}: {error}"))
    }

    #[test]
    fn functions_agree_with_those_of_sqlite() {
        // tests/python/mathematics.py computed the expected values with SQLite 3.40.1 and its built-in functions.
        let connection = connection();
        let recorded = include_str!("../../tests/data/mathematics.csv");
        let mut reader = csv::Reader::from_reader(recorded.as_bytes());
        let mut compared = 0;
        for row in reader.records() {
            let row = row.expect("a row");
            let (expression, kind, expected) = (&row[0], &row[1], &row[2]);
            match (value(&connection, expression), kind) {
                (Value::Null, "null") => {}
                (Value::Integer(found), "integer") => assert_eq!(found.to_string(), expected, "{expression}"),
                (Value::Real(found), "real") => {
                    let expected: f64 = expected.parse().expect("a number");
                    let is_equal = found == expected || ((found - expected) / expected).abs() < 1e-14;
                    assert!(is_equal, "{expression}: {found:?}, not {expected:?}");
                }
                (found, kind) => panic!("{expression}: {found:?}, not {kind} {expected}"),
            }
            compared += 1;
        }
        assert!(compared > 800, "{compared}");
    }

    #[test]
    fn text_arguments_convert_as_in_sqlite() {
        let connection = connection();
        connection.execute_batch("CREATE TABLE numbers (x NUMERIC)").expect("a table");
        let texts = [
            "",
            " ",
            "1",
            " 1 ",
            "\t-2\n",
            "+3",
            "1.",
            ".5",
            ".",
            "-",
            "+-1",
            "1e3",
            "1e",
            "e3",
            "1e+3",
            "1e+",
            "1.5e-2",
            "1_000",
            "0x10",
            "inf",
            "-inf",
            "nan",
            "infinity",
            "1 2",
            "1abc",
            "9223372036854775807",
            "9223372036854775808",
            "1e400",
            "\u{a0}1",
            "١",
        ];
        for text in texts {
            connection.execute("DELETE FROM numbers", []).expect("it is empty");
            connection.execute("INSERT INTO numbers VALUES (?1)", [text]).expect("a row");
            let converted: Value =
                connection.query_row("SELECT x FROM numbers", [], |row| row.get(0)).expect("a value");
            let is_number = !matches!(converted, Value::Text(_));
            let found: Value =
                connection.query_row("SELECT floor(?1)", [text], |row| row.get(0)).expect("a value");
            assert_eq!(found != Value::Null, is_number, "{text:?}: {found:?}");
        }
    }

    #[test]
    fn results_are_bit_identical_on_every_machine() {
        let connection = connection();
        for (expression, bits) in [
            ("exp(1.1)", libm::exp(1.1)),
            ("ln(0.3)", libm::log(0.3)),
            ("pow(1.7, 2.3)", libm::pow(1.7, 2.3)),
            ("sin(2.9)", libm::sin(2.9)),
            ("atan2(0.3, -0.7)", libm::atan2(0.3, -0.7)),
        ] {
            assert_eq!(value(&connection, expression), Value::Real(bits), "{expression}");
        }
    }
}
