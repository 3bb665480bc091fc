"""Models: asked, measured, cut and joined."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import GRID

import zeroset

RNG = np.random.default_rng(0)
PLACES = RNG.uniform(-2.0, 2.0, (1000, 3))
A = zeroset.box([-1, -1, -1], [1, 1, 1])
B = zeroset.sphere([1, 1, 1], radius=1.0)


def test_shapes_know_distances() -> None:
    np.testing.assert_allclose(B(PLACES), np.linalg.norm(PLACES - 1.0, axis=1) - 1.0, atol=1e-12)
    rod = zeroset.cylinder([0, 0, -1], [0, 0, 1], radius=0.5)
    np.testing.assert_allclose(rod([[2.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 3.0]]), [1.5, -0.5, 2.0])
    cone = zeroset.cone([0, 0, 0], [0, 0, 1], radii=(1.0, 0.0))
    assert cone.volume(step=0.01).volume == pytest.approx(np.pi / 3.0, rel=0.01)
    floor = zeroset.half_space([0, 0, 0], normal=[0, 0, 5])
    np.testing.assert_allclose(floor(PLACES), PLACES[:, 2])
    house = zeroset.prism([[[0, 0], [2, 0], [2, 1], [0, 1]]], heights=(0.0, 3.0))
    assert house.volume(step=0.01).volume == pytest.approx(6.0, rel=0.01)
    ground = zeroset.height_field([[0.0, 1.0, 2.0], [0.0, 1.0, 2.0]])
    assert ground.contains([[1.5, 0.5, 1.4], [1.5, 0.5, 1.6]]).tolist() == [True, False]


def test_operations_are_those_of_sets() -> None:
    a, b = A.contains(PLACES), B.contains(PLACES)
    for model, expected in [(A | B, a | b), (A & B, a & b), (A - B, a & ~b), (~A, ~a), (A - B - B, a & ~b)]:
        np.testing.assert_array_equal(model.contains(PLACES), expected)
    np.testing.assert_array_equal((A | B)(PLACES), np.minimum(A(PLACES), B(PLACES)))
    np.testing.assert_array_equal((A - B - ~A)(PLACES), np.maximum(np.maximum(A(PLACES), -B(PLACES)), A(PLACES)))
    with pytest.raises(TypeError):
        A | 3  # type: ignore[operator]


def test_long_chains_can_be_written(tmp_path: Path) -> None:
    beads = zeroset.sphere([0, 0, 0], radius=0.6)
    rest = A
    for i in range(1, 400):
        bead = zeroset.sphere([i, 0, 0], radius=0.6)
        beads, rest = beads | bead, rest - bead
    for model in (beads, rest):
        model.save(tmp_path / "chain.zset")
        np.testing.assert_array_equal(zeroset.Model.load(tmp_path / "chain.zset")(PLACES), model(PLACES))


def test_the_gradient_is_that_of_f(torus_model: zeroset.Model) -> None:
    smooth = A.smooth_union(B, radius=0.5)
    for model, places, step in [(smooth, PLACES, 1e-6), (torus_model, PLACES * 0.02 + [0.35, 0.0, 0.15] + GRID, 1e-5)]:
        axes = step * np.eye(3)
        numeric = np.stack([(model(places + e) - model(places - e)) / (2.0 * step) for e in axes], axis=1)
        off = np.linalg.norm(numeric - model.gradient(places), axis=1)
        # Creases and faces of cells, where F has no gradient, lie between the two places now and then.
        assert np.quantile(off, 0.95) < 1e-3


def test_placements() -> None:
    np.testing.assert_allclose(A.moved([1, 2, 3])(PLACES), A(PLACES - [1, 2, 3]))
    turned = zeroset.box([0, 0, 0], [2, 1, 1]).rotated([0, 0, 1], 90.0)
    assert turned.contains([[-0.5, 1.5, 0.5], [1.5, 0.5, 0.5]]).tolist() == [True, False]
    np.testing.assert_allclose(B.scaled(2.0, about=[1, 1, 1])([[1.0, 1.0, 4.0]]), [1.0])
    assert A.offset(0.5).contains([[1.2, 0.0, 0.0]]).all()
    assert A.shell(0.2).contains([[0.95, 0.0, 0.0], [0.0, 0.0, 0.0]]).tolist() == [True, False]


def test_meshes_have_sharp_edges() -> None:
    part = A - zeroset.cylinder([0, 0, -2], [0, 0, 2], radius=0.5)
    mesh = part.mesh(cell=0.1)
    found = mesh.topology()
    assert found["closed"] and found["genus"] == 1
    assert mesh.volume == pytest.approx(8.0 - 2.0 * np.pi * 0.25, rel=0.005)
    np.testing.assert_allclose(mesh.local.max(axis=0), 1.0, atol=1e-9)
    assert len(part.mesh(cell=0.1, max_error=0.01).triangles) < len(mesh.triangles) / 4


def test_changes_are_measured() -> None:
    found = (A | B).change_from(A, step=0.02)
    # Seven eighths of the ball stand out of the box.
    assert found.fill.volume == pytest.approx(7.0 / 8.0 * 4.0 / 3.0 * np.pi, rel=0.01)
    assert found.cut.volume == 0.0 and found.net.volume == pytest.approx(found.fill.volume)


def test_fitted_models_are_kept(torus_model: zeroset.Model, tmp_path: Path) -> None:
    path = tmp_path / "torus.zset"
    assert torus_model.save(path) == path.stat().st_size
    again = zeroset.Model.load(path)
    assert again.crs == "EPSG:28992" and again.provenance["parameters"]["points"] == "4000"
    first, second = torus_model.mesh(), again.mesh()
    np.testing.assert_array_equal(first.local, second.local)
    np.testing.assert_array_equal(first.triangles, second.triangles)
    half = again & zeroset.half_space(GRID, normal=[1, 0, 0])
    assert half.crs == "EPSG:28992" and half.mesh().is_closed
    assert half.volume().volume == pytest.approx(again.volume().volume / 2.0, rel=0.02)


def test_expressions_and_meshes_are_models(tmp_path: Path) -> None:
    parsed = zeroset.Model.parse("subtract(box(-1,-1,-1; 1,1,1); sphere(1,1,1; 1))")
    np.testing.assert_array_equal(parsed(PLACES), (A - B)(PLACES))
    path = tmp_path / "box.ply"
    A.mesh(cell=0.25).save(path)
    for model in (zeroset.Model.load(path), zeroset.Model.of_mesh(zeroset.Mesh.load(path))):
        np.testing.assert_allclose(model(PLACES), A(PLACES), atol=1e-6)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda _: zeroset.box([0, 0, 0], [1, 0, 1]), zeroset.ModelError, "volume|thick|box"),
        (lambda _: zeroset.sphere([0, 0, 0], radius=-1.0), zeroset.ModelError, "radius of -1"),
        (lambda _: zeroset.sphere([0, 0], radius=1.0), zeroset.ParameterError, "give 3 numbers"),
        (lambda _: zeroset.sphere([0, 0, np.nan], radius=1.0), zeroset.ParameterError, "give 3 numbers"),
        (lambda _: zeroset.Model.parse("box(1"), zeroset.ModelError, "character"),
        (lambda _: zeroset.Model.load("none.zset"), zeroset.FileMissingError, "none.zset: no such file"),
        (lambda _: zeroset.Model.load("none.doc"), zeroset.FormatError, "unknown solid format"),
        (lambda _: A.save("model.ply"), zeroset.FormatError, "unknown model format"),
        (lambda _: A.mesh(bounds=[[0, 0, 0]]), zeroset.ParameterError, "bounds"),
        (lambda _: A.mesh(bounds=[[5, 5, 5], [6, 6, 6]]), zeroset.NoSurfaceError, "no surface"),
        (lambda _: zeroset.half_space([0, 0, 0], normal=[0, 0, 1]).mesh(), zeroset.ModelError, "give the box to look in"),
        (lambda fitted: fitted.offset(1.0), zeroset.ModelError, "not possible"),
        (lambda _: zeroset.Model(), TypeError, "made by"),
    ],
)
def test_what_cannot_be_is_refused(torus_model: zeroset.Model, make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make(torus_model)
