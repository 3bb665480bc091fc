"""Points that can be used, and points that cannot."""

from typing import Any

import numpy as np
import pytest

import zeroset
from zeroset import _core
from zeroset._types import Floats

BALL = zeroset.sphere([0, 0, 0], radius=1.0)


def test_a_million_points_are_read_where_they_lie() -> None:
    points = np.random.default_rng(0).random((1_000_000, 3))
    assert _core.address(points) == points.ctypes.data


@pytest.mark.parametrize(
    "other",
    [
        lambda p: p.astype(np.float32),
        lambda p: np.asfortranarray(p),
        lambda p: np.repeat(p, 2, axis=0)[::2],
        lambda p: np.c_[p, p][:, :3],
        lambda p: p[::-1],
        lambda p: p.astype(">f8"),
        lambda p: np.frombuffer(b"\0" + p.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(-1, 3),
    ],
    ids=["float32", "fortran", "strided rows", "strided columns", "reversed", "big-endian", "unaligned"],
)
def test_other_layouts_are_converted(other: Any) -> None:
    points = np.random.default_rng(0).random((50, 3)).astype(np.float32).astype(np.float64)
    given = other(points)
    assert _core.address(given) != given.ctypes.data
    np.testing.assert_array_equal(BALL(given), BALL(np.array(given, np.float64)))


def test_lists_and_integers_are_taken() -> None:
    np.testing.assert_allclose(BALL([[2, 0, 0], (0, 0, 3)]), [1.0, 2.0])
    np.testing.assert_allclose(BALL(np.array([[2, 0, 0]], np.int16)), [1.0])
    assert BALL(np.empty((0, 3))).shape == (0,)


def test_what_comes_out_was_moved(torus_model: zeroset.Model) -> None:
    mesh = torus_model.mesh()
    for array in (mesh.local, mesh.triangles):
        assert array.flags.c_contiguous and array.flags.writeable
        # The array is a view of the vector that NumPy took over.
        assert array.base is not None and array.base.ctypes.data == array.ctypes.data
    assert zeroset.Mesh(mesh.local, mesh.triangles).local is mesh.local


NAN = np.random.default_rng(0).random((100, 3))
NAN[[3, 7]] = [np.nan, np.inf, 0.0]

BAD: list[tuple[Any, str]] = [
    (np.zeros((10, 2)), r"shape \(10, 2\); give an array of shape \(n, 3\)"),
    (np.zeros(30), r"shape \(30,\)"),
    (np.zeros((2, 5, 3)), r"shape \(2, 5, 3\)"),
    (np.zeros((10, 3), complex), "type complex128"),
    (np.zeros((10, 3), bool), "type bool"),
    (np.full((10, 3), "a"), "type <U1"),
    (np.full((10, 3), None), "type object"),
    ([[1, 2, 3], [4, 5]], "cannot be made an array"),
    (None, "type object"),
    (NAN, "2 of 100 points are NaN or infinite"),
    (np.full((10, 3), 1e12), "10 of 10 points have coordinates beyond"),
]


@pytest.mark.parametrize(("points", "message"), BAD, ids=[message for _, message in BAD])
@pytest.mark.parametrize("function", [zeroset.reconstruct, zeroset.fit, zeroset.features, BALL], ids=str)
def test_bad_points_are_refused(function: Any, points: Any, message: str) -> None:
    with pytest.raises(zeroset.InputError, match=message):
        function(points)


@pytest.mark.parametrize("function", [zeroset.reconstruct, zeroset.fit, zeroset.features])
def test_points_without_a_surface_are_refused(function: Any) -> None:
    with pytest.raises(zeroset.InputError, match="too few points to fit a surface: 0; give at least 8"):
        function(np.empty((0, 3)))
    with pytest.raises(zeroset.InputError, match="on one line"):
        function(np.outer(np.arange(100.0), [1.0, 2.0, 3.0]))


def test_values_beside_the_points_must_fit(torus: Floats) -> None:
    count = len(torus)
    with pytest.raises(zeroset.InputError, match=rf"classes have shape \(3,\); give an array of shape \({count},\)"):
        zeroset.reconstruct(torus, classes=[1, 2, 3])
    with pytest.raises(zeroset.InputError, match="classes hold numbers outside of 0 to 255"):
        zeroset.reconstruct(torus, classes=np.full(count, 300))
    with pytest.raises(zeroset.InputError, match="colors are of type float64"):
        zeroset.reconstruct(torus, colors=np.zeros((count, 3)))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"scene": "house"}, zeroset.ParameterError, "scene of 'house' is not known; give one of: auto, object"),
        ({"up": "w"}, zeroset.ParameterError, "up of 'w'"),
        ({"resolution": -1.0}, zeroset.ParameterError, "resolution of -1"),
        ({"resolution": 0.1, "depth": 7}, zeroset.ParameterError, "give one of them"),
        ({"trim": "never"}, zeroset.ParameterError, "trim of 'never'"),
        ({"screening": 0.0}, zeroset.ParameterError, "screening of 0"),
        ({"triangles": 0}, zeroset.ParameterError, "triangles"),
        ({"max_error": -1.0}, zeroset.ParameterError, "check triangles and max_error"),
        ({"threads": 0}, zeroset.ParameterError, "0 threads"),
        ({"resolution": 1e-4, "memory": 10**8}, zeroset.MemoryLimitError, "needs about .* give a resolution of"),
        ({"constraints": "none.dxf"}, zeroset.FileMissingError, "none.dxf: no such file"),
        ({"resolution": "fine"}, TypeError, "resolution cannot be of type str"),
        ({"progress": 3}, TypeError, "not callable"),
    ],
    ids=str,
)
def test_bad_parameters_are_refused(torus: Floats, options: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message) as caught:
        zeroset.reconstruct(torus, **options)
    assert "--" not in str(caught.value) and "\n" not in str(caught.value)


def test_parameters_have_names() -> None:
    with pytest.raises(TypeError, match="positional"):
        zeroset.reconstruct(np.zeros((10, 3)), "object")  # type: ignore[call-arg]


def test_errors_are_of_their_kind() -> None:
    kinds: dict[type[Exception], type[Exception]] = {
        zeroset.InputError: ValueError,
        zeroset.ParameterError: ValueError,
        zeroset.MemoryLimitError: MemoryError,
        zeroset.FileError: OSError,
        zeroset.FileMissingError: FileNotFoundError,
        zeroset.FormatError: ValueError,
    }
    for own, known in kinds.items():
        assert issubclass(own, zeroset.ZerosetError) and issubclass(own, known)
