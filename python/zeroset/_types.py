"""Types that several files share."""

import os
from collections.abc import Callable, Mapping
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
"""An array of float64."""
Path: TypeAlias = str | os.PathLike[str]
"""The name of a file."""
Progress: TypeAlias = Callable[[str, float], object]
"""Is called with the name of a stage and the share of the whole that is done, 0 to 1."""
Report: TypeAlias = Mapping[str, Any]
"""All figures of a run."""
Box: TypeAlias = npt.ArrayLike
"""The lowest and the highest corner of a box, shape (2, 3)."""

Scene: TypeAlias = Literal["auto", "object", "terrain", "airborne", "free"]
Up: TypeAlias = Literal["x", "y", "z", "-x", "-y", "-z"]
Quality: TypeAlias = Literal["draft", "normal", "fine"]
Attributes: TypeAlias = Literal["auto", "off", "rgb", "intensity", "class"]


def vector(value: npt.ArrayLike, name: str, size: int = 3) -> tuple[float, ...]:
    """Take a few numbers, such as a position.

    Parameters
    ----------
    value : array_like
        The numbers.
    name : str
        What they are, for the message.
    size : int
        How many there must be.

    Returns
    -------
    tuple of float
        The numbers.

    Raises
    ------
    ParameterError
        If it is not so many finite numbers.
    """
    from zeroset._errors import ParameterError

    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (size,) or not np.isfinite(array).all():
        raise ParameterError(f"{name} of {value!r} is not possible; give {size} numbers")
    return tuple(array.tolist())


def box(bounds: Box | None) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """Take the two corners of a box, or none.

    Parameters
    ----------
    bounds : array_like of shape (2, 3), optional
        The corners.

    Returns
    -------
    tuple, optional
        The corners.

    Raises
    ------
    ParameterError
        If it is not two positions.
    """
    if bounds is None:
        return None
    low, high = np.array_split(vector(np.ravel(bounds), "bounds", 6), 2)
    return tuple(low.tolist()), tuple(high.tolist())
