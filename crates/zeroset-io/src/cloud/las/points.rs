//! Point records of formats 0 to 10.

use rayon::prelude::*;
use zeroset::cloud::Attributes;

use super::header::Header;
use crate::cloud::Columns;
use crate::cloud::columns::{colors_from_u16, is_wide};

/// Where the values of interest are in a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record {
    pub(super) length: usize,
    scale: [f64; 3],
    offset: [f64; 3],
    /// Formats from 6 have wider flags and a whole byte for the class.
    extended: bool,
    color_at: Option<usize>,
}

impl Record {
    pub(super) fn of(header: &Header) -> Self {
        let color_at = match header.point_format {
            2 => Some(20),
            3 | 5 => Some(28),
            7 | 8 | 10 => Some(30),
            _ => None,
        };
        Self {
            length: header.record_length,
            scale: header.scale,
            offset: header.offset,
            extended: header.point_format >= 6,
            color_at,
        }
    }
}

/// The columns while they are filled, in parallel and in any order.
#[derive(Debug, Default)]
pub(crate) struct Table {
    points: Vec<[f64; 3]>,
    intensities: Vec<u16>,
    classes: Vec<u8>,
    withheld: Vec<bool>,
    colors: Vec<[u16; 3]>,
}

/// What only all rows of a file tell of its values. A column of zeros is there only because the format asks for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Values {
    has_intensities: bool,
    has_colors: bool,
    /// Whether colours need 16 bits.
    wide_colors: bool,
}

impl Values {
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            has_intensities: self.has_intensities || other.has_intensities,
            has_colors: self.has_colors || other.has_colors,
            wide_colors: self.wide_colors || other.wide_colors,
        }
    }
}

/// A run of rows of the table.
pub(super) struct Rows<'a> {
    points: &'a mut [[f64; 3]],
    intensities: &'a mut [u16],
    classes: &'a mut [u8],
    withheld: &'a mut [bool],
    colors: &'a mut [[u16; 3]],
}

impl Table {
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn resize(&mut self, count: usize, record: &Record) {
        self.points.resize(count, [0.0; 3]);
        self.intensities.resize(count, 0);
        self.classes.resize(count, 0);
        self.withheld.resize(count, false);
        self.colors.resize(if record.color_at.is_some() { count } else { 0 }, [0; 3]);
    }

    /// Splits the rows into runs of the given lengths, which add up to no more than there are rows.
    pub(super) fn split<'a>(&'a mut self, lengths: impl Iterator<Item = usize>) -> Vec<Rows<'a>> {
        let mut rest = Rows {
            points: &mut self.points,
            intensities: &mut self.intensities,
            classes: &mut self.classes,
            withheld: &mut self.withheld,
            colors: &mut self.colors,
        };
        lengths.map(|length| rest.split_off_front(length)).collect()
    }

    /// Decodes all rows out of uncompressed records.
    pub(super) fn fill(&mut self, record: &Record, bytes: &[u8]) {
        const RUN: usize = 1 << 14;
        let count = self.points.len();
        let lengths = (0..count).step_by(RUN).map(|start| RUN.min(count - start));
        let runs = self.split(lengths);
        runs.into_par_iter().zip(bytes.par_chunks(RUN * record.length)).for_each(|(mut rows, bytes)| {
            for (row, bytes) in bytes.chunks_exact(record.length).enumerate() {
                rows.set(row, record, bytes);
            }
        });
    }

    /// What the rows tell of the values of the file.
    pub(crate) fn values(&self) -> Values {
        let colors = self.colors.iter().flatten();
        Values {
            has_intensities: self.intensities.iter().any(|v| *v != 0),
            has_colors: colors.clone().any(|v| *v != 0),
            wide_colors: is_wide(colors),
        }
    }

    /// The rows, as part of a file that has these values.
    pub(super) fn into_columns(self, values: Values) -> Columns {
        let intensities = values.has_intensities.then(|| self.intensities.iter().map(|v| f32::from(*v)).collect());
        let colors = values.has_colors.then(|| colors_from_u16(&self.colors, values.wide_colors));
        let classes = Some(self.classes);
        let withheld = if self.withheld.contains(&true) { self.withheld } else { Vec::new() };
        Columns {
            points: self.points,
            attributes: Attributes { colors, intensities, classes },
            withheld,
            ..Columns::default()
        }
    }
}

impl<'a> Rows<'a> {
    fn split_off_front(&mut self, length: usize) -> Self {
        fn front<'a, T>(slice: &mut &'a mut [T], length: usize) -> &'a mut [T] {
            let length = length.min(slice.len());
            let (front, rest) = std::mem::take(slice).split_at_mut(length);
            *slice = rest;
            front
        }
        Self {
            points: front(&mut self.points, length),
            intensities: front(&mut self.intensities, length),
            classes: front(&mut self.classes, length),
            withheld: front(&mut self.withheld, length),
            colors: front(&mut self.colors, length),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Decodes one record, which has the full length.
    #[inline]
    pub(super) fn set(&mut self, row: usize, record: &Record, bytes: &[u8]) {
        let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        for axis in 0..3 {
            let at = 4 * axis;
            let raw = i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
            self.points[row][axis] = f64::from(raw) * record.scale[axis] + record.offset[axis];
        }
        self.intensities[row] = word(12);
        if record.extended {
            self.classes[row] = bytes[16];
            self.withheld[row] = bytes[15] & 0b100 != 0;
        } else {
            self.classes[row] = bytes[15] & 0b1_1111;
            self.withheld[row] = bytes[15] & 0b1000_0000 != 0;
        }
        if let Some(at) = record.color_at {
            self.colors[row] = [word(at), word(at + 2), word(at + 4)];
        }
    }
}
