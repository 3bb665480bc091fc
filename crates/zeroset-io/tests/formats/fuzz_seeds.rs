//! Seeds for the fuzz targets: `ZEROSET_SEEDS=fuzz/corpus cargo test -p zeroset-io --test fuzz_seeds`.

use std::path::PathBuf;

use zeroset_io::{CloudFormat, MeshFormat};

#[test]
fn write_seeds() {
    let Some(folder) = std::env::var_os("ZEROSET_SEEDS").map(PathBuf::from) else {
        println!("skipped: ZEROSET_SEEDS names no folder");
        return;
    };
    let write = |target: String, name: &str, bytes: Vec<u8>| {
        std::fs::create_dir_all(folder.join(&target)).unwrap();
        std::fs::write(folder.join(target).join(name), bytes).unwrap();
    };
    for (suffix, format) in CloudFormat::KNOWN {
        write(format!("cloud_{suffix}"), "sound", crate::common::sound_cloud(*format));
    }
    write("cloud_pcd".into(), "ascii", crate::common::pcd_ascii());
    write("cloud_pcd".into(), "compressed", crate::common::pcd_compressed());
    let named = "x,y,z,red,green,blue,intensity,class\n1,2,3,4,5,6,7,8\n";
    write("cloud_xyz".into(), "named", named.into());
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty list uchar int l\nproperty double x\nproperty float y\n\
        property int z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        1 5 0 0 0\n0 1 0 0\n2 1 2 0 1 0\n3 0 1 2\n";
    for target in ["cloud_ply", "mesh_ply"] {
        write(target.into(), "ascii", ply.into());
        write(target.into(), "big", crate::common::sound_mesh(MeshFormat::Ply));
    }
    for (suffix, format) in MeshFormat::KNOWN {
        write(format!("mesh_{suffix}"), "sound", crate::common::sound_mesh(*format));
    }
    let planar = r#"{"points":[[1,2],[3,4,0.5]],"segments":[[[0,0],[1,1]]],"polygons":[[[0,0],[1,0],[0,1]]],
        "domain":{"vertices":[[0,0],[1,0],[0,1]],"triangles":[[0,1,2]]}}"#;
    write("planar_json".into(), "sound", planar.into());
    let features = r#"{"schema_version":1,"zeroset_version":"0.1.0","crs":"EPSG:28992","unit":"metre","planes":[{"id":0,
        "normal":[0,0,1],"offset":2,"oriented":true,"area":0.5,"points":9,"rms":null,"polygon":[[[0,0,2],[1,0,2],[0,1,2]]]}],
        "edges":[{"id":0,"kind":"convex","planes":[0],"angle":90,"length":1,"polyline":[[0,0,2],[1,0,2]]}],
        "corners":[{"id":0,"kind":"mixed","position":[0,0,2],"planes":[0],"edges":[0]}],"parameters":{}}"#;
    write("features_json".into(), "sound", features.into());
    let line = r#"{"type":"LineString","coordinates":[[0,0,1],[1,0,1]]}"#;
    write("constraints_geojson".into(), "sound", line.into());
    write("constraints_obj".into(), "sound", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 -1\n".into());
    let drawing = "0|SECTION|2|ENTITIES|0|LWPOLYLINE|90|2|38|1|10|0|20|0|42|1|10|2|20|0|0|ENDSEC|0|EOF|";
    write("constraints_dxf".into(), "sound", drawing.replace('|', "\n").into());
    write("planar_csv".into(), "sound", "x,y,weight\n1,2,3\n# c\n4 5;6\n".into());
    let solid = "subtract(box(0,0,0; 9,9,9) rotate(z,30deg; 1,2,3); union(a.ply; sphere(1,2,3; 4)) shell(1); mesh(\"b c.obj\"))";
    write("solid_expression".into(), "sound", solid.into());
    let tree = "[solid]\nop = 'shell'\nthickness = 1\nof = [{ expr = 'sphere(1,2,3; 4)', rotate = { axis = 'z', degrees = 30 }, at = [1,2,3] }]\n";
    write("solid_tree".into(), "sound", tree.into());
    let mut npy =
        b"\x93NUMPY\x01\x00\x40\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }    \n".to_vec();
    npy.extend([1.0_f64, 2.0, 3.0].iter().flat_map(|value| value.to_le_bytes()));
    write("table_npy".into(), "sound", npy);
    // As they are, and as the header, a zero and the data, for which the target makes checksums.
    for (name, bytes) in [
        ("fitted", crate::common::sound_model()),
        ("every", crate::common::model_bytes(&crate::common::model(crate::common::every_solid()))),
    ] {
        let end = 24 + u64::from_le_bytes(bytes[16..24].try_into().unwrap()) as usize;
        write(
            "model_zset".into(),
            &format!("{name}_parts"),
            [bytes[24..end].trim_ascii_end(), b"\0", &bytes[end..]].concat(),
        );
        write("model_zset".into(), name, bytes);
    }
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    write("mesh_stl".into(), "text", stl.into());
    write("mesh_obj".into(), "forms", "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2//2 -1\nf 1 2 \\\n3\n".into());
    write("mesh_off".into(), "color", "COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0 1 1\n3 0 1 2\n".into());
}
