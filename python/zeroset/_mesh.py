"""Meshes as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from zeroset import _core, _optional
from zeroset._errors import InputError, MeshError
from zeroset._types import Floats, Path, Progress, Report


class Mesh:
    """A triangle mesh.

    Triangles are counter-clockwise seen from outside. Positions are kept local, exact to the last bit: the world position is the
    local one plus `world_from_local`, which is zero unless coordinates exceed 1000.

    Parameters
    ----------
    vertices : array_like of shape (n, 3)
        Local positions. C-contiguous float64 is kept without a copy.
    triangles : array_like of shape (m, 3)
        Three vertex numbers each, kept as uint32.
    world_from_local : array_like of shape (3,), optional
        What to add to a local position to get the world position; zero if left out.
    colors : array_like of shape (n, 3), optional
        Red, green and blue of each vertex, 0 to 255.
    intensities : array_like of shape (n,), optional
        Strength of the return at each vertex.
    classes : array_like of shape (n,), optional
        ASPRS class of each vertex.
    crs : str, optional
        The coordinate reference system, as WKT or ``EPSG:n``.

    Raises
    ------
    InputError
        If an array has a wrong shape or type.
    MeshError
        If a triangle names a vertex that is not there.

    Attributes
    ----------
    local : ndarray of shape (n, 3), float64
        Local positions.
    triangles : ndarray of shape (m, 3), uint32
        Three vertex numbers each.
    world_from_local : ndarray of shape (3,), float64
        What to add to a local position to get the world position.
    colors, intensities, classes : ndarray or None
        Values of the vertices: uint8 of shape (n, 3), float32 of shape (n,), uint8 of shape (n,).
    crs : str or None
        The coordinate reference system.
    report : dict
        All figures of the run that made the mesh; empty for others.

    Examples
    --------
    >>> import zeroset
    >>> mesh = zeroset.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh.topology()["boundary_edges"]
    3
    """

    def __init__(
        self,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        world_from_local: npt.ArrayLike | None = None,
        colors: npt.ArrayLike | None = None,
        intensities: npt.ArrayLike | None = None,
        classes: npt.ArrayLike | None = None,
        crs: str | None = None,
    ) -> None:
        local = _array(vertices, "vertices", np.float64)
        corners = np.asarray(triangles)
        if corners.ndim != 2 or corners.shape[1] != 3 or corners.dtype.kind not in "iu":
            raise InputError(f"triangles have shape {corners.shape} and type {corners.dtype}; give integers of shape (m, 3)")
        if corners.size and (corners.min() < 0 or corners.max() >= len(local)):
            raise MeshError(f"triangles name vertices {corners.min()} to {corners.max()}, but there are {len(local)}")
        self.local: Floats = local
        self.triangles: npt.NDArray[np.uint32] = np.require(corners, np.uint32, ["C", "A"])
        offset = np.zeros(3) if world_from_local is None else np.array(world_from_local, np.float64)
        if offset.shape != (3,):
            raise InputError(f"world_from_local has shape {offset.shape}; give three numbers")
        self.world_from_local: Floats = offset
        self.colors = _values(colors, "colors", np.uint8, (len(local), 3))
        self.intensities = _values(intensities, "intensities", np.float32, (len(local),))
        self.classes = _values(classes, "classes", np.uint8, (len(local),))
        self.crs = crs
        self.report: Report = {}
        self._world: Floats | None = None

    @classmethod
    def _of(cls, arrays: dict[str, Any], report: Report | None = None) -> Mesh:
        """Take what the core hands out."""
        arrays = dict(arrays)
        mesh = cls(arrays.pop("local"), arrays.pop("triangles"), **arrays)
        mesh.report = report or {}
        return mesh

    def __repr__(self) -> str:
        return f"Mesh({len(self.local)} vertices, {len(self.triangles)} triangles)"

    @property
    def vertices(self) -> Floats:
        """World positions, shape (n, 3): the local array itself if there is no offset, else made when first asked for.

        Returns
        -------
        ndarray of shape (n, 3), float64
            The positions, rounded to float64 once.
        """
        if not self.world_from_local.any():
            return self.local
        if self._world is None:
            self._world = self.local + self.world_from_local
        return self._world

    @classmethod
    def load(cls, path: Path) -> Mesh:
        """Read a mesh.

        Parameters
        ----------
        path : str or path-like
            A file of type PLY, OBJ, STL, OFF or GLB; the suffix tells which.

        Returns
        -------
        Mesh
            The mesh.

        Raises
        ------
        FileMissingError
            If there is no such file.
        FormatError
            If the file is damaged, or of another format.
        """
        return cls._of(_core.load_mesh(path))

    def save(self, path: Path) -> int:
        """Write the mesh, completely or not at all.

        Parameters
        ----------
        path : str or path-like
            A name that ends in .ply, .obj, .stl, .off or .glb. PLY keeps all values, OBJ and OFF the colours, STL and GLB are local.

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
        plan = self.report.get("plan", {})
        return _core.save_mesh(self, path, plan.get("resolution", self.report.get("cell")))

    def simplify(
        self,
        *,
        triangles: int | None = None,
        max_error: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Mesh:
        """Make a mesh of fewer triangles. Creases, corners and borders stay.

        Parameters
        ----------
        triangles : int, optional
            Triangles wanted.
        max_error : float, optional
            The farthest that the surface moves, in the unit of the mesh. Whichever comes first ends it; one must be given.
        threads : int, optional
            Threads to use; all by default. The result does not depend on it.
        progress : callable, optional
            Is called with the name of a stage and the share that is done.

        Returns
        -------
        Mesh
            The mesh. Its `report` tells how far it lies from this one, measured both ways.

        Raises
        ------
        ParameterError
            If nothing says how far, or a value is not positive.
        MeshError
            If there is no surface.
        """
        options = {"triangles": triangles, "max_error": max_error, "threads": threads, "progress": progress}
        return Mesh._of(*_core.simplify_mesh(self, options))

    def topology(self) -> dict[str, Any]:
        """Tell how the mesh hangs together.

        Returns
        -------
        dict
            Among others ``closed``, ``genus``, ``components``, ``boundary_edges``, ``nonmanifold_edges``, ``area`` and ``volume``;
            ``bounds`` are local.

        Raises
        ------
        MeshError
            If the mesh cannot be examined.
        """
        return _core.mesh_topology(self)

    def self_intersections(self) -> int:
        """Count pairs of triangles that cut through each other, exactly.

        Returns
        -------
        int
            The number of pairs.

        Raises
        ------
        MeshError
            If the mesh cannot be examined.
        """
        return _core.mesh_self_intersections(self)

    @property
    def volume(self) -> float | None:
        """The volume inside, in cubic units; None unless the mesh is closed.

        Returns
        -------
        float or None
            The volume.
        """
        found: float | None = self.topology()["volume"]
        return found

    @property
    def area(self) -> float:
        """The area of all triangles, in square units.

        Returns
        -------
        float
            The area.
        """
        found: float = self.topology()["area"]
        return found

    @property
    def is_closed(self) -> bool:
        """Whether every edge has two triangles, which run along it in opposite directions.

        Returns
        -------
        bool
            Whether the mesh is closed.
        """
        found: bool = self.topology()["closed"]
        return found

    def _positions(self, local: bool) -> Floats:
        return self.local if local else self.vertices

    def to_pyvista(self, *, local: bool = False) -> Any:
        """Convert to PyVista.

        Parameters
        ----------
        local : bool
            Whether to take local positions: graphics cards compute in float32, which is too coarse for national grids.

        Returns
        -------
        pyvista.PolyData
            The mesh, with ``colors``, ``intensities`` and ``classes`` as data of its points.

        Raises
        ------
        ImportError
            If PyVista is not installed.
        """
        pyvista = _optional.load("pyvista")
        faces = np.empty((len(self.triangles), 4), np.int64)
        faces[:, 0] = 3
        faces[:, 1:] = self.triangles
        data = pyvista.PolyData(self._positions(local), faces.ravel())
        for name in ("colors", "intensities", "classes"):
            values = getattr(self, name)
            if values is not None:
                data.point_data[name] = values
        return data

    def to_trimesh(self, *, local: bool = False) -> Any:
        """Convert to trimesh.

        Parameters
        ----------
        local : bool
            Whether to take local positions.

        Returns
        -------
        trimesh.Trimesh
            The mesh with its colours, vertices and triangles in the same order.

        Raises
        ------
        ImportError
            If trimesh is not installed.
        """
        trimesh = _optional.load("trimesh")
        positions, faces = self._positions(local), self.triangles.astype(np.int64)
        return trimesh.Trimesh(positions, faces, vertex_colors=self.colors, process=False)

    def to_open3d(self, *, local: bool = False) -> Any:
        """Convert to Open3D.

        Parameters
        ----------
        local : bool
            Whether to take local positions.

        Returns
        -------
        open3d.geometry.TriangleMesh
            The mesh with its colours.

        Raises
        ------
        ImportError
            If Open3D is not installed.
        """
        open3d = _optional.load("open3d")
        vector, triple = open3d.utility.Vector3dVector, open3d.utility.Vector3iVector
        mesh = open3d.geometry.TriangleMesh(vector(self._positions(local)), triple(self.triangles.astype(np.int32)))
        if self.colors is not None:
            mesh.vertex_colors = vector(self.colors / 255.0)
        return mesh


def _array(values: npt.ArrayLike, name: str, dtype: type[np.float64]) -> Floats:
    """Take positions, without a copy where that is possible."""
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise InputError(f"{name} have shape {array.shape} and type {array.dtype}; give numbers of shape (n, 3)")
    return np.require(array, dtype, ["C", "A"])


def _values(values: npt.ArrayLike | None, name: str, dtype: Any, shape: tuple[int, ...]) -> npt.NDArray[Any] | None:
    """Take values beside the vertices."""
    if values is None:
        return None
    array = np.asarray(values)
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise InputError(f"{name} have shape {array.shape} and type {array.dtype}; give numbers of shape {shape}")
    if dtype is np.uint8 and array.size and (array.dtype.kind == "f" or array.min() < 0 or array.max() > 255):
        raise InputError(f"{name} must be integers from 0 to 255; scale and round them first")
    return np.require(array, dtype, ["C", "A"])
