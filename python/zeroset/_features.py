"""Planes, edges and corners of a cloud."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from zeroset import _core, _optional
from zeroset._types import Floats, Path, Progress, Report, Scene, Up

Bend: TypeAlias = Literal["convex", "concave", "mixed", "unknown"]


@dataclass(frozen=True, eq=False)
class Plane:
    """A flat region.

    Attributes
    ----------
    normal : ndarray of shape (3,), float64
        Unit normal. It points outward where `oriented`, else up rather than down.
    offset : float
        ``normal @ x`` of its positions x, in world coordinates.
    oriented : bool
        Whether inside and outside are known.
    points : int
        Number of points on it.
    rms : float or None
        Root of the mean square of their distances from it; None for a plane without points of its own.
    area : float
        Area of the polygon.
    rings : list of ndarray of shape (n, 3), float64
        Its outline and holes, in world coordinates; the first position is not repeated.
    """

    normal: Floats
    offset: float
    oriented: bool
    points: int
    rms: float | None
    area: float
    rings: list[Floats]


@dataclass(frozen=True, eq=False)
class Edge:
    """A sharp edge.

    Attributes
    ----------
    kind : str
        ``"convex"``, ``"concave"`` or ``"unknown"``.
    planes : list of int
        The planes that meet in it; fewer than two where curved surfaces meet.
    polyline : ndarray of shape (n, 3), float64
        Its course in world coordinates: two positions if it is straight; the first is repeated at the end of a closed one.
    angle : float
        The angle by which the surface turns there, in degrees.
    length : float
        Length along the polyline.
    """

    kind: Bend
    planes: list[int]
    polyline: Floats
    angle: float
    length: float


@dataclass(frozen=True, eq=False)
class Corner:
    """A point where edges meet.

    Attributes
    ----------
    kind : str
        ``"convex"``, ``"concave"``, ``"mixed"`` or ``"unknown"``.
    position : ndarray of shape (3,), float64
        Where it is, in world coordinates.
    planes : list of int
        The planes that meet in it.
    edges : list of int
        The edges that end in it.
    """

    kind: Bend
    position: Floats
    planes: list[int]
    edges: list[int]


class Features:
    """What `features` found. It keeps the points, which the PLY format needs.

    Attributes
    ----------
    report : dict
        All figures of the run.
    """

    report: Report
    _found: _core.Features

    def __init__(self) -> None:
        raise TypeError("features are made by the function features")

    @classmethod
    def _of(cls, found: _core.Features, report: Report) -> Features:
        features = cls.__new__(cls)
        features._found, features.report = found, report
        return features

    def __repr__(self) -> str:
        return f"Features({len(self.planes)} planes, {len(self.edges)} edges, {len(self.corners)} corners)"

    @cached_property
    def planes(self) -> list[Plane]:
        """Flat regions, by falling area.

        Returns
        -------
        list of Plane
            The planes.
        """
        return [Plane(**plane) for plane in self._found.planes()]

    @cached_property
    def edges(self) -> list[Edge]:
        """Sharp edges.

        Returns
        -------
        list of Edge
            The edges.
        """
        return [Edge(**edge) for edge in self._found.edges()]

    @cached_property
    def corners(self) -> list[Corner]:
        """Corners, where edges meet.

        Returns
        -------
        list of Corner
            The corners.
        """
        return [Corner(**corner) for corner in self._found.corners()]

    @property
    def normals(self) -> Floats:
        """Unit normals of all planes.

        Returns
        -------
        ndarray of shape (p, 3), float64
            One row for each plane.
        """
        return np.array([plane.normal for plane in self.planes]).reshape(-1, 3)

    @property
    def offsets(self) -> Floats:
        """``normal @ x`` of all planes.

        Returns
        -------
        ndarray of shape (p,), float64
            One for each plane, in world coordinates.
        """
        return np.array([plane.offset for plane in self.planes])

    @property
    def corner_positions(self) -> Floats:
        """Positions of all corners.

        Returns
        -------
        ndarray of shape (c, 3), float64
            One row for each corner, in world coordinates.
        """
        return np.array([corner.position for corner in self.corners]).reshape(-1, 3)

    @cached_property
    def plane_of_point(self) -> npt.NDArray[np.int32]:
        """For each point the number of its plane.

        Returns
        -------
        ndarray of shape (n,), int32
            The number, or -1 for none.
        """
        found: npt.NDArray[np.int32] = self._found.plane_of_point()
        return found

    @cached_property
    def class_of_point(self) -> npt.NDArray[np.uint8]:
        """For each point what kind of place it lies at.

        Returns
        -------
        ndarray of shape (n,), uint8
            0 unstructured, 1 flat, 2 near an edge, 3 near a corner.
        """
        found: npt.NDArray[np.uint8] = self._found.class_of_point()
        return found

    @property
    def crs(self) -> str | None:
        """The coordinate reference system, as it was given.

        Returns
        -------
        str or None
            WKT or ``EPSG:n``.
        """
        return self._found.crs

    def save(self, path: Path) -> int:
        """Write the features, completely or not at all.

        Parameters
        ----------
        path : str or path-like
            A name that ends in .json, .geojson, .obj, .ply or .dxf.

        Returns
        -------
        int
            The number of bytes.

        Raises
        ------
        FileError
            If the file cannot be written.
        FormatError
            If the suffix is not known.
        """
        return self._found.save(path)

    def to_geodataframe(self) -> Any:
        """Convert to GeoPandas: planes are polygons, upright ones lines in plan; edges are lines, corners points.

        Returns
        -------
        geopandas.GeoDataFrame
            One row for each feature, with the columns of the GeoJSON format, in the reference system of the points.

        Raises
        ------
        ImportError
            If GeoPandas is not installed.
        """
        geopandas = _optional.load("geopandas")
        with tempfile.TemporaryDirectory() as folder:
            path = FilePath(folder, "features.geojson")
            self.save(path)
            rows = json.loads(path.read_text(encoding="utf-8"))["features"]
        if not rows:
            return geopandas.GeoDataFrame(geometry=[], crs=self.crs)
        return geopandas.GeoDataFrame.from_features(rows, crs=self.crs)


def features(
    points: npt.ArrayLike,
    *,
    scene: Scene = "auto",
    up: Up = "z",
    min_area: float | None = None,
    max_distance: float | None = None,
    max_angle: float | None = None,
    sharp_angle: float = 30.0,
    posture: Literal["upright", "free"] = "upright",
    colors: npt.ArrayLike | None = None,
    intensities: npt.ArrayLike | None = None,
    classes: npt.ArrayLike | None = None,
    crs: str | None = None,
    memory: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Features:
    """Find flat regions, sharp edges and corners in raw points.

    Parameters
    ----------
    points : array_like of shape (n, 3)
        World positions, as for `reconstruct`.
    scene : {"auto", "object", "terrain", "airborne", "free"}
        What is known of the scene.
    up : {"z", "x", "y", "-x", "-y", "-z"}
        The axis that points to the sky.
    min_area : float, optional
        Smallest area of a plane; by default 16 points' worth, or more under much noise.
    max_distance : float, optional
        Farthest that a point lies from its plane; by default 3 times the measured noise.
    max_angle : float, optional
        Largest angle between a plane and the surface around its points, in degrees; by default 40.
    sharp_angle : float
        Angle by which the surface turns at an edge, at least, in degrees.
    posture : {"upright", "free"}
        Whether walls of terrain are upright and flats level, unless their points contradict.
    colors : array_like of shape (n, 3), optional
        Red, green and blue of each point, for the PLY format.
    intensities : array_like of shape (n,), optional
        Strength of the return of each point, likewise.
    classes : array_like of shape (n,), optional
        ASPRS class of each point, likewise.
    crs : str, optional
        The coordinate reference system, which is passed on.
    memory : int, optional
        Bytes to use at most; by default 70 % of what is free.
    threads : int, optional
        Threads to use; all by default. The result does not depend on it.
    progress : callable, optional
        Is called with the name of a stage and the share that is done.

    Returns
    -------
    Features
        The planes, edges and corners.

    Raises
    ------
    InputError
        If the points have a wrong shape or type, are not finite, too few, or on one line.
    ParameterError
        If a value is not possible.

    Examples
    --------
    >>> import zeroset
    >>> zeroset.features(zeroset.sample("box", points=20_000), scene="object")
    Features(6 planes, 12 edges, 8 corners)
    """
    options: dict[str, Any] = dict(locals())
    return Features._of(*_core.features(options.pop("points"), options))
