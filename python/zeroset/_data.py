"""Points out of files and of test scenes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from zeroset import _core
from zeroset._mesh import Mesh
from zeroset._types import Floats, Path

Kind: TypeAlias = Literal["city", "airborne-city", "sphere", "torus", "box", "l-block", "stairs", "pocket-plate"]


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points with what was measured beside them.

    Attributes
    ----------
    points : ndarray of shape (n, 3), float64
        World positions.
    colors : ndarray of shape (n, 3), uint8, or None
        Red, green and blue.
    intensities : ndarray of shape (n,), float32, or None
        Strength of the return.
    classes : ndarray of shape (n,), uint8, or None
        ASPRS classes.
    crs : str or None
        The coordinate reference system, as the file states it.
    """

    points: Floats
    colors: npt.NDArray[np.uint8] | None
    intensities: npt.NDArray[np.float32] | None
    classes: npt.NDArray[np.uint8] | None
    crs: str | None


def read(*paths: Path) -> Cloud:
    """Read files as one cloud.

    Parameters
    ----------
    *paths : str or path-like
        Files of type LAS, LAZ, PLY, XYZ, TXT, CSV, ASC, PTS, PCD or E57; the suffix tells which.

    Returns
    -------
    Cloud
        All points. Where only some files have an attribute, points of the others get white, 0 or class 0.

    Raises
    ------
    FileMissingError
        If there is no such file.
    FormatError
        If a file is damaged, or of another format.
    """
    return Cloud(**_core.read_points(list(paths)))


def sample(kind: Kind, *, points: int = 100_000, noise: float | None = None, seed: int = 0) -> Floats:
    """Make points of a test scene.

    Parameters
    ----------
    kind : str
        What it shows: ``"city"``, ``"airborne-city"``, ``"sphere"``, ``"torus"``, ``"box"``, ``"l-block"``, ``"stairs"`` or
        ``"pocket-plate"``.
    points : int
        How many.
    noise : float, optional
        Standard deviation of each coordinate, 0 or more; by default 0.001.
    seed : int
        Another seed gives other points, and another city.

    Returns
    -------
    ndarray of shape (n, 3), float64
        The points. The airborne scanner returns a few more or fewer than asked for.

    Raises
    ------
    ParameterError
        If the scene is not known, or the noise negative.
    """
    made: Floats = _core.sample(kind, points, noise, seed)[0]
    return made


def sample_truth(kind: Kind, *, seed: int = 0) -> Mesh:
    """Give the exact surface of a test scene.

    Parameters
    ----------
    kind : str
        The scene, as for `sample`.
    seed : int
        The seed of the city.

    Returns
    -------
    Mesh
        The surface; of sphere and torus a fine mesh inscribed in it.

    Raises
    ------
    ParameterError
        If the scene is not known.
    """
    return Mesh._of(_core.sample(kind, 0, None, seed)[1])
