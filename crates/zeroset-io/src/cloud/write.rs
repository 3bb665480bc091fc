//! Writing clouds.

use std::io::Write;
use std::path::Path;

use zeroset::cloud::Cloud;
use zeroset::mesh::Mesh;

use super::las;
use crate::mesh::{WriteOptions, WriteReport, check_attributes, check_points, tolerance, world};
use crate::number::{decimals_for, push_fixed, push_integer};
use crate::output::{Sink, write_file};
use crate::{CloudFormat, IoError};

/// Writes a cloud in world coordinates; the suffix tells the format, `-` is text on standard output.
///
/// | format | coordinates | attributes |
/// |---|---|---|
/// | PLY | float or double by [`WriteOptions::resolution`] | colours, intensity, class |
/// | XYZ, TXT, ASC | as many digits as it takes | all, named in a comment line at the top |
/// | CSV | likewise | all, named in the first line |
/// | PTS | likewise | intensity and colours |
/// | LAS, LAZ | whole multiples of 0.001, or of a smaller power of ten if the resolution asks for it | colours and intensity in 16 bits, class |
///
/// LAS holds intensities as whole numbers from 0 to 65535: shares from 0 to 1 are stretched to that, other values are
/// rounded and cut.
///
/// # Errors
/// A coordinate is not finite, an attribute has another length than the points, or the file cannot be written.
pub fn write_cloud(path: &Path, cloud: &Cloud, options: &WriteOptions) -> Result<WriteReport, IoError> {
    let format = CloudFormat::from_path(path)?;
    check_points(path, "point", &cloud.points)?;
    check_points(path, "point", &[cloud.world_from_local])?;
    check_attributes(path, cloud.points.len(), &cloud.attributes)?;
    let mut report = WriteReport::default();
    if path == Path::new("-") {
        let mut out = std::io::stdout().lock();
        let written = write_text(&mut out, cloud, options, CloudFormat::Xyz).and_then(|()| out.flush());
        return written.map(|()| report).map_err(|source| IoError::from_system(Path::new("standard output"), source));
    }
    let write = |fill: &dyn Fn(&mut dyn Sink) -> std::io::Result<()>| write_file(path, |sink| fill(sink));
    report.bytes = match format {
        CloudFormat::Xyz | CloudFormat::Csv => write(&|sink| write_text(sink, cloud, options, format))?,
        CloudFormat::Pts => {
            if cloud.attributes.classes.is_some() {
                report.attributes_left_out.push("classes");
            }
            write(&|sink| write_text(sink, cloud, options, format))?
        }
        CloudFormat::Ply => {
            // A cloud is a mesh without faces; its lists are only lent.
            let mesh = Mesh {
                world_from_local: cloud.world_from_local,
                vertices: cloud.points.clone(),
                attributes: cloud.attributes.clone(),
                crs: cloud.crs.clone(),
                ..Mesh::default()
            };
            write(&|sink| crate::mesh::write_ply_points(sink, &mesh, options, &[]))?
        }
        CloudFormat::Las | CloudFormat::Laz => write(&|sink| las::write(sink, format, cloud, options))?,
        CloudFormat::Pcd | CloudFormat::E57 => {
            let remedy = "use las, laz, ply, xyz or pts";
            return Err(IoError::NotOffered {
                path: path.to_path_buf(),
                format: format.name(),
                action: "written",
                remedy,
            });
        }
    };
    Ok(report)
}

fn write_text(out: &mut dyn Write, cloud: &Cloud, options: &WriteOptions, format: CloudFormat) -> std::io::Result<()> {
    const RUN: usize = 1 << 12;
    let decimals = decimals_for(tolerance(options, &cloud.points));
    let attributes = &cloud.attributes;
    let (colors, intensities) = (attributes.colors.as_deref(), attributes.intensities.as_deref());
    let classes = attributes.classes.as_deref().filter(|_| format != CloudFormat::Pts);
    let separator = if format == CloudFormat::Csv { b',' } else { b' ' };
    let mut names = vec!["x", "y", "z"];
    names.extend(intensities.map(|_| "intensity"));
    names.extend(colors.iter().flat_map(|_| ["red", "green", "blue"]));
    names.extend(classes.map(|_| "classification"));
    match format {
        CloudFormat::Pts => writeln!(out, "{}", cloud.points.len())?,
        CloudFormat::Csv => writeln!(out, "{}", names.join(","))?,
        _ => {
            if let Some(crs) = &cloud.crs {
                writeln!(out, "# crs {}", crate::mesh::one_line(crs))?;
            }
            // Bare coordinates need no names, and are what every program reads.
            if names.len() > 3 {
                writeln!(out, "# {}", names.join(" "))?;
            }
        }
    }
    let mut run = Vec::with_capacity(64 * RUN);
    for (start, points) in cloud.points.chunks(RUN).enumerate() {
        run.clear();
        for (i, point) in (start * RUN..).zip(points) {
            for (axis, coordinate) in world(*point, cloud.world_from_local).into_iter().enumerate() {
                if axis > 0 {
                    run.push(separator);
                }
                push_fixed(&mut run, coordinate, decimals);
            }
            if let Some(intensities) = intensities {
                run.push(separator);
                write!(run, "{}", intensities[i])?;
            }
            if let Some(colors) = colors {
                for channel in colors[i] {
                    run.push(separator);
                    push_integer(&mut run, u64::from(channel));
                }
            }
            if let Some(classes) = classes {
                run.push(separator);
                push_integer(&mut run, u64::from(classes[i]));
            }
            run.push(b'\n');
        }
        out.write_all(&run)?;
    }
    Ok(())
}
