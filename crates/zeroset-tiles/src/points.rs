//! The points of a tile as a file. Positions are world positions.

use std::path::Path;

use zeroset::cloud::{Attributes, Cloud};
use zeroset_io::{NO_CLASS, NO_COLOR, NO_INTENSITY};

use crate::TilesError;
use crate::binary::{In, Out, read};

/// Which values any of the points have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Values {
    /// Colours.
    pub colors: bool,
    /// Intensities.
    pub intensities: bool,
    /// Classes.
    pub classes: bool,
}

impl Values {
    pub(crate) fn of(attributes: &Attributes) -> Self {
        Self {
            colors: attributes.colors.is_some(),
            intensities: attributes.intensities.is_some(),
            classes: attributes.classes.is_some(),
        }
    }

    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            colors: self.colors || other.colors,
            intensities: self.intensities || other.intensities,
            classes: self.classes || other.classes,
        }
    }
}

/// A segment with some of the points of a cloud.
pub(crate) fn segment(cloud: &Cloud, which: &[u32]) -> Out {
    fn pick<T: Copy>(values: Option<&Vec<T>>, which: &[u32]) -> Option<Vec<T>> {
        values.map(|values| which.iter().map(|&i| values[i as usize]).collect())
    }
    let mut out = Out::default();
    out.list(&which.iter().map(|&i| cloud.world(i as usize)).collect::<Vec<[f64; 3]>>());
    out.option(pick(cloud.attributes.colors.as_ref(), which).as_ref());
    out.option(pick(cloud.attributes.intensities.as_ref(), which).as_ref());
    out.option(pick(cloud.attributes.classes.as_ref(), which).as_ref());
    out
}

/// Adds the points of a file to a cloud. Points without a value that others have get what stands for none.
pub(crate) fn read_points(path: &Path, cloud: Cloud, values: Values) -> Result<Cloud, TilesError> {
    let bytes = read(path)?;
    parse(&bytes, cloud, values).ok_or_else(|| TilesError::damaged(path))
}

fn parse(bytes: &[u8], mut cloud: Cloud, values: Values) -> Option<Cloud> {
    let offset = cloud.world_from_local;
    let mut colors = cloud.attributes.colors.take().unwrap_or_default();
    let mut intensities = cloud.attributes.intensities.take().unwrap_or_default();
    let mut classes = cloud.attributes.classes.take().unwrap_or_default();
    let mut rest = In::new(bytes);
    while !rest.is_at_end() {
        let world = rest.list::<[f64; 3]>()?;
        cloud.points.extend(world.iter().map(|p| -> [f64; 3] { std::array::from_fn(|a| p[a] - offset[a]) }));
        colors.extend(rest.option::<[u8; 3]>()?.unwrap_or_default());
        colors.resize(cloud.len(), NO_COLOR);
        intensities.extend(rest.option::<f32>()?.unwrap_or_default());
        intensities.resize(cloud.len(), NO_INTENSITY);
        classes.extend(rest.option::<u8>()?.unwrap_or_default());
        classes.resize(cloud.len(), NO_CLASS);
    }
    cloud.attributes = Attributes {
        colors: values.colors.then_some(colors),
        intensities: values.intensities.then_some(intensities),
        classes: values.classes.then_some(classes),
    };
    Some(cloud)
}
