//! Text on its way to a file: numbers quickly, a piece at a time, so that no file is held in memory.

use std::fmt;
use std::io::{self, Write};

/// Bytes that are held before they are passed on.
const PIECE: usize = 1 << 16;

/// Text that goes to a sink; `write!` works on it and does not fail, [`Text::finish`] tells the first error of the sink.
pub(super) struct Text<'w> {
    sink: &'w mut dyn Write,
    piece: Vec<u8>,
    outcome: io::Result<()>,
}

impl<'w> Text<'w> {
    /// Without text yet.
    pub(super) fn to(sink: &'w mut dyn Write) -> Self {
        Self { sink, piece: Vec::with_capacity(PIECE + PIECE / 8), outcome: Ok(()) }
    }

    /// Text as it is.
    pub(super) fn push(&mut self, text: &str) {
        self.piece.extend_from_slice(text.as_bytes());
        if self.piece.len() >= PIECE {
            self.pass_on();
        }
    }

    /// A whole number.
    pub(super) fn integer(&mut self, number: impl itoa::Integer) {
        self.push(itoa::Buffer::new().format(number));
    }

    /// A number in the shortest form that reads back to the same bits, with an exponent where that is shorter.
    pub(super) fn number(&mut self, number: f64) {
        let mut buffer = zmij::Buffer::new();
        let digits = buffer.format(number);
        self.push(digits.strip_suffix(".0").unwrap_or(digits));
    }

    /// Passes on what is left.
    ///
    /// # Errors
    /// The first of the sink; nothing was passed on after it.
    pub(super) fn finish(mut self) -> io::Result<()> {
        self.pass_on();
        self.outcome
    }

    fn pass_on(&mut self) {
        if self.outcome.is_ok() {
            self.outcome = self.sink.write_all(&self.piece);
        }
        self.piece.clear();
    }
}

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.push(text);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    fn written(write: impl FnOnce(&mut Text)) -> String {
        let mut sink = Vec::new();
        let mut text = Text::to(&mut sink);
        write(&mut text);
        text.finish().expect("a sink that takes all");
        String::from_utf8(sink).expect("text")
    }

    #[test]
    fn numbers_are_as_short_as_they_can_be_and_read_back_to_the_same_bits() {
        let numbers = [0.0, -0.0, 1.0, -2.5, 0.1, 1.0 / 3.0, 1e-300, 5e-324, 1e300, f64::MAX, 123_456_789.0, 1e21];
        for number in numbers {
            let text = written(|out| out.number(number));
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(number.to_bits()), "{text}");
            assert!(text.len() <= format!("{number}").len().max(24), "{text}");
        }
        assert_eq!(written(|out| out.number(3.0)), "3");
        assert_eq!(written(|out| out.integer(-7)), "-7");
    }

    #[test]
    fn pieces_come_in_order() {
        let text = written(|out| (0..100_000).for_each(|k| writeln!(out, "{k}").expect("a text")));
        assert!(text.lines().enumerate().all(|(k, line)| line == k.to_string()));
        assert_eq!(text.lines().count(), 100_000);
    }

    #[test]
    fn the_first_error_of_the_sink_is_told() {
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                self.0 = self.0.checked_sub(1).ok_or(io::ErrorKind::StorageFull)?;
                Ok(bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut sink = Full(2);
        let mut text = Text::to(&mut sink);
        (0..100_000).for_each(|k| text.integer(k));
        assert_eq!(text.finish().map_err(|error| error.kind()), Err(io::ErrorKind::StorageFull));
    }
}
