//! Rasters as GeoTIFF: read back by another decoder, and by GDAL where it is at hand.

use std::io::Cursor;
use std::path::Path;
use std::process::Command;

use crate::common::folder;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;
use zeroset_io::{IoError, Raster, RasterFormat, write_raster};

const RD: &str = r#"PROJCS["Amersfoort / RD New",GEOGCS["Amersfoort",DATUM["Amersfoort",
    SPHEROID["Bessel 1841",6377397.155,299.1528128],AUTHORITY["EPSG","6289"]],PRIMEM["Greenwich",0],
    UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4289"]],PROJECTION["Oblique_Stereographic"],
    PARAMETER["latitude_of_origin",52.1561605555556],PARAMETER["central_meridian",5.38763888888889],
    PARAMETER["scale_factor",0.9999079],PARAMETER["false_easting",155000],PARAMETER["false_northing",463000],
    UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","28992"]]"#;

fn raster(crs: Option<&str>) -> Raster {
    let values = vec![1.5, -2.25, f32::NAN, 4.0, 1e-3, 300.125];
    Raster { origin: [84_800.5, 447_500.25], cell: 0.5, size: [3, 2], values, crs: crs.map(str::to_owned) }
}

fn same(found: &[f32], expected: &[f32]) -> bool {
    found.iter().map(|v| v.to_bits()).eq(expected.iter().map(|v| v.to_bits()))
}

#[test]
fn tags_and_values_come_back() {
    let folder = folder();
    let path = folder.path().join("dsm.tif");
    let raster = raster(Some("EPSG:28992+5709"));
    let report = write_raster(&path, &raster).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(report.bytes, bytes.len() as u64);
    let mut file = Decoder::new(Cursor::new(bytes)).unwrap();
    assert_eq!(file.dimensions().unwrap(), (3, 2));
    assert_eq!(file.get_tag_f64_vec(Tag::ModelPixelScaleTag).unwrap(), [0.5, 0.5, 0.0]);
    assert_eq!(file.get_tag_f64_vec(Tag::ModelTiepointTag).unwrap(), [0.0, 0.0, 0.0, 84_800.5, 447_500.25, 0.0]);
    assert_eq!(file.get_tag_ascii_string(Tag::GdalNodata).unwrap(), "nan");
    let keys = file.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap();
    assert_eq!(keys[..8], [1, 1, 1, 4, 1024, 0, 1, 1]);
    assert_eq!(keys[8..], [1025, 0, 1, 1, 3072, 0, 1, 28992, 4096, 0, 1, 5709]);
    let DecodingResult::F32(values) = file.read_image().unwrap() else { panic!("the values are not f32") };
    assert!(same(&values, &raster.values));
}

#[test]
fn many_strips_come_back() {
    let folder = folder();
    let path = folder.path().join("dsm.TIFF");
    let size = [1001, 700];
    let values: Vec<f32> = (0..size[0] * size[1]).map(|i| ((i % 1001) as f32).sin() * (i / 1001) as f32).collect();
    let raster = Raster { size, values, ..raster(None) };
    write_raster(&path, &raster).unwrap();
    let mut file = Decoder::new(std::fs::File::open(&path).unwrap()).unwrap();
    assert!(file.strip_count().unwrap() > 1);
    let DecodingResult::F32(values) = file.read_image().unwrap() else { panic!("the values are not f32") };
    assert!(same(&values, &raster.values));
    let first = std::fs::read(&path).unwrap();
    write_raster(&path, &raster).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
}

#[test]
fn what_cannot_be_written_is_refused() {
    let sound = raster(None);
    let mut infinite = sound.values.clone();
    infinite[4] = f32::INFINITY;
    let cases = [
        (Raster { size: [3, 3], ..sound.clone() }, "6 values for 3 x 3 cells"),
        (Raster { size: [0, 2], values: Vec::new(), ..sound.clone() }, "0 x 2 cells"),
        (Raster { size: [usize::MAX, 2], ..sound.clone() }, "cells cannot be written"),
        (Raster { cell: 0.0, ..sound.clone() }, "side 0"),
        (Raster { cell: f64::NAN, ..sound.clone() }, "side NaN"),
        (Raster { origin: [f64::INFINITY, 0.0], ..sound.clone() }, "corner"),
        (Raster { values: infinite, ..sound.clone() }, "row 1, column 1 is infinite"),
    ];
    let folder = folder();
    let path = folder.path().join("a.tif");
    for (raster, expected) in cases {
        let text = write_raster(&path, &raster).unwrap_err().to_string();
        assert!(text.contains(expected) && text.lines().count() == 1, "{text}");
        assert!(!path.exists());
    }
    assert!(matches!(RasterFormat::from_path(Path::new("a.asc")), Err(IoError::UnknownSuffix { .. })));
}

/// Prints, of each file: the codes of the system and of its vertical part, corner, cell, size, no data, values.
const GDAL: &str = "
import sys, rasterio
for path in sys.argv[1:]:
    with rasterio.open(path) as f:
        t = f.transform
        values = ' '.join(repr(float(v)) for v in f.read(1).ravel())
        print(path[-5:], f.crs and f.crs.to_string(), t.c, t.f, t.a, t.e, f.width, f.height, f.nodata, values, sep='|')
";

/// WKT without the codes in it.
fn without_codes(wkt: &str) -> String {
    let mut parts = wkt.split(r#",AUTHORITY["#);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once(']').map_or("", |(_, rest)| rest))
}

#[test]
fn gdal_reads_place_system_and_values() {
    let python = std::env::var("ZEROSET_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&python).args(["-c", "import rasterio"]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} has no rasterio; ZEROSET_PYTHON names another");
        return;
    }
    let folder = folder();
    let nameless = without_codes(RD);
    let local = nameless.replace("155000", "0");
    let cases = [
        ("a.tif", Some("EPSG:28992"), "EPSG:28992"),
        ("b.tif", Some("EPSG:28992+5709"), "EPSG:7415"),
        ("c.tif", Some(RD), "EPSG:28992"),
        ("d.tif", Some("EPSG:4326"), "EPSG:4326"),
        ("e.tif", Some("EPSG:4647"), "EPSG:4647"),
        ("f.tif", None, "None"),
        ("g.tif", Some("EPSG:7415"), "EPSG:7415"),
        ("h.tif", Some(&nameless), "EPSG:28992"),
        ("i.tif", Some(&local), r#"PARAMETER["false_easting",0]"#),
        ("j.tif", Some("a local grid"), "a local grid"),
        (
            "k.tif",
            Some(r#"GEOGCS["WGS 84",DATUM["d",SPHEROID["e",6378137,298.257223563]],UNIT["degree",0.0174532925]]"#),
            "GEOGCS",
        ),
    ];
    let mut command = Command::new(&python);
    command.args(["-c", GDAL]);
    for (name, crs, _) in &cases {
        let path = folder.path().join(name);
        write_raster(&path, &raster(*crs)).unwrap();
        command.arg(path);
    }
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(text.lines().count(), cases.len());
    for (line, (name, _, system)) in text.lines().zip(&cases) {
        let fields: Vec<&str> = line.split('|').collect();
        assert!(fields[0] == *name && fields[1].contains(system), "{line}");
        assert_eq!(fields[2..9], ["84800.5", "447500.25", "0.5", "-0.5", "3", "2", "nan"], "{line}");
        assert_eq!(fields[9], "1.5 -2.25 nan 4.0 0.0010000000474974513 300.125");
    }
}
