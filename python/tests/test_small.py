"""Several flats at once, and the normalised fit."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import zeroset

RNG = np.random.default_rng(0)
BOWL = [
    (0.44, 0.13), (0.24, 0.15), (0.22, 0.35), (0.31, 0.49), (0.35, 0.60), (0.43, 0.70), (0.51, 0.77),
    (0.57, 0.70), (0.70, 0.55), (0.85, 0.30), (0.88, 0.23), (0.80, 0.10), (0.60, 0.10),
]  # fmt: skip


def test_three_planes_meet_in_a_corner() -> None:
    uv = RNG.random((60, 2))
    zero = np.zeros(60)
    faces = [np.c_[uv, zero], np.c_[zero, uv], np.c_[uv[:, 0], zero, uv[:, 1]]]
    points = np.concatenate(faces) + [5.0, 6.0, 7.0] + RNG.normal(0.0, 1e-3, (180, 3))
    found = zeroset.newe(points, 3)
    assert found.rank == 3 and found.normals.shape == (3, 3) and found.assignment.shape == (180,)
    np.testing.assert_allclose(found.corner, [5.0, 6.0, 7.0], atol=2e-3)
    assert found.noise == pytest.approx(1e-3, rel=0.3)
    assert len(zeroset.newe(points).normals) == 3


def test_bad_points_for_flats() -> None:
    with pytest.raises(zeroset.InputError, match="2 points do not determine"):
        zeroset.newe([[0, 0], [1, 1]], 2)
    with pytest.raises(zeroset.InputError, match=r"shape \(n, 2\) or \(n, 3\)"):
        zeroset.newe(np.zeros((5, 4)), 2)
    with pytest.raises(zeroset.InputError, match="not finite"):
        zeroset.newe(np.full((9, 2), np.nan), 2)
    with pytest.raises(zeroset.ParameterError, match="no flats"):
        zeroset.newe(np.zeros((5, 2)), 0)


def test_the_first_example_of_the_paper() -> None:
    fit = zeroset.NormalizedFit(BOWL, domain="four", bounds=[[0, 0], [1, 1]])
    assert fit.rayleigh_quotient == pytest.approx(0.0433972, abs=1e-7)
    assert fit([[0.5, 0.4]])[0] < 0.0 and np.isnan(fit([[2.0, 2.0]])[0])
    assert fit.coefficients.shape == (5,) and fit.nodes.shape == (5, 2)
    vertices = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    own = zeroset.NormalizedFit(BOWL, domain=(vertices, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]))
    assert own.rayleigh_quotient == pytest.approx(fit.rayleigh_quotient)


TURN = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
CIRCLE = np.c_[np.cos(TURN), np.sin(TURN)]


@pytest.mark.parametrize("basis", ["p1", "p2"])
def test_a_circle(basis: Any) -> None:
    fit = zeroset.NormalizedFit(CIRCLE, order=2, basis=basis, normalization="squared-gradient")
    lines = fit.lines()
    assert len(lines) == 1 and np.array_equal(lines[0][0], lines[0][-1])
    np.testing.assert_allclose(np.linalg.norm(lines[0], axis=1), 1.0, atol=0.03)
    slope = fit.gradient(CIRCLE)
    assert (np.einsum("ij,ij->i", slope, CIRCLE) > 0.0).all()


def test_radial_functions_are_those_of_the_command(tmp_path: Path) -> None:
    fit = zeroset.NormalizedFit(CIRCLE, basis="gaussian", centres=20, normalization="squared-gradient")
    np.savetxt(tmp_path / "circle.csv", CIRCLE, delimiter=",")
    words = "circle.csv -o circle.json --basis gaussian --centres 20 --normalization squared-gradient".split()
    subprocess.run([sys.executable, "-m", "zeroset", "fit2d", *words], cwd=tmp_path, check=True)
    found = json.loads((tmp_path / "circle.json").read_text())
    np.testing.assert_allclose(fit.rayleigh_quotient, found["rayleigh_quotient"], rtol=1e-9)


def test_segments_and_weights() -> None:
    square = np.array([[[0, 0], [1, 0]], [[1, 0], [1, 1]], [[1, 1], [0, 1]], [[0, 1], [0, 0]]], float)
    fit = zeroset.NormalizedFit(np.empty((0, 2)), segments=square, order=2, normalization="mean-gradient")
    assert fit([[0.5, 0.5]])[0] < 0.0 < fit([[-0.05, 0.5]])[0]
    assert fit.residuals.shape == (4,)
    with pytest.raises(zeroset.InputError, match="2 weights for 13 points"):
        zeroset.NormalizedFit(BOWL, weights=[1.0, 2.0])


def test_a_sphere_in_space() -> None:
    points = RNG.normal(size=(300, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    fit = zeroset.NormalizedFit(points, order=2, cells=8, normalization="squared-gradient")
    mesh = fit.mesh()
    assert mesh.is_closed
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1.0, atol=0.08)
    with pytest.raises(zeroset.ParameterError, match="surface"):
        fit.lines()


def test_bad_input_for_fits() -> None:
    cases: list[tuple[Any, dict[str, Any], type[Exception]]] = [
        (np.zeros((5, 4)), {}, zeroset.InputError),
        (np.full((5, 2), np.nan), {}, zeroset.InputError),
        (np.zeros((5, 2)), {}, zeroset.InputError),
        (BOWL, {"bounds": [[0, 0], [0.5, 0.5]]}, zeroset.InputError),
        (BOWL, {"order": 3}, zeroset.ParameterError),
        (BOWL, {"cells": 0}, zeroset.ParameterError),
        (BOWL, {"basis": "p3"}, zeroset.ParameterError),
        (BOWL, {"smoothness": -1.0, "order": 1}, zeroset.ParameterError),
        (BOWL, {"segments": [[0.0, 1.0]]}, zeroset.InputError),
    ]
    for points, options, error in cases:
        with pytest.raises(error):
            zeroset.NormalizedFit(points, **options)
