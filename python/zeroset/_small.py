"""The small exact tools: several flats at once, and the normalised fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from zeroset import _core
from zeroset._mesh import Mesh
from zeroset._types import Box, Floats, Progress

Basis: TypeAlias = Literal[
    "p1", "p2", "gaussian", "multiquadric", "inverse-multiquadric", "thin-plate", "wendland-c2", "wendland-c4"
]


def _width(points: npt.ArrayLike) -> int:
    """Tell how many coordinates points have."""
    shape = np.shape(points)
    return shape[1] if len(shape) == 2 else 0


@dataclass(frozen=True, eq=False)
class Newe:
    """Flats through points: lines in the plane, planes in space.

    Attributes
    ----------
    normals : ndarray of shape (k, d), float64
        Unit normals, by falling number of points. Their signs have no meaning.
    offsets : ndarray of shape (k,), float64
        ``normal @ x`` of the positions x of each flat.
    assignment : ndarray of shape (n,), int32
        For each point the flat that it lies on; -1 for an outlier.
    noise : float
        Standard deviation of the points across their flats.
    objective : float
        Sum of the squared distances over the squared noise, each at most 9.
    criterion : float
        What the number of flats was chosen by: the least wins.
    corner : ndarray of shape (d,), float64
        Where the flats meet: the nearest such position to the mean of the points.
    rank : int
        How many independent directions they fix: d at a corner, one less along an edge.
    """

    normals: Floats
    offsets: Floats
    assignment: npt.NDArray[np.int32]
    noise: float
    objective: float
    criterion: float
    corner: Floats
    rank: int


def newe(
    points: npt.ArrayLike,
    k: int | None = None,
    *,
    most: int = 4,
    normalization: Literal["affine", "homogeneous"] = "affine",
    schedule: Sequence[float] | None = None,
    starts: int = 8,
    noise: float | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> Newe:
    """Fit several flats at once to unordered points.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Positions. C-contiguous float64 is read where it lies.
    k : int, optional
        How many flats; by default 1 to `most`, chosen by a criterion.
    most : int
        The most flats, where `k` is left out.
    normalization : {"affine", "homogeneous"}
        Unit normals, or unit coefficients as the paper prints it.
    schedule : sequence of float, optional
        Exponents of the weights, one for each iteration; by default 32, 16, 8, 4, 2.
    starts : int
        How many starts are tried for each number of flats.
    noise : float, optional
        Standard deviation of the points across their flats; measured by default.
    seed : int
        Seed of the random starts.
    threads : int, optional
        Threads to use; all by default.

    Returns
    -------
    Newe
        The flats.

    Raises
    ------
    InputError
        If the points have a wrong shape or type, are not finite, or too few for so many flats.
    ParameterError
        If a value is not possible.

    Examples
    --------
    >>> import zeroset
    >>> points = [[0, 0], [1, 0], [2, 0], [3, 0], [0, 1], [0, 2], [0, 3], [0, 4]]
    >>> zeroset.newe(points, 2).rank
    2
    """
    options: dict[str, Any] = {**locals(), "progress": None}
    return Newe(**_core.newe(options.pop("points"), _width(points), options))


class NormalizedFit:
    """The normalised implicit fit, small and exact: the F of least E(F) / N(F), in the plane or in space.

    E sums the squares of F over the points and segments, and smoothness; N keeps F from being zero. F is negative inside. The fit is
    made at once.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Positions.
    weights : array_like of shape (n,), optional
        Weight of each point, positive; 1 by default.
    segments : array_like of shape (m, 2, d)
        Segments, of which every position counts.
    line_weight : float
        Weight of each unit of their length.
    domain : {"lattice", "four"} or tuple
        Cells over a box, four triangles over a rectangle, or a mesh: vertices of shape (v, d) and simplices of shape (s, d + 1).
    bounds : array_like of shape (2, d), optional
        The box; by default that of the data, grown by a tenth of its longest side.
    cells : int, optional
        Cells along the longest side of the box; by default 4 without smoothness, else by the number of points.
    basis : str
        What F is made of: ``"p1"``, ``"p2"``, ``"gaussian"``, ``"multiquadric"``, ``"inverse-multiquadric"``, ``"thin-plate"``,
        ``"wendland-c2"`` or ``"wendland-c4"``.
    centres : int, optional
        Most centres of radial functions; 60 by default.
    width : float, optional
        Width of radial functions; by default a few mean distances of the centres.
    normalization : {"coefficients", "squared-gradient", "mean-gradient"}
        What N is.
    order : {0, 1, 2}
        Which derivatives smoothness takes; 0 is none.
    smoothness : float, optional
        Its weight, 0 or more; by default as in ``zeroset fit2d``, by the weight of the data.
    solver : {"auto", "dense", "shift-invert", "lobpcg"}
        The eigensolver.
    threads : int, optional
        Threads to use; all by default.
    progress : callable, optional
        Is called with the name of a stage and the share that is done.

    Attributes
    ----------
    coefficients : ndarray of shape (f,), float64
        One for each function of the basis.
    nodes : ndarray of shape (f, d), float64
        Where the functions sit.
    rayleigh_quotient : float
        E / N, the least there is.
    spectrum : ndarray, float64
        The smallest values of E / N at its stationary points.
    residuals : ndarray, float64
        For each point, then each segment, the root of its mean F squared.
    residual_rms, distance_rms : float
        The root of the mean of F squared over all data; the same as a distance from the zero set.
    smoothness : float
        The weight of smoothness.
    warnings : list of str
        What may be wrong with the fit, each with its remedy.

    Raises
    ------
    InputError
        If an array has a wrong shape or type, or data lie outside of the domain.
    ParameterError
        If a value is not possible.
    FitError
        If the problem has no solution.

    Examples
    --------
    >>> import numpy as np, zeroset
    >>> angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    >>> fit = zeroset.NormalizedFit(np.c_[np.cos(angles), np.sin(angles)], order=2, normalization="squared-gradient")
    >>> bool(fit([[0.0, 0.0]])[0] < 0)
    True
    """

    coefficients: Floats
    nodes: Floats
    rayleigh_quotient: float
    spectrum: Floats
    residuals: Floats
    residual_rms: float
    distance_rms: float
    smoothness: float
    warnings: list[str]

    def __init__(
        self,
        points: npt.ArrayLike,
        *,
        weights: npt.ArrayLike | None = None,
        segments: npt.ArrayLike = (),
        line_weight: float = 1.0,
        domain: Literal["lattice", "four"] | tuple[npt.ArrayLike, npt.ArrayLike] = "lattice",
        bounds: Box | None = None,
        cells: int | None = None,
        basis: Basis = "p1",
        centres: int | None = None,
        width: float | None = None,
        normalization: Literal["coefficients", "squared-gradient", "mean-gradient"] = "coefficients",
        order: Literal[0, 1, 2] = 0,
        smoothness: float | None = None,
        solver: Literal["auto", "dense", "shift-invert", "lobpcg"] = "auto",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        options: dict[str, Any] = dict(locals())
        del options["self"]
        if not isinstance(domain, str):
            vertices, simplices = domain
            options["domain"] = (vertices, np.asarray(simplices).tolist())
        self._fit = _core.normalized_fit(options.pop("points"), _width(points), options)
        vars(self).update(self._fit.figures())

    def __repr__(self) -> str:
        return f"NormalizedFit({len(self.coefficients)} functions, rayleigh_quotient={self.rayleigh_quotient:.6g})"

    def __call__(self, points: npt.ArrayLike) -> Floats:
        """Give F at points.

        Parameters
        ----------
        points : array_like of shape (n, d)
            Positions.

        Returns
        -------
        ndarray of shape (n,), float64
            F; NaN outside of the domain and where nothing tells it.

        Raises
        ------
        InputError
            If the points have a wrong shape or type.
        """
        values: Floats = self._fit.evaluate(points)[0]
        return values

    def gradient(self, points: npt.ArrayLike) -> Floats:
        """Give the gradient of F at points.

        Parameters
        ----------
        points : array_like of shape (n, d)
            Positions.

        Returns
        -------
        ndarray of shape (n, d), float64
            The gradients; NaN where F is not known.

        Raises
        ------
        InputError
            If the points have a wrong shape or type.
        """
        gradients: Floats = self._fit.evaluate(points)[1]
        return gradients

    def lines(self, *, tolerance: float | None = None, branches: Literal["data", "all"] = "data") -> list[Floats]:
        """Trace the zero set in the plane.

        Parameters
        ----------
        tolerance : float, optional
            Farthest that a line lies from the zero set; by default a thousandth of the longer side of the domain.
        branches : {"data", "all"}
            Only what holds data and what continues it, or all.

        Returns
        -------
        list of ndarray of shape (n, 2), float64
            Polylines with F < 0 on the left; closed ones repeat their first position.

        Raises
        ------
        ParameterError
            If the fit is in space.
        """
        if tolerance is None:
            nodes = self.nodes[np.isfinite(self.nodes).all(axis=1)]
            tolerance = 1e-3 * float(np.ptp(nodes, axis=0).max())
        lines = self._fit.lines(tolerance, branches == "all")
        return [np.concatenate([line, line[:1]]) if is_closed else line for line, is_closed in lines]

    def mesh(self, *, subdivisions: int = 2, branches: Literal["data", "all"] = "data") -> Mesh:
        """Trace the zero set in space.

        Parameters
        ----------
        subdivisions : int
            How often the edges of the cells are halved first, 0 to 7; not for linear functions.
        branches : {"data", "all"}
            Only what holds data and what continues it, or all.

        Returns
        -------
        Mesh
            The surface, open where the domain ends.

        Raises
        ------
        ParameterError
            If the fit is in the plane.
        """
        return Mesh._of(self._fit.surface(subdivisions, branches == "all"))
