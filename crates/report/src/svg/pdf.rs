//! Conversion of a drawing to a PDF page of the same size. Text remains text, with an embedded
//! font.
use std::collections::BTreeMap;
use std::io::{self, Write as _};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, SystemInfo, TextRenderingMode, UnicodeCmap,
};
use pdf_writer::{Content, Filter, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};
use stochc_files::checksum::crc32;
use stochc_text::palette::Rgb;
use subsetter::GlyphRemapper;

use super::Drawing;
use super::letters::{self, FACE, FONT};
use super::medium::TYPE;
use super::shape::{DrawnShape, Form, Point, TextAnchor};
use super::style::{Paint, Style, on_paper};

/// Identifier of the encoding. The character codes of the embedded font are its glyph numbers.
const CODES: SystemInfo = SystemInfo {
    registry: Str(b"Adobe"),
    ordering: Str(b"Identity"),
    supplement: 0,
};
const FONT_NAME: Name = Name(b"F");

/// Opacity of areas, then opacity of lines, in thousandths.
type Opacity = (u32, u32);

struct PdfPage {
    content: Content,
    /// Number of points per unit of the drawing.
    unit: f64,
    /// Height of the page \[pt\].
    height: f64,
    opacities: Vec<Opacity>,
    glyphs: GlyphRemapper,
    /// Old glyph number and character of each used glyph, by new glyph number.
    signs: BTreeMap<u16, (u16, Option<char>)>,
}

impl Drawing {
    /// Returns the drawing as a PDF file, in the colours for white paper.
    ///
    /// # Errors
    ///
    /// If the font cannot be reduced to the used glyphs.
    pub fn pdf(&self) -> io::Result<Vec<u8>> {
        let unit = self.medium.unit();
        let (width, height) = self.size();
        let mut page = PdfPage {
            content: Content::new(),
            unit,
            height: height * unit,
            opacities: Vec::new(),
            glyphs: GlyphRemapper::new(),
            signs: BTreeMap::from([(0, (0, None))]),
        };
        page.content.set_line_cap(LineCapStyle::ButtCap);
        for shape in self.shapes() {
            page.draw(shape);
        }
        page.finish(width * unit, &self.title)
    }
}

impl PdfPage {
    fn at(&self, (x, y): Point) -> (f32, f32) {
        ((x * self.unit) as f32, (self.height - y * self.unit) as f32)
    }

    fn length(&self, length: f64) -> f32 {
        (length * self.unit) as f32
    }

    fn draw(&mut self, shape: &DrawnShape) {
        let mut style = on_paper(&shape.class).then(shape.own);
        let mut dashes = "";
        match &shape.form {
            Form::PlotAxis | Form::AxisEnd => return,
            Form::Line(..) => style.fill = Some(Paint::Nothing),
            Form::Curve(_, lengths) => dashes = lengths,
            _ => {}
        }
        // In PDF, colours and line styles must precede a path.
        self.content.save_state();
        let painted = self.prepare(style, dashes);
        match &shape.form {
            Form::Line(from, to) => self.path(&[*from, *to]),
            Form::Curve(points, _) => self.path(points),
            Form::Area(points) => {
                self.path(points);
                self.content.close_path();
            }
            Form::Rectangle((x, y), (width, height)) => {
                let (left, bottom) = self.at((*x, y + height));
                let (width, height) = (self.length(*width), self.length(*height));
                self.content.rect(left, bottom, width, height);
            }
            Form::Disc(centre, radius) => self.circle(*centre, *radius),
            Form::Text(point, anchor, text) => self.text(*point, *anchor, text, painted),
            Form::PlotAxis | Form::AxisEnd => {}
        }
        if !matches!(shape.form, Form::Text(..)) {
            match painted {
                (true, true) => self.content.fill_nonzero_and_stroke(),
                (true, false) => self.content.fill_nonzero(),
                (false, true) => self.content.stroke(),
                (false, false) => self.content.end_path(),
            };
        }
        self.content.restore_state();
    }

    /// Adds a path through several points.
    fn path(&mut self, points: &[Point]) {
        for (i, &point) in points.iter().enumerate() {
            let (x, y) = self.at(point);
            match i {
                0 => self.content.move_to(x, y),
                _ => self.content.line_to(x, y),
            };
        }
    }

    /// Adds a circle of four cubic curves. They deviate from a circle by less than 0.03 % of its
    /// radius.
    fn circle(&mut self, (x, y): Point, radius: f64) {
        const REACH: f64 = 0.552_284_75;
        let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        let point = |(dx, dy): Point| self.at((x + radius * dx, y + radius * dy));
        let curves: Vec<_> = (0..4)
            .map(|i| {
                let (from, to) = (corners[i], corners[(i + 1) % 4]);
                let first = point((from.0 + REACH * to.0, from.1 + REACH * to.1));
                let second = point((to.0 + REACH * from.0, to.1 + REACH * from.1));
                (first, second, point(to))
            })
            .collect();
        let start = point(corners[0]);
        self.content.move_to(start.0, start.1);
        for (first, second, to) in curves {
            self.content
                .cubic_to(first.0, first.1, second.0, second.1, to.0, to.1);
        }
        self.content.close_path();
    }

    /// Sets the style of the next path. Returns whether to fill it and whether to stroke it.
    fn prepare(&mut self, style: Style, dashes: &str) -> (bool, bool) {
        let part = |own: Option<f64>| {
            let share = own.unwrap_or(1.0) * style.opacity.unwrap_or(1.0);
            (1000.0 * share.clamp(0.0, 1.0)).round() as u32
        };
        let opacity = (part(style.fill_opacity), part(style.stroke_opacity));
        if opacity != (1000, 1000) {
            let known = self.opacities.iter().position(|it| *it == opacity);
            let number = known.unwrap_or(self.opacities.len());
            if known.is_none() {
                self.opacities.push(opacity);
            }
            let name = format!("G{number}");
            self.content.set_parameters(Name(name.as_bytes()));
        }
        let (fill, stroke) = (colour(style.fill), colour(style.stroke));
        if let Some([red, green, blue]) = fill {
            self.content.set_fill_rgb(red, green, blue);
        }
        if let Some([red, green, blue]) = stroke {
            self.content.set_stroke_rgb(red, green, blue);
            let width = self.length(style.width.unwrap_or(1.0));
            self.content.set_line_width(width);
        }
        let lengths = dashes.split_whitespace().filter_map(|it| it.parse().ok());
        let lengths: Vec<f32> = lengths.map(|length: f64| self.length(length)).collect();
        if !lengths.is_empty() {
            self.content.set_dash_pattern(lengths, 0.0);
        }
        (fill.is_some(), stroke.is_some())
    }

    fn text(
        &mut self,
        point: Point,
        anchor: TextAnchor,
        text: &str,
        (_, is_outlined): (bool, bool),
    ) {
        let before = match anchor {
            TextAnchor::Start => 0.0,
            TextAnchor::Middle => letters::width(text) / 2.0,
            TextAnchor::End => letters::width(text),
        };
        let (x, y) = self.at((point.0 - before, point.1));
        let codes = self.codes(text);
        let size = self.length(TYPE);
        let modes: &[TextRenderingMode] = if is_outlined {
            &[TextRenderingMode::Stroke, TextRenderingMode::Fill]
        } else {
            &[TextRenderingMode::Fill]
        };
        for &mode in modes {
            let is_outline = mode == TextRenderingMode::Stroke;
            if is_outline {
                // The halo of text is marked so that screen readers skip it.
                let mut span = (self.content).begin_marked_content_with_properties(Name(b"Span"));
                span.properties().actual_text(TextStr(""));
            }
            self.content
                .begin_text()
                .set_font(FONT_NAME, size)
                .set_text_rendering_mode(mode)
                .set_text_matrix([1.0, 0.0, 0.0, 1.0, x, y])
                .show(Str(&codes))
                .end_text();
            if is_outline {
                self.content.end_marked_content();
            }
        }
    }

    /// Returns the glyph numbers of a text, two bytes per character. A character that the font
    /// lacks becomes the glyph for missing characters.
    fn codes(&mut self, text: &str) -> Vec<u8> {
        let mut codes = Vec::new();
        for sign in text.chars() {
            let glyph = FACE.glyph_index(sign).map_or(0, |glyph| glyph.0);
            let code = self.glyphs.remap(glyph);
            self.signs.entry(code).or_insert((glyph, Some(sign)));
            codes.extend(code.to_be_bytes());
        }
        codes
    }

    /// Returns the name of the reduced font. Its first six letters depend on the used glyphs. Fonts
    /// of several figures in one document therefore have different names.
    fn base_font(&self) -> String {
        let glyphs = self
            .signs
            .values()
            .flat_map(|(glyph, _)| glyph.to_be_bytes());
        let mut digest = crc32(&glyphs.collect::<Vec<u8>>());
        let letters = (0..6).map(|_| {
            let letter = char::from(b'A' + (digest % 26) as u8);
            digest /= 26;
            letter
        });
        format!("{}+LiberationSans", letters.collect::<String>())
    }

    fn finish(self, width: f64, title: &str) -> io::Result<Vec<u8>> {
        let [
            catalog,
            pages,
            page,
            content,
            info,
            font,
            cid,
            descriptor,
            data,
            unicode,
        ] = std::array::from_fn(|i| Ref::new(i as i32 + 1));
        let base_font = self.base_font();
        let base_font = Name(base_font.as_bytes());
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages).lang(TextStr("en"));
        pdf.document_info(info)
            .title(TextStr(title))
            .creator(TextStr(concat!("stochc ", env!("CARGO_PKG_VERSION"))));
        pdf.pages(pages).kids([page]).count(1);
        let mut leaf = pdf.page(page);
        leaf.parent(pages);
        leaf.media_box(Rect::new(0.0, 0.0, width as f32, self.height as f32));
        leaf.contents(content);
        let mut resources = leaf.resources();
        resources.fonts().pair(FONT_NAME, font);
        let mut states = resources.ext_g_states();
        for (number, (fill, stroke)) in self.opacities.iter().enumerate() {
            let name = format!("G{number}");
            let mut state = states.insert(Name(name.as_bytes())).start();
            pdf_writer::writers::ExtGraphicsState::non_stroking_alpha(
                &mut state,
                *fill as f32 / 1000.0,
            );
            state.stroking_alpha(*stroke as f32 / 1000.0);
        }
        states.finish();
        resources.finish();
        leaf.finish();
        let drawn = compressed(&self.content.finish())?;
        pdf.stream(content, &drawn).filter(Filter::FlateDecode);

        // PDF measures glyphs in thousandths of the font size.
        let scale = 1000.0 / f32::from(FACE.units_per_em());
        pdf.type0_font(font)
            .base_font(base_font)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(unicode);
        let mut descendant = pdf.cid_font(cid);
        descendant
            .subtype(CidFontType::Type2)
            .base_font(base_font)
            .system_info(CODES)
            .font_descriptor(descriptor)
            .default_width(0.0)
            .cid_to_gid_map_predefined(Name(b"Identity"));
        let widths = self.signs.values().map(|(glyph, _)| {
            let advance = FACE.glyph_hor_advance(ttf_parser::GlyphId(*glyph));
            scale * f32::from(advance.unwrap_or(0))
        });
        // Glyph numbers are consecutive from 0.
        descendant.widths().consecutive(0, widths);
        descendant.finish();
        let bounds = FACE.global_bounding_box();
        let end = |end: i16| scale * f32::from(end);
        pdf.font_descriptor(descriptor)
            .name(base_font)
            .flags(FontFlags::NON_SYMBOLIC)
            .bbox(Rect::new(
                end(bounds.x_min),
                end(bounds.y_min),
                end(bounds.x_max),
                end(bounds.y_max),
            ))
            .italic_angle(0.0)
            .ascent(end(FACE.ascender()))
            .descent(end(FACE.descender()))
            .cap_height(end(FACE.capital_height().unwrap_or(FACE.ascender())))
            .stem_v(80.0)
            .font_file2(data);
        let subset = subsetter::subset(FONT, 0, &self.glyphs).map_err(io::Error::other)?;
        let length = subset.len() as i32;
        let subset = compressed(&subset)?;
        pdf.stream(data, &subset)
            .filter(Filter::FlateDecode)
            .pair(Name(b"Length1"), length);
        let mut meanings = UnicodeCmap::new(Name(b"Custom"), CODES);
        for (code, (_, sign)) in &self.signs {
            if let Some(sign) = sign {
                meanings.pair(*code, *sign);
            }
        }
        let meanings = compressed(&meanings.finish())?;
        pdf.cmap(unicode, &meanings).filter(Filter::FlateDecode);
        Ok(pdf.finish())
    }
}

fn colour(paint: Option<Paint>) -> Option<[f32; 3]> {
    match paint {
        Some(Paint::Colour(Rgb(red, green, blue))) => {
            Some([red, green, blue].map(|part| f32::from(part) / 255.0))
        }
        _ => None,
    }
}

fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    encoder.finish()
}

#[cfg(test)]
mod tests {
    use super::super::Medium;
    use super::*;

    /// Checks that a PDF page has the requested size, and that equal drawings give equal files.
    #[test]
    fn a_page_is_as_large_as_the_figure() {
        let mut out = Drawing::new(Medium::Print(89.0), "n", "A title", "d").high(240.0);
        out.text("ink halo", (10.0, 20.0), "wait [s] ≥ µ шум ⟨");
        out.curve("s0", &[(0.0, 0.0), (50.0, 40.0), (90.0, 10.0)], "7 3");
        out.disc("rest faint", (40.0, 40.0), 5.0, "told");
        let file = out.pdf().unwrap();
        assert_eq!(file, out.pdf().unwrap());
        let text = String::from_utf8_lossy(&file);
        assert!(text.starts_with("%PDF-1."));
        assert!(text.contains("/MediaBox [0 0 252.28346 140]"), "{text}");
        assert!(text.contains("/FontFile2") && text.contains("/ToUnicode"));
        out.text("ink", (10.0, 40.0), "another sign: q");
        let name = |file: &[u8]| {
            let text = String::from_utf8_lossy(file).into_owned();
            let end = text.find("+LiberationSans").unwrap();
            text[end - 6..end].to_owned()
        };
        assert_ne!(name(&file), name(&out.pdf().unwrap()));
        // Only a few of the font's 2,600 glyphs remain.
        assert!(file.len() < 20_000, "{}", file.len());
    }
}
