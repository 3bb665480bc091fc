//! Tables of points: positions in, values of F out.

use std::path::Path;
use std::process::{Command, Output};

use crate::common::{GEOREFERENCED, SWISS, folder, sound_cloud};
use zeroset_io::{
    CloudFormat, EvaluatedPoints, IoError, PositionFormat, TableFormat, read_positions, read_positions_bytes,
    write_evaluated,
};

/// More rows than one thread gets at a time, with numbers of all sizes.
fn many() -> EvaluatedPoints {
    let count = 20_000;
    let number = |i: usize| (i as f64 * 0.618_034).sin();
    EvaluatedPoints {
        positions: (0..count).map(|i| [84_800.0 + number(i), 447_400.0 + 1e3 * number(2 * i), number(3 * i)]).collect(),
        values: (0..count).map(|i| number(i) * 10_f64.powi(i as i32 % 40 - 20)).collect(),
        gradients: (0..count).map(|i| [number(i), number(i + 1), -number(i + 2)]).collect(),
        inside: (0..count).map(|i| number(i) < 0.0).collect(),
        crs: Some("EPSG:28992\n+5709".into()),
    }
}

fn few() -> EvaluatedPoints {
    EvaluatedPoints {
        positions: SWISS.to_vec(),
        values: vec![-0.1, 0.25, f64::NAN, 1e-300],
        gradients: vec![[0.0, 0.0, 1.0], [0.1, 0.2, 0.3], [f64::NAN; 3], [1e20, -0.0, 5.0]],
        inside: vec![true, false, false, true],
        crs: None,
    }
}

fn written(name: &str, points: &EvaluatedPoints) -> Vec<u8> {
    let folder = folder();
    let path = folder.path().join(name);
    let report = write_evaluated(&path, points).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(report.bytes, bytes.len() as u64);
    bytes
}

#[test]
fn positions_come_back_bit_for_bit() {
    let points = many();
    for (name, format) in [("a.ply", CloudFormat::Ply), ("a.csv", CloudFormat::Csv)] {
        let bytes = written(name, &points);
        assert_eq!(written(name, &points), bytes);
        let file = read_positions_bytes(Path::new(name), PositionFormat::Cloud(format), bytes).unwrap();
        assert_eq!(file.positions, points.positions, "{name}");
        assert_eq!(file.crs.as_deref(), (format == CloudFormat::Ply).then_some("EPSG:28992 +5709"));
    }
}

#[test]
fn csv_holds_all_digits() {
    let text = String::from_utf8(written("a.csv", &few())).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "x,y,z,value,gx,gy,gz,inside");
    assert_eq!(lines[1], "2600000.123,1200000.456,500.001,-0.1,0.0,0.0,1.0,1");
    assert_eq!(lines[3], "2600000.123,1200020.789,502.002,NaN,NaN,NaN,NaN,0");
    assert_eq!(lines[4], "2600005.0,1200005.0,510.5,1e-300,1e+20,-0.0,5.0,1");
    let points = many();
    let text = String::from_utf8(written("a.csv", &points)).unwrap();
    for (i, line) in text.lines().skip(1).enumerate() {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let expected = [points.values[i], points.gradients[i][0], points.gradients[i][1], points.gradients[i][2]];
        assert_eq!((&numbers[3..7], numbers[7] == 1.0), (&expected[..], points.inside[i]));
    }
}

#[test]
fn npy_has_eight_columns() {
    let points = few();
    let bytes = written("a.npy", &points);
    assert_eq!(bytes.len(), 128 + 4 * 8 * 8);
    let values: Vec<f64> =
        bytes[128..].chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect();
    assert_eq!(values[..8], [2_600_000.123, 1_200_000.456, 500.001, -0.1, 0.0, 0.0, 1.0, 1.0]);
    assert!(values[19].is_nan() && values[23] == 0.0);
    // It is no array of positions.
    let error = read_positions_bytes(Path::new("a.npy"), PositionFormat::Npy, bytes).unwrap_err();
    assert!(error.to_string().contains("shape (4, 8), not (n, 3)"), "{error}");
}

#[test]
fn positions_of_every_cloud_format_are_world_coordinates() {
    for (suffix, format) in CloudFormat::KNOWN {
        let name = format!("a.{suffix}");
        let path = Path::new(&name);
        assert_eq!(PositionFormat::from_path(path).unwrap(), PositionFormat::Cloud(*format));
        let file = read_positions_bytes(path, PositionFormat::Cloud(*format), sound_cloud(*format)).unwrap();
        crate::common::assert_near(&file.positions, &GEOREFERENCED, 0.0005);
    }
    // Text and doubles are not even rounded.
    let text = b"2600000.1234567 1200000.7654321 -0.1\n1 2 nan\n".to_vec();
    let file = read_positions_bytes(Path::new("-"), PositionFormat::Cloud(CloudFormat::Xyz), text).unwrap();
    assert_eq!((&file.positions[..], file.left_out), (&[[2_600_000.123_456_7, 1_200_000.765_432_1, -0.1]][..], 1));
}

/// A file of version 1 with a header of one's own.
fn npy(header: &str, values: &[f64]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

fn read(bytes: Vec<u8>) -> Result<Vec<[f64; 3]>, IoError> {
    read_positions_bytes(Path::new("a.npy"), PositionFormat::Npy, bytes).map(|file| file.positions)
}

const SOUND: &str = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }\n";

#[test]
fn npy_in_single_and_double_precision_and_three_versions() {
    let values = [84_800.1, 447_400.2, 3.0, 1.0, 2.0, -0.5];
    let expected = [[84_800.1, 447_400.2, 3.0], [1.0, 2.0, -0.5]];
    assert_eq!(read(npy(SOUND, &values)).unwrap(), expected);
    for version in [2, 3] {
        let mut bytes = npy(SOUND, &values);
        bytes[6] = version;
        bytes.splice(10..10, [0, 0]);
        assert_eq!(read(bytes).unwrap(), expected);
    }
    let mut single = npy(&SOUND.replace("<f8", "<f4"), &[]);
    single.extend(values.iter().flat_map(|value| (*value as f32).to_le_bytes()));
    assert_eq!(read(single).unwrap()[1], expected[1]);
    let file =
        read_positions_bytes(Path::new("a.npy"), PositionFormat::Npy, npy(SOUND, &[f64::NAN, 0.0, 0.0, 1.0, 2.0, 3.0]));
    let file = file.unwrap();
    assert_eq!((&file.positions[..], file.left_out), (&[[1.0, 2.0, 3.0]][..], 1));
}

#[test]
fn hostile_npy_is_refused_in_one_line() {
    let values = [0.0; 6];
    let with = |from: &str, to: &str| npy(&SOUND.replace(from, to), &values);
    let mut long = npy(SOUND, &values);
    long.extend([0; 5]);
    let mut endless = b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec();
    endless.extend(SOUND.bytes());
    let mut version = npy(SOUND, &values);
    version[6] = 9;
    let cases = [
        (Vec::new(), "is empty"),
        (b"\x93NUM".to_vec(), "cut short in its header"),
        (b"\x93NUMPY\x01\x00".to_vec(), "cut short in its header"),
        (npy(SOUND, &values)[..40].to_vec(), "cut short in its header"),
        (npy(SOUND, &values[..5]), "promises 2 points but the file has 1"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "looks like PLY"),
        (endless, "states a length of 4294967295 bytes"),
        (version, "version 9.0 of NPY"),
        (long, "5 bytes follow"),
        (with("(2, 3)", "(18446744073709551615, 3)"), "promises 18446744073709551615 points"),
        (with("(2, 3)", "(768614336404564651, 3)"), "promises 768614336404564651 points"),
        (with("(2, 3)", "(18446744073709551616, 3)"), "not one that NumPy writes"),
        (with("(2, 3)", "(-2, 3)"), "not one that NumPy writes"),
        (with("(2, 3)", "(3, 2)"), "shape (3, 2), not (n, 3)"),
        (with("(2, 3)", "(6,)"), "shape (6), not (n, 3)"),
        (with("(2, 3)", "()"), "shape (), not (n, 3)"),
        (with("(2, 3)", "(0, 3)"), "holds no points"),
        (with("<f8", ">f8"), "type `>f8`"),
        (with("<f8", "<i8"), "type `<i8`"),
        (with("<f8", "|O"), "type `|O`"),
        (with("<f8", "a\nb"), "type"),
        (with("'<f8'", "[('x', '<f8')]"), "named fields"),
        (with("False", "True"), "Fortran order"),
        (npy(SOUND, &[f64::NAN; 6]), "none of the 2 points has finite coordinates"),
        (npy(SOUND, &[1e300; 6]), "too large"),
    ];
    for (bytes, expected) in cases {
        let text = read(bytes).unwrap_err().to_string();
        assert!(text.contains(expected) && text.lines().count() == 1, "{text}");
    }
    let sound = npy(SOUND, &values);
    for length in 0..sound.len() {
        assert!(read(sound[..length].to_vec()).is_err());
    }
    for at in 0..sound.len() {
        for byte in [0, b'(', b'9', 0xff] {
            let mut damaged = sound.clone();
            damaged[at] = byte;
            let _ = read(damaged);
        }
    }
}

#[test]
fn tables_that_cannot_be_written_are_refused() {
    let folder = folder();
    let path = folder.path().join("a.csv");
    let cases = [
        (EvaluatedPoints { values: vec![0.0; 3], ..few() }, "3 values for 4 points"),
        (EvaluatedPoints { gradients: Vec::new(), ..few() }, "0 gradients for 4 points"),
        (EvaluatedPoints { inside: vec![true; 5], ..few() }, "5 inside for 4 points"),
        (EvaluatedPoints { positions: vec![[f64::NAN; 3]; 4], ..few() }, "NaN or infinite"),
    ];
    for (points, expected) in cases {
        let text = write_evaluated(&path, &points).unwrap_err().to_string();
        assert!(text.contains(expected) && !path.exists(), "{text}");
    }
    let text = TableFormat::from_path(Path::new("a.las")).unwrap_err().to_string();
    assert!(text.contains("ply, csv, npy"), "{text}");
    let text = read_positions(Path::new("a.dwg")).unwrap_err().to_string();
    assert!(text.contains("unknown point format `.dwg`") && text.contains("e57, npy"), "{text}");
    assert_eq!(TableFormat::from_path(Path::new("-")).unwrap(), TableFormat::Csv);
}

/// Runs Python in a folder, if it has NumPy.
fn numpy(folder: &Path, script: &str) -> Option<Output> {
    let python = std::env::var("ZEROSET_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&python).args(["-c", "import numpy"]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} has no NumPy; ZEROSET_PYTHON names another");
        return None;
    }
    let output = Command::new(&python).args(["-c", script]).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(output)
}

#[test]
fn numpy_reads_what_is_written() {
    let folder = folder();
    for name in ["a.npy", "a.csv"] {
        write_evaluated(&folder.path().join(name), &many()).unwrap();
    }
    let script = "
import numpy as np
a = np.load('a.npy')
b = np.genfromtxt('a.csv', delimiter=',', names=True)
assert a.shape == (20000, 8) and a.dtype == np.float64 and a.flags.c_contiguous
assert b.dtype.names == ('x', 'y', 'z', 'value', 'gx', 'gy', 'gz', 'inside')
assert all((a[:, i] == b[name]).all() for i, name in enumerate(b.dtype.names))
print(repr(float(a[7, 3])), int(a[:, 7].sum()))";
    let Some(output) = numpy(folder.path(), script) else { return };
    let points = many();
    let inside = points.inside.iter().filter(|inside| **inside).count();
    let expected = format!("{:?} {inside}", points.values[7]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), expected);
}

#[test]
fn what_numpy_writes_is_read() {
    let folder = folder();
    let script = "
import numpy as np
a = np.array([[84800.1, 447400.2, 3.0], [1.0, 2.0, -0.5]])
np.save('double.npy', a)
np.save('single.npy', a[1:].astype('<f4'))
np.save('big.npy', a.astype('>f8'))
np.save('fortran.npy', np.asfortranarray(a))
np.save('object.npy', a.astype(object))
np.save('fields.npy', np.zeros(2, dtype=[('x', 'f8'), ('y', 'f8')]))
np.lib.format.write_array(open('second.npy', 'wb'), a, version=(2, 0))
np.lib.format.write_array(open('third.npy', 'wb'), a, version=(3, 0))";
    let Some(_) = numpy(folder.path(), script) else { return };
    let read = |name: &str| read_positions(&folder.path().join(name)).map(|file| file.positions);
    let expected = [[84_800.1, 447_400.2, 3.0], [1.0, 2.0, -0.5]];
    for name in ["double.npy", "second.npy", "third.npy"] {
        assert_eq!(read(name).unwrap(), expected, "{name}");
    }
    assert_eq!(read("single.npy").unwrap(), expected[1..]);
    for (name, why) in
        [("big.npy", "`>f8`"), ("fortran.npy", "Fortran"), ("object.npy", "`|O`"), ("fields.npy", "named fields")]
    {
        let text = read(name).unwrap_err().to_string();
        assert!(text.contains(why), "{text}");
    }
}
