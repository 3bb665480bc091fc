"""Shapes to cut and join with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from zeroset import _core
from zeroset._errors import InputError
from zeroset._model import Model
from zeroset._types import vector


def box(low: npt.ArrayLike, high: npt.ArrayLike) -> Model:
    """Make a box along the axes.

    Parameters
    ----------
    low, high : array_like of shape (3,)
        Two opposite corners.

    Returns
    -------
    Model
        The box.

    Raises
    ------
    ParameterError
        If a corner is not three finite numbers.
    ModelError
        If it has no volume.
    """
    return Model._of(_core.Solid.cuboid(vector(low, "low"), vector(high, "high")))


def sphere(center: npt.ArrayLike, *, radius: float) -> Model:
    """Make a ball.

    Parameters
    ----------
    center : array_like of shape (3,)
        Its centre.
    radius : float
        Its radius, positive.

    Returns
    -------
    Model
        The ball.

    Raises
    ------
    ParameterError
        If the centre is not three finite numbers.
    ModelError
        If the radius is not positive.
    """
    return Model._of(_core.Solid.ball(vector(center, "center"), radius))


def cylinder(start: npt.ArrayLike, end: npt.ArrayLike, *, radius: float) -> Model:
    """Make a cylinder.

    Parameters
    ----------
    start, end : array_like of shape (3,)
        The ends of its axis.
    radius : float
        Its radius, positive.

    Returns
    -------
    Model
        The cylinder.

    Raises
    ------
    ParameterError
        If an end is not three finite numbers.
    ModelError
        If it has no volume.
    """
    return cone(start, end, radii=(radius, radius))


def cone(start: npt.ArrayLike, end: npt.ArrayLike, *, radii: npt.ArrayLike) -> Model:
    """Make a cone, whole or truncated.

    Parameters
    ----------
    start, end : array_like of shape (3,)
        The ends of its axis.
    radii : array_like of shape (2,)
        The radius at each end; one may be zero.

    Returns
    -------
    Model
        The cone.

    Raises
    ------
    ParameterError
        If an end is not three finite numbers.
    ModelError
        If it has no volume.
    """
    ends = vector(start, "start"), vector(end, "end")
    return Model._of(_core.Solid.frustum(ends, vector(radii, "radii", 2)))


def half_space(point: npt.ArrayLike, *, normal: npt.ArrayLike) -> Model:
    """Take all on one side of a plane. It has no end, so cut it with something else.

    Parameters
    ----------
    point : array_like of shape (3,)
        A position on the plane.
    normal : array_like of shape (3,)
        The direction out of the solid, of any length.

    Returns
    -------
    Model
        The half space.

    Raises
    ------
    ParameterError
        If these are not three finite numbers each.
    ModelError
        If the normal is zero.
    """
    return Model._of(_core.Solid.half_space(vector(point, "point"), vector(normal, "normal")))


def prism(rings: Sequence[npt.ArrayLike], *, heights: npt.ArrayLike) -> Model:
    """Extrude a polygon.

    Parameters
    ----------
    rings : sequence of array_like of shape (n, 2)
        Rings in plan, not closed by a repeated position; what lies within an odd number of them is solid.
    heights : array_like of shape (2,)
        The two heights.

    Returns
    -------
    Model
        The prism.

    Raises
    ------
    InputError
        If a ring has another shape.
    ModelError
        If it has no volume, or rings cross.
    """
    arrays = [np.asarray(ring, dtype=np.float64) for ring in rings]
    for ring in arrays:
        if ring.ndim != 2 or ring.shape[1] != 2:
            raise InputError(f"a ring has shape {ring.shape}; give positions of shape (n, 2)")
    return Model._of(_core.Solid.prism([list(map(tuple, ring.tolist())) for ring in arrays], vector(heights, "heights", 2)))


def height_field(heights: npt.ArrayLike, *, origin: npt.ArrayLike = (0.0, 0.0), step: npt.ArrayLike = (1.0, 1.0)) -> Model:
    """Take all that lies under a grid of heights.

    Parameters
    ----------
    heights : array_like of shape (rows, columns)
        The height at each node; x grows along a row, y from row to row.
    origin : array_like of shape (2,)
        Where the first node is.
    step : array_like of shape (2,)
        Distances between nodes along x and y, positive.

    Returns
    -------
    Model
        The ground.

    Raises
    ------
    InputError
        If the heights are no grid.
    ModelError
        If a height is not finite, or there are fewer than two nodes along a side.
    """
    grid = np.ascontiguousarray(heights, dtype=np.float64)
    if grid.ndim != 2:
        raise InputError(f"heights have shape {grid.shape}; give a grid of shape (rows, columns)")
    return Model._of(_core.Solid.height_field(vector(origin, "origin", 2), vector(step, "step", 2), grid))
