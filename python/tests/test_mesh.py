"""Meshes: arrays, files, other packages."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import zeroset

VERTICES = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
COLORS = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [9, 9, 9]], np.uint8)


def tetrahedron(**values: Any) -> zeroset.Mesh:
    return zeroset.Mesh(VERTICES, TRIANGLES, colors=COLORS, **values)


def test_figures() -> None:
    mesh = tetrahedron()
    assert mesh.is_closed and mesh.volume == pytest.approx(1.0 / 6.0)
    assert mesh.area == pytest.approx(1.5 + np.sqrt(3.0) / 2.0)
    assert mesh.self_intersections() == 0
    assert repr(mesh) == "Mesh(4 vertices, 4 triangles)"


@pytest.mark.parametrize("suffix", ["ply", "obj", "off", "stl", "glb"])
def test_files(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"mesh.{suffix}"
    mesh = tetrahedron(world_from_local=[84_800.0, 447_400.0, 0.0], crs="EPSG:28992")
    assert mesh.save(path) == path.stat().st_size
    again = zeroset.Mesh.load(path)
    assert again.is_closed and again.volume == pytest.approx(1.0 / 6.0)
    if suffix == "ply":
        np.testing.assert_allclose(again.vertices, mesh.vertices, atol=1e-6)
        np.testing.assert_array_equal(again.triangles, TRIANGLES)
        np.testing.assert_array_equal(again.colors, COLORS)
        assert again.crs == "EPSG:28992"


def test_simplification() -> None:
    mesh = zeroset.sphere([0, 0, 0], radius=1.0).mesh(cell=0.1)
    light = mesh.simplify(max_error=0.02)
    assert light.is_closed and len(light.triangles) < len(mesh.triangles) / 3
    assert light.report["triangles_after"] == len(light.triangles)
    with pytest.raises(zeroset.ParameterError, match="nothing says how far"):
        mesh.simplify()


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: zeroset.Mesh(VERTICES[:, :2], TRIANGLES), zeroset.InputError, "vertices have shape"),
        (lambda: zeroset.Mesh(VERTICES, TRIANGLES * 1.0), zeroset.InputError, "type float64"),
        (lambda: zeroset.Mesh(VERTICES, TRIANGLES + 1), zeroset.MeshError, "name vertices 1 to 4, but there are 4"),
        (lambda: zeroset.Mesh(VERTICES, TRIANGLES - 1), zeroset.MeshError, "-1"),
        (lambda: zeroset.Mesh(VERTICES, TRIANGLES, colors=COLORS / 255.0), zeroset.InputError, "0 to 255"),
        (lambda: zeroset.Mesh(VERTICES * np.nan, TRIANGLES).topology(), zeroset.InputError, "NaN"),
        (lambda: zeroset.Mesh.load("none.ply"), zeroset.FileMissingError, "no such file"),
        (lambda: tetrahedron().save("none/mesh.ply"), zeroset.FileMissingError, "does not exist"),
        (lambda: tetrahedron().save("mesh.doc"), zeroset.FormatError, "unknown mesh format"),
        (lambda: zeroset.Model.of_mesh(zeroset.Mesh(VERTICES, TRIANGLES[:3])), zeroset.ModelError, "not closed"),
    ],
)
def test_what_cannot_be_is_refused(make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make()


def test_damaged_files_are_told(tmp_path: Path) -> None:
    path = tmp_path / "mesh.ply"
    path.write_bytes(b"solid")
    with pytest.raises(zeroset.FormatError, match="not a PLY file"):
        zeroset.Mesh.load(path)


def test_pyvista() -> None:
    pytest.importorskip("pyvista")
    data = tetrahedron().to_pyvista()
    assert data.volume == pytest.approx(1.0 / 6.0) and data.is_all_triangles
    np.testing.assert_array_equal(data.point_data["colors"], COLORS)


def test_trimesh() -> None:
    pytest.importorskip("trimesh")
    mesh = tetrahedron().to_trimesh()
    assert mesh.is_watertight and mesh.volume == pytest.approx(1.0 / 6.0)
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], COLORS)


def test_open3d() -> None:
    pytest.importorskip("open3d")
    mesh = tetrahedron().to_open3d()
    assert mesh.is_watertight() and mesh.get_volume() == pytest.approx(1.0 / 6.0)


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    with pytest.raises(ImportError, match="pip install trimesh"):
        tetrahedron().to_trimesh()
