"""Planes, edges and corners; points of files."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import GRID

import zeroset


@pytest.fixture(scope="module")
def box() -> zeroset.Features:
    points = zeroset.sample("box", points=20_000) + GRID
    return zeroset.features(points, scene="object", crs="EPSG:28992")


def test_a_box_has_six_planes(box: zeroset.Features) -> None:
    assert repr(box) == "Features(6 planes, 12 edges, 8 corners)"
    assert box.normals.shape == (6, 3) and box.offsets.shape == (6,) and box.corner_positions.shape == (8, 3)
    assert {edge.kind for edge in box.edges} == {"convex"}
    np.testing.assert_allclose([edge.angle for edge in box.edges], 90.0, atol=1.0)
    for plane, normal, offset in zip(box.planes, box.normals, box.offsets, strict=True):
        assert plane.oriented and plane.rms is not None and plane.rms < 0.002
        np.testing.assert_allclose(plane.rings[0] @ normal, offset, atol=1e-6)
    for corner in box.corners:
        assert len(corner.planes) == 3 and len(corner.edges) == 3
        np.testing.assert_allclose(box.normals[corner.planes] @ corner.position, box.offsets[corner.planes], atol=1e-3)
    assert box.plane_of_point.shape == (20_000,) and box.plane_of_point.max() == 5
    assert set(np.unique(box.class_of_point)) <= {0, 1, 2, 3} and (box.class_of_point == 1).mean() > 0.7
    assert box.report["scene"] == "object"


@pytest.mark.parametrize("suffix", ["json", "geojson", "obj", "ply", "dxf"])
def test_files(box: zeroset.Features, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"features.{suffix}"
    assert box.save(path) == path.stat().st_size > 1000
    if suffix == "json":
        assert len(json.loads(path.read_text())["planes"]) == 6
    if suffix == "ply":
        np.testing.assert_allclose(zeroset.read(path).points[0], zeroset.sample("box", points=1)[0] + GRID, atol=3)


def test_points_of_files(tmp_path: Path) -> None:
    one, two = tmp_path / "one.xyz", tmp_path / "two.csv"
    one.write_text("84800.25 447400.5 1.0\n84801.25 447401.5 2.0\n")
    two.write_text("x,y,z,classification\n84802.25,447402.5,3.0,6\n")
    cloud = zeroset.read(one, two)
    np.testing.assert_array_equal(cloud.points[:, 0], [84800.25, 84801.25, 84802.25])
    with pytest.raises(zeroset.FileMissingError):
        zeroset.read(one, tmp_path / "three.xyz")
    with pytest.raises(zeroset.FormatError):
        zeroset.read(tmp_path / "three.doc")


def test_parameters_are_looked_at() -> None:
    points = zeroset.sample("box", points=1000)
    with pytest.raises(zeroset.ParameterError, match="sharp angle of 1.*; give an angle between 0 and 90 degrees"):
        zeroset.features(points, sharp_angle=120.0)
    with pytest.raises(zeroset.ParameterError, match="no scene is called 'house'"):
        zeroset.sample("house")  # type: ignore[arg-type]


def test_geodataframe(box: zeroset.Features) -> None:
    pytest.importorskip("geopandas")
    frame = box.to_geodataframe()
    assert len(frame) == 26 and frame.crs.to_epsg() == 28992
    assert frame.geom_type.value_counts().to_dict() == {"LineString": 16, "Point": 8, "Polygon": 2}
    np.testing.assert_allclose(frame.area[:2], 0.8, atol=0.001)
