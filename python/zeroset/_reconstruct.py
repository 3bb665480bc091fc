"""Points in, a mesh or a model out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy.typing as npt

from zeroset import _core
from zeroset._mesh import Mesh
from zeroset._model import Model
from zeroset._types import Attributes, Path, Progress, Quality, Scene, Up


def _chosen(
    attributes: Attributes, colors: npt.ArrayLike | None, intensities: npt.ArrayLike | None, classes: npt.ArrayLike | None
) -> str:
    """Choose which values the vertices get: the first that is given."""
    if attributes != "auto":
        return attributes
    given = {"rgb": colors, "intensity": intensities, "class": classes}
    return next((name for name, values in given.items() if values is not None), "off")


def _files(constraints: Path | Sequence[Path]) -> list[Path]:
    """Take one file or several."""
    return list(constraints) if isinstance(constraints, (list, tuple)) else [constraints]  # type: ignore[list-item]


def reconstruct(
    points: npt.ArrayLike,
    *,
    scene: Scene = "auto",
    up: Up = "z",
    resolution: float | None = None,
    depth: int | None = None,
    quality: Quality = "normal",
    screening: float | None = None,
    smoothness: float | None = None,
    trim: float | Literal["auto", "off"] = "auto",
    min_component: int | Literal["auto", "off"] = "auto",
    triangles: int | None = None,
    max_error: float | None = None,
    constraints: Path | Sequence[Path] = (),
    constraint_polygons: Literal["faces", "outlines"] = "faces",
    colors: npt.ArrayLike | None = None,
    intensities: npt.ArrayLike | None = None,
    classes: npt.ArrayLike | None = None,
    attributes: Attributes = "auto",
    crs: str | None = None,
    memory: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """Make a mesh of raw points, without normals and without orientation.

    Parameters
    ----------
    points : array_like of shape (n, 3)
        World positions. C-contiguous float64 is read where it lies; other numbers and layouts are converted once. It is
        no longer looked at once the work begins.
    scene : {"auto", "object", "terrain", "airborne", "free"}
        What is known: a closed body; ground and what stands on it; the same scanned from above; nothing. ``"auto"`` decides from
        the shape of the cloud, and never for ``"airborne"`` or ``"free"``.
    up : {"z", "x", "y", "-x", "-y", "-z"}
        The axis that points to the sky.
    resolution : float, optional
        Finest cell, in the unit of the points; by default 1.5 times their spacing, coarser where memory asks for it.
    depth : int, optional
        The same as a share of the box: its longest side over 2**depth, 1 to 16.
    quality : {"normal", "draft", "fine"}
        A draft leaves edges rounded; fine takes cells two thirds as wide.
    screening : float, optional
        Weight of the points against smoothness; by default 1 to 16, by the noise, which is measured.
    smoothness : float, optional
        Weight of smoothness in the polish, 0 or more; by default 3.
    trim : float or {"auto", "off"}
        Drops surface farther than this from the points; by default 60 times the spacing, and off for bodies.
    min_component : int or {"auto", "off"}
        Drops pieces of fewer triangles; by default 100, and off for bodies.
    triangles : int, optional
        Simplifies the mesh to so many triangles.
    max_error : float, optional
        Simplifies the mesh as far as it moves by no more than this.
    constraints : path or sequence of paths
        OBJ, GeoJSON, DXF or JSON files of lines and polygons that the surface passes through.
    constraint_polygons : {"faces", "outlines"}
        Whether polygons among them are parts of the surface, or only their rings are.
    colors : array_like of shape (n, 3), optional
        Red, green and blue of each point, uint8.
    intensities : array_like of shape (n,), optional
        Strength of the return of each point.
    classes : array_like of shape (n,), optional
        ASPRS class of each point, 0 to 255.
    attributes : {"auto", "off", "rgb", "intensity", "class"}
        Which of these the vertices get from the nearest points; by default the first that is given.
    crs : str, optional
        The coordinate reference system, which is passed on to the mesh: WKT, or ``EPSG:n``.
    memory : int, optional
        Bytes to use at most; by default 70 % of what is free.
    threads : int, optional
        Threads to use; all by default. The mesh does not depend on it.
    progress : callable, optional
        Is called on the calling thread with the name of a stage and the share of the whole that is done. What it raises stops the
        work and is raised again.

    Returns
    -------
    Mesh
        An oriented 2-manifold. Its `report` holds the plan and all figures.

    Raises
    ------
    InputError
        If the points have a wrong shape or type, are not finite, too few, or on one line.
    ParameterError
        If a value is not possible.
    MemoryLimitError
        If the resolution needs more memory than allowed.
    NoSurfaceError
        If no surface is found.
    FileError
        If a file of constraints cannot be read.
    KeyboardInterrupt
        After Ctrl-C, within a moment.

    Examples
    --------
    >>> import zeroset
    >>> points = zeroset.sample("torus", points=5000)
    >>> mesh = zeroset.reconstruct(points, quality="draft")
    >>> mesh.is_closed
    True
    """
    options: dict[str, Any] = {**locals(), "attributes": _chosen(attributes, colors, intensities, classes)}
    options["constraints"] = _files(constraints)
    return Mesh._of(*_core.reconstruct(options.pop("points"), options))


def fit(
    points: npt.ArrayLike,
    *,
    scene: Scene = "auto",
    up: Up = "z",
    resolution: float | None = None,
    depth: int | None = None,
    quality: Quality = "normal",
    screening: float | None = None,
    smoothness: float | None = None,
    trim: float | Literal["auto", "off"] = "auto",
    min_component: int | Literal["auto", "off"] = "auto",
    constraints: Path | Sequence[Path] = (),
    constraint_polygons: Literal["faces", "outlines"] = "faces",
    colors: npt.ArrayLike | None = None,
    intensities: npt.ArrayLike | None = None,
    classes: npt.ArrayLike | None = None,
    crs: str | None = None,
    memory: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Model:
    """Fit a model to raw points: a solid that can be asked, measured, cut and joined with others.

    `reconstruct` is this, and then `Model.mesh`.

    Parameters
    ----------
    points : array_like of shape (n, 3)
        World positions, as for `reconstruct`.
    scene : {"auto", "object", "terrain", "airborne", "free"}
        What is known of the scene.
    up : {"z", "x", "y", "-x", "-y", "-z"}
        The axis that points to the sky.
    resolution : float, optional
        Finest cell; by default 1.5 times the spacing.
    depth : int, optional
        The same as a share of the box: its longest side over 2**depth, 1 to 16.
    quality : {"normal", "draft", "fine"}
        How much is done for the surface.
    screening : float, optional
        Weight of the points against smoothness; by default by their noise.
    smoothness : float, optional
        Weight of smoothness in the polish, 0 or more.
    trim : float or {"auto", "off"}
        Surface farther than this from the points is dropped from meshes.
    min_component : int or {"auto", "off"}
        Pieces of fewer triangles are dropped from meshes.
    constraints : path or sequence of paths
        Files of lines and polygons that the surface passes through.
    constraint_polygons : {"faces", "outlines"}
        Whether polygons among them are parts of the surface, or only their rings are.
    colors : array_like of shape (n, 3), optional
        Red, green and blue of each point, uint8; kept in the model.
    intensities : array_like of shape (n,), optional
        Strength of the return of each point; kept in the model.
    classes : array_like of shape (n,), optional
        ASPRS class of each point; kept in the model.
    crs : str, optional
        The coordinate reference system; kept in the model.
    memory : int, optional
        Bytes to use at most; by default 70 % of what is free.
    threads : int, optional
        Threads to use; all by default.
    progress : callable, optional
        Is called with the name of a stage and the share that is done.

    Returns
    -------
    Model
        The model. Its `report` holds the plan and all figures.

    Raises
    ------
    InputError
        If the points have a wrong shape or type, are not finite, too few, or on one line.
    ParameterError
        If a value is not possible.
    MemoryLimitError
        If the resolution needs more memory than allowed.
    FileError
        If a file of constraints cannot be read.

    Examples
    --------
    >>> import zeroset
    >>> torus = zeroset.fit(zeroset.sample("torus", points=5000), quality="draft")
    >>> torus.contains([[0.35, 0.0, 0.0], [0.0, 0.0, 0.0]])
    array([ True, False])
    """
    options: dict[str, Any] = dict(locals())
    options["constraints"] = _files(constraints)
    return Model._of(*_core.fit(options.pop("points"), options))
