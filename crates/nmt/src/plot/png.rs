//! SVG text → PNG bytes; the only file that names resvg.
//!
//! Text is drawn with the fonts of `assets/` alone (Liberation Sans 2.1.5, unmodified, SIL Open Font License 1.1, see
//! `assets/LiberationSans-OFL.txt`): the bytes depend on no font of the machine.

use std::sync::Arc;

use resvg::{tiny_skia, usvg};

/// Pixels to a page unit: 1000 page units on 180 mm of paper are then printed at 280 dots an inch.
const PIXELS_PER_UNIT: f32 = 2.0;

/// Largest number of pixels of a picture; four bytes each must fit in memory with ease.
const MOST_PIXELS: f64 = 1.0e8;

/// Family drawn where the SVG names none that is known.
const FAMILY: &str = "Liberation Sans";

static FONTS: [&[u8]; 2] = [
    include_bytes!("../../assets/LiberationSans-Regular.ttf"),
    include_bytes!("../../assets/LiberationSans-Italic.ttf"),
];

/// What can go wrong in making a PNG.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The text is no SVG that can be drawn.
    #[error("the picture is no valid SVG: {reason}; give the text that a `*_figure` function returned")]
    BadSvg {
        /// What the SVG reader says.
        reason: String,
    },
    /// The picture would need too much memory.
    #[error("a picture of {width} by {height} pixels is too large to draw; make the SVG's width and height smaller")]
    TooLarge {
        /// Pixels across.
        width: f64,
        /// Pixels down.
        height: f64,
    },
    /// The pixels could not be written as PNG.
    #[error("the picture could not be written as PNG: {reason}; use the SVG instead")]
    Encoding {
        /// What the PNG writer says.
        reason: String,
    },
}

/// PNG bytes of `svg`, two pixels to a page unit: figures of this module are up to about 2000 pixels wide.
///
/// # Errors
/// [`PlotError::BadSvg`] where the text is not SVG, [`PlotError::TooLarge`] above 1e8 pixels, [`PlotError::Encoding`] where
/// the PNG writer fails.
pub fn png(svg: &str) -> Result<Vec<u8>, PlotError> {
    let mut fonts = usvg::fontdb::Database::new();
    for font in FONTS {
        fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(font)));
    }
    fonts.set_sans_serif_family(FAMILY);
    let options = usvg::Options { font_family: FAMILY.to_owned(), fontdb: Arc::new(fonts), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| PlotError::BadSvg { reason: e.to_string() })?;

    let (width, height) = (tree.size().width() * PIXELS_PER_UNIT, tree.size().height() * PIXELS_PER_UNIT);
    let (width, height) = (f64::from(width.ceil()), f64::from(height.ceil()));
    let too_large = PlotError::TooLarge { width, height };
    if width * height > MOST_PIXELS {
        return Err(too_large);
    }
    let mut pixels = tiny_skia::Pixmap::new(width as u32, height as u32).ok_or(too_large)?;
    let zoom = tiny_skia::Transform::from_scale(PIXELS_PER_UNIT, PIXELS_PER_UNIT);
    resvg::render(&tree, zoom, &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| PlotError::Encoding { reason: e.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(width: &str, content: &str) -> String {
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"20\">{content}</svg>")
    }

    #[test]
    fn a_png_has_two_pixels_to_a_page_unit() {
        let bytes = png(&page("30", "")).unwrap();
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(&bytes[16..24], &[0, 0, 0, 60, 0, 0, 0, 40]);
    }

    #[test]
    fn text_is_drawn_with_the_font_we_ship() {
        let text = |t: &str| png(&page("60", &format!("<text x=\"2\" y=\"15\" font-size=\"12\">{t}</text>"))).unwrap();
        assert_ne!(text("τ"), text(""));
        assert_ne!(text("τ"), text("x"));
        assert_eq!(text("τ"), text("τ"));
    }

    #[test]
    fn what_is_no_svg_and_what_is_too_large_are_errors() {
        assert!(matches!(png("no picture"), Err(PlotError::BadSvg { .. })));
        assert!(matches!(png(&page("1e9", "")), Err(PlotError::TooLarge { .. })));
    }
}
