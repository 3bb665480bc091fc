"""Models: solids that are asked, measured, cut and joined."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from zeroset import _core
from zeroset._mesh import Mesh
from zeroset._types import Attributes, Box, Floats, Path, Progress, Report, box, vector


class Volume(NamedTuple):
    """A measured volume, in cubic units.

    Attributes
    ----------
    volume : float
        The volume.
    error : float
        How far it may be off: twice the standard error.
    """

    volume: float
    error: float


class Change(NamedTuple):
    """What changed from one solid to another.

    Attributes
    ----------
    cut : Volume
        What is only in the first.
    fill : Volume
        What is only in the second.
    net : Volume
        The second less the first.
    """

    cut: Volume
    fill: Volume
    net: Volume


class Model:
    """A solid in world coordinates, known everywhere: F < 0 inside, F > 0 outside.

    Models come from `fit`, `Model.load`, `Model.parse`, `Model.of_mesh` and the shapes: `box`, `sphere`, `cylinder`, `cone`,
    `half_space`, `prism` and `height_field`. A model is called with points to get F, which is about the distance near the surface.
    ``a | b`` is all that lies in one or both, ``a & b`` what lies in both, ``a - b`` what lies in a only, ``~a`` all the rest. Models
    never change: operations make new ones.

    Attributes
    ----------
    report : dict
        All figures of the fit; empty for others.

    Examples
    --------
    >>> import zeroset
    >>> part = zeroset.box([0, 0, 0], [4, 2, 1]) - zeroset.cylinder([2, 1, -1], [2, 1, 2], radius=0.5)
    >>> part([[1.0, 1.0, 0.5], [2.0, 1.0, 0.5]])
    array([-0.5,  0.5])
    """

    def __init__(self) -> None:
        raise TypeError("models are made by fit, load, parse, of_mesh, and shapes such as box")

    _solid: _core.Solid
    report: Report

    @classmethod
    def _of(cls, solid: _core.Solid, report: Report | None = None) -> Model:
        model = cls.__new__(cls)
        model._solid = solid
        model.report = report or {}
        return model

    @classmethod
    def load(cls, path: Path) -> Model:
        """Read a model, a TOML tree of operands, or a closed mesh.

        Parameters
        ----------
        path : str or path-like
            The file; its suffix tells what it is.

        Returns
        -------
        Model
            The model.

        Raises
        ------
        FileMissingError
            If there is no such file.
        FormatError
            If the file is damaged, or of another format.
        ModelError
            If a mesh is not closed, or a tree cannot be understood.
        """
        return cls._of(_core.Solid.load(path))

    @classmethod
    def parse(cls, text: str) -> Model:
        """Make a model of an expression, such as those of ``zeroset edit``.

        Parameters
        ----------
        text : str
            The expression, as in ``"box(0,0,0; 10,5,3) rotate(z, 30deg)"``.

        Returns
        -------
        Model
            The model.

        Raises
        ------
        ModelError
            If it cannot be understood; the message tells the place.
        FileError
            If a file that it names cannot be read.
        """
        return cls._of(_core.Solid.expression(text))

    @classmethod
    def of_mesh(cls, mesh: Mesh) -> Model:
        """Take what a closed mesh surrounds.

        Parameters
        ----------
        mesh : Mesh
            The mesh, which is copied.

        Returns
        -------
        Model
            The model. Unlike fitted ones it can be offset, and made a shell of.

        Raises
        ------
        ModelError
            If the mesh is not closed.
        """
        return cls._of(_core.Solid.of_mesh(mesh))

    def __repr__(self) -> str:
        kind, operands = self._solid.kind()
        return f"Model({kind} of {operands})" if operands else f"Model({kind})"

    @property
    def crs(self) -> str | None:
        """The coordinate reference system, as the points stated it.

        Returns
        -------
        str or None
            WKT or ``EPSG:n``.
        """
        return self._solid.crs

    @property
    def provenance(self) -> Report:
        """What the model was made from, and how.

        Returns
        -------
        dict
            ``version``, ``inputs`` and ``parameters``.
        """
        return self._solid.provenance()

    def __call__(self, points: npt.ArrayLike) -> Floats:
        """Give F at points.

        Parameters
        ----------
        points : array_like of shape (n, 3)
            World positions. C-contiguous float64 is read where it lies; others are converted once. Do not write to the array from
            another thread meanwhile.

        Returns
        -------
        ndarray of shape (n,), float64
            F: negative inside, and about the distance near the surface.

        Raises
        ------
        InputError
            If the points have a wrong shape or type, or are not finite.
        """
        return self.evaluate(points)[0]

    def gradient(self, points: npt.ArrayLike) -> Floats:
        """Give the gradient of F at points. It points outward.

        Parameters
        ----------
        points : array_like of shape (n, 3)
            World positions.

        Returns
        -------
        ndarray of shape (n, 3), float64
            The gradients.

        Raises
        ------
        InputError
            If the points have a wrong shape or type, or are not finite.
        """
        return self.evaluate(points)[1]

    def evaluate(
        self, points: npt.ArrayLike, *, threads: int | None = None, progress: Progress | None = None
    ) -> tuple[Floats, Floats]:
        """Give F and its gradient at points.

        Parameters
        ----------
        points : array_like of shape (n, 3)
            World positions.
        threads : int, optional
            Threads to use; all by default.
        progress : callable, optional
            Is called with the name of a stage and the share that is done.

        Returns
        -------
        values : ndarray of shape (n,), float64
            F.
        gradients : ndarray of shape (n, 3), float64
            Its gradients.

        Raises
        ------
        InputError
            If the points have a wrong shape or type, or are not finite.
        """
        return self._solid.evaluate(points, {"threads": threads, "progress": progress})

    def contains(self, points: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Tell which points lie inside.

        Parameters
        ----------
        points : array_like of shape (n, 3)
            World positions.

        Returns
        -------
        ndarray of shape (n,), bool
            Whether F < 0.

        Raises
        ------
        InputError
            If the points have a wrong shape or type, or are not finite.
        """
        return self(points) < 0.0

    def __or__(self, other: Model) -> Model:
        """Join with another.

        Parameters
        ----------
        other : Model
            The other.

        Returns
        -------
        Model
            All that lies in one or both.
        """
        return Model._of(self._solid.union(other._solid)) if isinstance(other, Model) else NotImplemented

    def __and__(self, other: Model) -> Model:
        """Intersect with another.

        Parameters
        ----------
        other : Model
            The other.

        Returns
        -------
        Model
            What lies in both.
        """
        return Model._of(self._solid.intersection(other._solid)) if isinstance(other, Model) else NotImplemented

    def __sub__(self, other: Model) -> Model:
        """Take another away.

        Parameters
        ----------
        other : Model
            The other.

        Returns
        -------
        Model
            What lies in this one and not in the other.
        """
        return Model._of(self._solid.difference(other._solid)) if isinstance(other, Model) else NotImplemented

    def __invert__(self) -> Model:
        """Turn inside out.

        Returns
        -------
        Model
            What does not lie in it.
        """
        return Model._of(self._solid.complement())

    def smooth_union(self, other: Model, *, radius: float) -> Model:
        """Join with another, and fill the concave edges where they meet.

        Parameters
        ----------
        other : Model
            The other.
        radius : float
            Radius of the fill, positive.

        Returns
        -------
        Model
            The union.

        Raises
        ------
        ModelError
            If the radius is not positive.
        """
        return Model._of(self._solid.smooth_union(other._solid, radius))

    def offset(self, distance: float) -> Model:
        """Grow, or shrink by a negative distance.

        Parameters
        ----------
        distance : float
            How far the surface moves outward.

        Returns
        -------
        Model
            The solid.

        Raises
        ------
        ModelError
            If the model knows distances near its surface only, as fitted ones do: take ``Model.of_mesh(model.mesh())``.
        """
        return Model._of(self._solid.offset(distance))

    def shell(self, thickness: float) -> Model:
        """Make a wall, half of it on either side of the surface.

        Parameters
        ----------
        thickness : float
            Its thickness, positive.

        Returns
        -------
        Model
            The wall.

        Raises
        ------
        ModelError
            If the thickness is not positive, or as for `offset`.
        """
        return Model._of(self._solid.shell(thickness))

    def moved(self, by: npt.ArrayLike) -> Model:
        """Move.

        Parameters
        ----------
        by : array_like of shape (3,)
            How far.

        Returns
        -------
        Model
            The solid elsewhere.

        Raises
        ------
        ParameterError
            If it is not three finite numbers.
        """
        return self._placed(by=by)

    def rotated(self, axis: npt.ArrayLike, angle: float, *, about: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Model:
        """Turn around an axis, counter-clockwise for one who looks against it.

        Parameters
        ----------
        axis : array_like of shape (3,)
            Direction of the axis, of any length.
        angle : float
            The angle, in degrees.
        about : array_like of shape (3,)
            A position on the axis.

        Returns
        -------
        Model
            The solid, turned.

        Raises
        ------
        ParameterError
            If the axis or position is not three finite numbers.
        ModelError
            If the axis is zero.
        """
        return self._placed(axis=axis, angle=angle, about=about)

    def scaled(self, factor: float, *, about: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Model:
        """Scale about a position.

        Parameters
        ----------
        factor : float
            The factor, positive.
        about : array_like of shape (3,)
            The position that stays.

        Returns
        -------
        Model
            The solid, scaled.

        Raises
        ------
        ModelError
            If the factor is not positive.
        """
        return self._placed(scale=factor, about=about)

    def _placed(
        self,
        *,
        axis: npt.ArrayLike = (0.0, 0.0, 1.0),
        angle: float = 0.0,
        about: npt.ArrayLike = (0.0, 0.0, 0.0),
        scale: float = 1.0,
        by: npt.ArrayLike = (0.0, 0.0, 0.0),
    ) -> Model:
        axis, about, by = vector(axis, "axis"), vector(about, "about"), vector(by, "by")
        return Model._of(self._solid.placed(axis, float(np.radians(angle)), about, scale, by))

    def mesh(
        self,
        *,
        cell: float | None = None,
        bounds: Box | None = None,
        triangles: int | None = None,
        max_error: float | None = None,
        attributes: Attributes = "auto",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Mesh:
        """Make a mesh of the surface.

        Parameters
        ----------
        cell : float, optional
            Side of the cells in which the surface is looked for; by default as fine as the first fitted model in it, else a 128th of
            the longest side of its box.
        bounds : array_like of shape (2, 3), optional
            The box to look in; the surface is cut there and left open. Needed where a solid has no end.
        triangles : int, optional
            Simplifies the mesh to so many triangles.
        max_error : float, optional
            Simplifies the mesh as far as it moves by no more than this.
        attributes : {"auto", "off", "rgb", "intensity", "class"}
            Values that the vertices get from the nearest points of the first fitted model; by default colours, if it has any.
        threads : int, optional
            Threads to use; all by default. The mesh does not depend on it.
        progress : callable, optional
            Is called with the name of a stage and the share that is done.

        Returns
        -------
        Mesh
            An oriented 2-manifold, with the edges of the operands and those where they meet.

        Raises
        ------
        NoSurfaceError
            If there is no surface in the box.
        ModelError
            If the solid cannot be, has no known end, or the lattice would be too large.
        ParameterError
            If a value is not possible.
        """
        options: dict[str, Any] = {
            "cell": cell,
            "bounds": box(bounds),
            "triangles": triangles,
            "max_error": max_error,
            "attributes": "rgb" if attributes == "auto" else attributes,
            "threads": threads,
            "progress": progress,
        }
        return Mesh._of(*self._solid.mesh(options))

    def volume(
        self,
        *,
        bounds: Box | None = None,
        above: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        step: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Volume:
        """Measure the volume, along upright lines.

        Parameters
        ----------
        bounds : array_like of shape (2, 3), optional
            Only what lies in this box; needed where a solid has no end.
        above : tuple of two array_like of shape (3,), optional
            Only what lies beyond a plane: a position on it and its normal, which points there.
        step : float, optional
            Distance between the lines; by default half a cell.
        threads : int, optional
            Threads to use; all by default.
        progress : callable, optional
            Is called with the name of a stage and the share that is done.

        Returns
        -------
        Volume
            The volume and its error.

        Raises
        ------
        ParameterError
            If a value is not possible, or the solid has no end and no bounds are given.
        ModelError
            If the solid cannot be.
        """
        return Volume(*self._solid.volume(_measure(bounds, above, step, threads, progress)))

    def change_from(
        self,
        before: Model,
        *,
        bounds: Box | None = None,
        above: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        step: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Change:
        """Measure what was cut and filled to make this solid of another.

        Parameters
        ----------
        before : Model
            The other.
        bounds : array_like of shape (2, 3), optional
            Only what lies in this box.
        above : tuple of two array_like of shape (3,), optional
            Only what lies beyond a plane: a position on it and its normal.
        step : float, optional
            Distance between the lines; by default half a cell.
        threads : int, optional
            Threads to use; all by default.
        progress : callable, optional
            Is called with the name of a stage and the share that is done.

        Returns
        -------
        Change
            ``cut``, ``fill`` and ``net``, each with its error.

        Raises
        ------
        ParameterError
            If a value is not possible.
        ModelError
            If a solid cannot be.
        """
        found = self._solid.change(before._solid, _measure(bounds, above, step, threads, progress))
        return Change(Volume(*found["cut"]), Volume(*found["fill"]), Volume(*found["net"]))

    def save(self, path: Path) -> int:
        """Write the model, completely or not at all.

        Parameters
        ----------
        path : str or path-like
            A name that ends in .zset.

        Returns
        -------
        int
            The number of bytes.

        Raises
        ------
        FileError
            If the file cannot be written.
        FormatError
            If the suffix is another, or the solid is more than 200 operands deep.
        """
        return self._solid.save(path)


def _measure(
    bounds: Box | None,
    above: tuple[npt.ArrayLike, npt.ArrayLike] | None,
    step: float | None,
    threads: int | None,
    progress: Progress | None,
) -> dict[str, Any]:
    """Put together how to measure."""
    plane = None if above is None else (vector(above[0], "a position"), vector(above[1], "a normal"))
    return {"bounds": box(bounds), "above": plane, "step": step, "threads": threads, "progress": progress}
