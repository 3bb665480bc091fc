use super::*;

/// Positions, and where they lie.
///
/// Out of PROJ 9.5.1 as `+inv` of the same parameters, then `cart` on the same ellipsoid, then `helmert` by the same
/// `towgs84`. For EPSG:3035 the inverse of that version is off by 0.3 mm, as it gives back other numbers than its own
/// forward projection is given: here its forward projection was solved for the position.
const PLACES: [(&str, [f64; 3], [f64; 3]); 25] = [
    ("EPSG:28992", [84_800.0, 447_400.0, 2.0], [3_922_656.780_34, 299_400.285_83, 5_003_559.743_39]),
    ("EPSG:25832", [691_000.5, 5_336_000.25, 520.0], [4_177_167.925_78, 855_015.144_93, 4_728_300.009_20]),
    ("EPSG:32610", [550_000.0, 5_272_000.0, 30.0], [-2_304_593.468_01, -3_640_601.948_81, 4_686_985.093_22]),
    ("EPSG:3857", [-8_238_000.0, 4_970_000.0, 10.0], [1_334_236.647_46, -4_654_021.173_60, 4_138_265.735_61]),
    ("EPSG:2154", [652_000.0, 6_862_000.0, 35.0], [4_200_986.459_69, 172_093.554_02, 4_780_081.954_03]),
    ("EPSG:27700", [530_000.0, 180_000.0, 15.0], [3_978_329.094_67, -8_912.265_85, 4_968_686.681_57]),
    ("EPSG:2056", [2_600_000.0, 1_200_000.0, 540.0], [4_325_355.081_22, 564_731.429_70, 4_638_485.172_13]),
    ("EPSG:21781", [683_000.0, 247_000.0, 400.0], [4_279_971.663_99, 642_510.511_59, 4_669_946.023_58]),
    ("EPSG:5514", [-742_000.0, -1_043_000.0, 200.0], [3_971_060.485_83, 1_021_997.131_04, 4_869_309.574_60]),
    ("EPSG:31256", [3_000.0, 341_000.0, 170.0], [4_086_002.546_23, 1_200_444.998_80, 4_732_435.937_68]),
    ("EPSG:31467", [3_513_000.0, 5_403_000.0, 250.0], [4_158_470.973_29, 671_723.106_36, 4_773_554.664_43]),
    ("EPSG:2994", [637_000.0, 850_500.0, 500.0], [-2_505_339.865_03, -3_847_619.313_43, 4_412_533.912_78]),
    ("EPSG:2992", [637_000.0, 850_500.0, 500.0], [-2_505_339.865_03, -3_847_619.313_43, 4_412_533.912_78]),
    ("EPSG:2993", [194_150.0, 259_230.0, 150.0], [-2_505_346.228_90, -3_847_615.299_73, 4_412_530.348_56]),
    ("EPSG:4326", [4.36, 52.01, 3.0], [3_922_700.483_08, 299_080.724_15, 5_003_490.664_13]),
    ("EPSG:4289", [4.36, 52.01, 3.0], [3_922_813.451_46, 299_069.697_61, 5_003_458.646_03]),
    ("EPSG:3006", [674_000.0, 6_580_000.0, 20.0], [3_101_534.307_18, 1_011_219.769_73, 5_462_391.022_32]),
    ("EPSG:2193", [1_748_000.0, 5_427_000.0, 12.0], [-4_779_053.763_63, 437_649.376_54, -4_187_091.824_41]),
    ("EPSG:3035", [3_930_000.0, 3_220_000.0, 8.0], [3_928_005.868_98, 295_767.690_55, 4_999_556.747_58]),
    ("EPSG:31370", [149_000.0, 170_000.0, 50.0], [4_024_220.639_63, 306_436.308_13, 4_922_424.590_30]),
    ("EPSG:27572", [600_000.0, 2_428_000.0, 60.0], [4_201_553.000_11, 171_433.182_81, 4_779_701.478_13]),
    ("EPSG:2100", [476_000.0, 4_203_000.0, 90.0], [4_608_534.514_27, 2_025_733.511_15, 3_903_498.657_89]),
    ("EPSG:5936", [1_700_000.0, 900_000.0, 20.0], [-1_100_447.731_94, -289_618.585_16, 6_254_786.839_29]),
    ("EPSG:6350", [1_620_000.0, 1_920_000.0, 10.0], [1_116_097.236_85, -4_847_146.223_48, 3_979_139.305_36]),
    ("EPSG:2263", [985_000.0, 200_000.0, 40.0], [1_334_651.597_98, -4_653_653.904_52, 4_138_546.436_46]),
];

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

fn place(crs: &str, position: [f64; 3]) -> [f64; 3] {
    Globe::of(crs).and_then(|globe| globe.geocentric(position)).unwrap_or_else(|error| panic!("{crs}: {error}"))
}

/// The closed formula, for an ellipsoid of a long axis and an inverse flattening.
fn on_ellipsoid([longitude, latitude, height]: [f64; 3], a: f64, inverse_flattening: f64) -> [f64; 3] {
    let f = 1.0 / inverse_flattening;
    let e2 = f * (2.0 - f);
    let (sin, cos) = latitude.to_radians().sin_cos();
    let across = a / (1.0 - e2 * sin * sin).sqrt();
    let (sin_lon, cos_lon) = longitude.to_radians().sin_cos();
    [(across + height) * cos * cos_lon, (across + height) * cos * sin_lon, (across * (1.0 - e2) + height) * sin]
}

fn wgs84(position: [f64; 3]) -> [f64; 3] {
    on_ellipsoid(position, 6_378_137.0, 298.257_223_563)
}

#[test]
fn national_grids_lie_where_proj_puts_them() {
    for (crs, position, expected) in PLACES {
        let off = distance(place(crs, position), expected);
        // GRS 80 is taken for WGS 84, which is 0.105 mm shorter from pole to pole.
        assert!(off < 1.3e-4, "{crs}: {off} m");
    }
}

#[test]
fn longitudes_and_latitudes_follow_the_closed_formula() {
    for position in
        [[0.0, 0.0, 0.0], [4.36, 52.01, 3.0], [-179.9, -89.9, 8000.0], [90.0, 90.0, -400.0], [180.0, 10.0, 1.0]]
    {
        let off = distance(place("EPSG:4326", position), wgs84(position));
        assert!(off < 1e-8, "{position:?}: {off} m");
        assert_eq!(place("EPSG:4979", position), place("EPSG:4326", position));
    }
}

/// EPSG Guidance Note 7-2 gives the formulas of the equal-area projection in full; forwards they need no series.
#[test]
fn the_equal_area_grid_of_europe_gives_back_its_longitudes_and_latitudes() {
    const A: f64 = 6_378_137.0;
    const INVERSE_FLATTENING: f64 = 298.257_222_101;
    let e2 = (2.0 - 1.0 / INVERSE_FLATTENING) / INVERSE_FLATTENING;
    let e = e2.sqrt();
    let q = |latitude: f64| {
        let sin = latitude.sin();
        (1.0 - e2) * (sin / (1.0 - e2 * sin * sin) + (e * sin).atanh() / e)
    };
    let at_pole = q(90_f64.to_radians());
    let beta = |latitude: f64| (q(latitude) / at_pole).asin();
    let middle = 52_f64.to_radians();
    let radius = A * (at_pole / 2.0).sqrt();
    let squeeze = A * middle.cos() / (1.0 - e2 * middle.sin().powi(2)).sqrt() / (radius * beta(middle).cos());
    for (longitude, latitude) in [(4.36, 52.01), (-9.0, 38.5), (25.0, 65.0), (33.0, 35.0)] {
        let (sin_lon, cos_lon) = (longitude - 10_f64).to_radians().sin_cos();
        let (sin, cos) = beta(f64::to_radians(latitude)).sin_cos();
        let (sin_0, cos_0) = beta(middle).sin_cos();
        let b = radius * (2.0 / (1.0 + sin_0 * sin + cos_0 * cos * cos_lon)).sqrt();
        let x = 4_321_000.0 + b * squeeze * cos * sin_lon;
        let y = 3_210_000.0 + b / squeeze * (cos_0 * sin - sin_0 * cos * cos_lon);
        let expected = on_ellipsoid([longitude, latitude, 8.0], A, INVERSE_FLATTENING);
        let off = distance(place("EPSG:3035", [x, y, 8.0]), expected);
        assert!(off < 1.3e-4, "{longitude} {latitude}: {off} m");
    }
}

#[test]
fn a_length_is_that_of_the_map_by_its_scale() {
    // On the central meridian of a zone of UTM the scale is 0.9996, at the height of the ellipsoid.
    let globe = Globe::of("EPSG:25832").expect("UTM is known");
    let [a, b] = [5_400_000.0, 5_400_100.0].map(|y| globe.geocentric([500_000.0, y, 0.0]).expect("in the zone"));
    assert!((distance(a, b) - 100.0 / 0.9996).abs() < 1e-5, "{}", distance(a, b));
    let above = globe.geocentric([500_000.0, 5_400_000.0, 30.0]).expect("in the zone");
    assert!((distance(a, above) - 30.0).abs() < 1e-8);
}

#[test]
fn heights_have_the_unit_that_is_stated() {
    let rise = |crs: &str| {
        let globe = Globe::of(crs).unwrap_or_else(|error| panic!("{crs}: {error}"));
        let at = if globe.system.is_latlong() { [-123.0, 44.0] } else { [637_000.0, 850_500.0] };
        let [low, high] = [0.0, 1000.0].map(|z| globe.geocentric([at[0], at[1], z]).expect("in Oregon"));
        distance(low, high)
    };
    let horizontal = r#"PROJCS["NAD83(HARN) / Oregon GIC Lambert (ft)",GEOGCS["a",UNIT["degree",0.0174532925199433]],
        UNIT["foot",0.3048,AUTHORITY["EPSG","9002"]],AUTHORITY["EPSG","2994"]]"#;
    let first = |unit: &str, axis: &str| {
        format!(r#"COMPD_CS["a, b",{horizontal},VERT_CS["NAVD88",VERT_DATUM["c",2005],{unit},AXIS["Up",{axis}]]]"#)
    };
    let second = r#"COMPOUNDCRS["a",PROJCRS["b",CS[Cartesian,2],LENGTHUNIT["foot",0.3048],ID["EPSG",2994]],
        VERTCRS["c",VDATUM["d"],CS[vertical,1],AXIS["gravity-related height (H)",up],
        LENGTHUNIT["US survey foot",0.304800609601219],ID["EPSG",6360]]]"#;
    let us_survey_foot = 1200.0 / 3937.0;
    for (crs, foot) in [
        ("EPSG:2994".to_owned(), 0.3048),
        ("EPSG:2993".into(), 1.0),
        ("EPSG:2263".into(), us_survey_foot),
        ("EPSG:4269".into(), 1.0),
        ("EPSG:4269+6360".into(), us_survey_foot),
        ("EPSG:2994+5703".into(), 1.0),
        ("EPSG:2994+6360".into(), us_survey_foot),
        ("EPSG:2994+8228".into(), 0.3048),
        // A code of old, for NAVD 88 in whatever unit.
        ("EPSG:2994+5103".into(), 0.3048),
        // A compound system, in US survey feet with heights in the same, under a definition that says so.
        ("EPSG:8735".into(), us_survey_foot),
        (horizontal.into(), 0.3048),
        (first(r#"UNIT["metre",1,AUTHORITY["EPSG","9001"]]"#, "UP"), 1.0),
        (first(r#"UNIT["US survey foot, so called", 0.3048006096012192]"#, "UP"), us_survey_foot),
        (first(r#"UNIT["nothing",0]"#, "UP"), 0.3048),
        (second.into(), us_survey_foot),
    ] {
        assert!((rise(&crs) - 1000.0 * foot).abs() < 1e-5, "{crs}: {}", rise(&crs));
    }
    assert_eq!(Globe::of(&first(r#"UNIT["metre",1]"#, "DOWN")).err(), Some(GlobeError::Depths));
    for code in [5715, 6358, 10372] {
        assert_eq!(Globe::of(&format!("EPSG:28992+{code}")).err(), Some(GlobeError::Depths));
    }
}

#[test]
fn a_code_in_wkt_is_as_good_as_a_code() {
    let wkt = r#"COMPD_CS["Amersfoort / RD New + NAP",PROJCS["Amersfoort / RD New",GEOGCS["Amersfoort",
        AUTHORITY["EPSG","4289"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","28992"]],
        VERT_CS["NAP",UNIT["metre",1],AXIS["Up",UP],AUTHORITY["EPSG","5709"]]]"#;
    let delft = [84_800.0, 447_400.0, 2.0];
    for crs in ["EPSG:28992+5709", "EPSG:7415", wkt] {
        assert_eq!(place(crs, delft), place("EPSG:28992", delft), "{crs}");
    }
}

#[test]
fn what_would_be_misplaced_is_refused() {
    let code_of = |crs: &str| Globe::of(crs).err().unwrap_or_else(|| panic!("{crs} was taken"));
    for crs in ["", "a local grid", "EPSG:", "EPSG:-1", r#"PROJCS["a",UNIT["metre",1]]"#, "PROJCS[é", "VERT_CS[\"é"] {
        assert_eq!(code_of(crs), GlobeError::NoCode, "{crs}");
    }
    for code in [0, 1, 65_536, 4_294_967_295, 22_300] {
        assert_eq!(code_of(&format!("EPSG:{code}")), GlobeError::UnknownCode { code });
    }
    for code in [2048, 22_275, 29_371, 8352, 2065, 5513] {
        assert_eq!(code_of(&format!("EPSG:{code}")), GlobeError::Axes { code });
    }
    assert_eq!(code_of("EPSG:4807"), GlobeError::Grads { code: 4807 });
    assert_eq!(code_of("EPSG:4978"), GlobeError::Geocentric { code: 4978 });
    assert_eq!(code_of("EPSG:26710"), GlobeError::Grid { code: 26_710, grid: "NAD27" });
    assert!(matches!(code_of("EPSG:27200"), GlobeError::Grid { code: 27_200, .. } | GlobeError::Projection { .. }));
    assert_eq!(code_of("EPSG:2163"), GlobeError::Datum { code: 2163 });
    assert_eq!(code_of("EPSG:26591"), GlobeError::Definition { code: 26_591 });
    let labrd = code_of("EPSG:8441");
    assert!(matches!(labrd, GlobeError::Projection { code: 8441, .. }));
    assert!(labrd.to_string().starts_with("the projection of EPSG:8441 cannot be inverted (projection not found)"));
}

#[test]
fn every_code_gives_finite_positions_or_errors() {
    let numbers = [0.0, 1.0, -180.0, 90.0, 5e5, -7e6, 1e8, 1e11, 1e300, f64::MAX, f64::NAN, f64::NEG_INFINITY];
    let mut known = 0;
    for code in 0..=u16::MAX {
        let Ok(globe) = Globe::of(&format!("EPSG:{code}")) else { continue };
        known += 1;
        for x in numbers {
            for y in numbers {
                match globe.geocentric([x, y, 10.0]) {
                    Ok(found) => assert!(found.iter().all(|v| v.is_finite()), "EPSG:{code} {x} {y}: {found:?}"),
                    Err(error) => assert!(matches!(error, GlobeError::Position { .. }), "{error}"),
                }
            }
        }
    }
    // What `crs-definitions` 0.6 knows, without what is refused.
    assert_eq!(known, 5277);
}

#[test]
fn many_positions_are_placed_as_one_is_on_any_number_of_threads() {
    let globe = Globe::of("EPSG:28992").expect("RD New is known");
    let positions: Vec<[f64; 3]> = (0..5000)
        .map(|i| [80_000.0 + 1.7 * f64::from(i), 440_000.0 + 0.9 * f64::from(i), 0.01 * f64::from(i)])
        .collect();
    let alone: Vec<_> = positions.iter().map(|position| globe.geocentric(*position).expect("in Holland")).collect();
    let place_with = |threads: usize, mut positions: Vec<[f64; 3]>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| globe.geocentric_all(&mut positions)).map(|()| positions)
    };
    let bits = |positions: &[[f64; 3]]| positions.iter().map(|p| p.map(f64::to_bits)).collect::<Vec<_>>();
    for threads in [1, 2, 7] {
        let together = place_with(threads, positions.clone()).expect("in Holland");
        assert_eq!(bits(&together), bits(&alone));
        let mut bad = positions.clone();
        bad[4000][0] = f64::INFINITY;
        bad[1234][2] = f64::INFINITY;
        let first = place_with(threads, bad).expect_err("two are bad");
        assert!(matches!(first, GlobeError::Position { position: [x, _, z], .. } if x.is_finite() && z.is_infinite()));
    }
}

#[test]
fn frames_are_rotations_that_point_up() {
    for position in [
        [4.36, 52.01, 3.0],
        [-179.0, -89.999_999, 0.0],
        [0.0, 90.0, 0.0],
        [10.0, -90.0, 5.0],
        [12.0, 0.0, 9000.0],
        [-75.0, 45.0, -3000.0],
    ] {
        let frame = Frame::at(wgs84(position));
        let m = frame.transform();
        let axes: [[f64; 3]; 3] = std::array::from_fn(|axis| [m[4 * axis], m[4 * axis + 1], m[4 * axis + 2]]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for (i, a) in axes.into_iter().enumerate() {
            for (j, b) in axes.into_iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                assert!((dot(a, b) - expected).abs() < 1e-15, "{position:?}: {i} {j} {}", dot(a, b));
            }
        }
        let [east, north, up] = axes;
        let across = [east[1] * north[2] - east[2] * north[1], east[2] * north[0] - east[0] * north[2]];
        assert!((across[0] - up[0]).abs() < 1e-15 && (across[1] - up[1]).abs() < 1e-15, "{position:?}: right-handed");
        assert_eq!([m[3], m[7], m[11], m[15]], [0.0, 0.0, 0.0, 1.0]);
        assert_eq!([m[12], m[13], m[14]], frame.origin());
        let [longitude, latitude, height] = position;
        let local = frame.local(wgs84([longitude, latitude, height + 1000.0]));
        assert!(distance(local, [0.0, 0.0, 1000.0]) < 1e-8, "{position:?}: {local:?}");
        assert_eq!(frame.local(frame.origin()), [0.0; 3]);
    }
}

#[test]
fn a_frame_keeps_its_precision_over_hundreds_of_kilometres() {
    let frame = Frame::at(wgs84([5.0, 52.0, 0.0]));
    let m = frame.transform();
    for away in [[0.0, 0.0, 0.0], [1000.0, -2000.0, 30.0], [250_000.0, 200_000.0, -8000.0]] {
        let there: [f64; 3] =
            std::array::from_fn(|a| m[12 + a] + m[a] * away[0] + m[4 + a] * away[1] + m[8 + a] * away[2]);
        // Numbers of the size of the earth are 1e-9 m apart.
        assert!(distance(frame.local(there), away) < 4e-9, "{:?}", frame.local(there));
    }
    let [east, north, up] = frame.local(wgs84([5.001, 52.001, 0.0]));
    assert!((68.0..69.5).contains(&east) && (110.5..112.0).contains(&north) && (-0.01..0.0).contains(&up));
}
