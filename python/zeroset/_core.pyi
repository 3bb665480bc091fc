"""
The module.
"""

from _typeshed import SupportsLenAndGetItem
from os import PathLike
from typing import Any, SupportsFloat, SupportsIndex, final

__all__ = ["Features", "NormalizedFit", "Solid", "TileFolder", "address", "command", "features", "fit", "load_mesh", "mesh_self_intersections", "mesh_topology", "newe", "normalized_fit", "read_points", "reconstruct", "sample", "sample_kinds", "save_mesh", "simplify_mesh", "version"]

@final
class Features:
    """
    What was found, with the cloud that it was found in.
    """
    def class_of_point(self, /) -> "Any":
        """
        For each point what kind of place it is at: 0 unstructured, 1 flat, 2 edge, 3 corner.
        """
    def corners(self, /) -> "list[dict[str, Any]]":
        """
        Corners as dictionaries, in world coordinates.
        """
    @property
    def crs(self, /) -> str | None:
        """
        The reference system.
        """
    def edges(self, /) -> "list[dict[str, Any]]":
        """
        Sharp edges as dictionaries, in world coordinates.
        """
    def plane_of_point(self, /) -> "Any":
        """
        For each point the number of its plane, -1 for none.
        """
    def planes(self, /) -> "list[dict[str, Any]]":
        """
        Flat regions as dictionaries, in world coordinates.
        """
    def save(self, /, path: str | PathLike[str]) -> "int":
        """
        Writes a file; the suffix tells the format. Returns the number of bytes.
        """

@final
class NormalizedFit:
    """
    A fit that was made.
    """
    def evaluate(self, /, points: Any) -> "tuple[Any, Any]":
        """
        F and its gradient.
        """
    def figures(self, /) -> "dict[str, Any]":
        """
        All figures of the fit.
        """
    def lines(self, /, tolerance: SupportsFloat | SupportsIndex, all_branches: bool) -> "list[tuple[Any, bool]]":
        """
        The zero set in the plane: polylines, each with whether it is closed.
        """
    def surface(self, /, subdivisions: SupportsIndex, all_branches: bool) -> "dict[str, Any]":
        """
        The zero set in space.
        """

@final
class Solid:
    """
    A solid in world coordinates.
    """
    @staticmethod
    def ball(center: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], radius: SupportsFloat | SupportsIndex) -> "Solid": ...
    def change(self, /, before: "Solid", options: "dict[str, Any]") -> "dict[str, tuple[float, float]]":
        """
        What was cut and what was filled to make this one, each with its error.
        """
    def complement(self, /) -> "Solid": ...
    @property
    def crs(self, /) -> str | None:
        """
        The reference system.
        """
    @staticmethod
    def cuboid(low: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], high: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> "Solid": ...
    def difference(self, /, other: "Solid") -> "Solid": ...
    def evaluate(self, /, points: Any, options: "dict[str, Any]") -> "tuple[Any, Any]":
        """
        F and its gradient.
        """
    @staticmethod
    def expression(text: "str") -> "Solid":
        """
        An expression, such as `box(0,0,0; 1,1,1)`.
        """
    @staticmethod
    def frustum(ends: SupportsLenAndGetItem[SupportsLenAndGetItem[SupportsFloat | SupportsIndex]], radii: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> "Solid": ...
    @staticmethod
    def half_space(point: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], normal: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> "Solid": ...
    @staticmethod
    def height_field(origin: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], step: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], heights: Any) -> "Solid": ...
    def intersection(self, /, other: "Solid") -> "Solid": ...
    def kind(self, /) -> "tuple[str, int]":
        """
        What it is: the name of the operation or shape, and the number of its operands.
        """
    @staticmethod
    def load(path: str | PathLike[str]) -> "Solid":
        """
        What a file holds: a model, a tree, or a closed mesh.
        """
    def mesh(self, /, options: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any]]":
        """
        A mesh, and what was done.
        """
    @staticmethod
    def of_mesh(mesh: Any) -> "Solid":
        """
        What a closed mesh surrounds.
        """
    def offset(self, /, distance: SupportsFloat | SupportsIndex) -> "Solid": ...
    def placed(self, /, axis: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], angle: SupportsFloat | SupportsIndex, about: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], scale: SupportsFloat | SupportsIndex, by: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> "Solid":
        """
        Turned about an axis through `about`, then scaled about it, then moved.
        """
    @staticmethod
    def prism(rings: "list[list[tuple[float, float]]]", heights: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> "Solid": ...
    def provenance(self, /) -> "dict[str, Any]":
        """
        What it was made from, and how.
        """
    def save(self, /, path: str | PathLike[str]) -> "int":
        """
        Writes a model; returns the number of bytes.
        """
    def shell(self, /, thickness: SupportsFloat | SupportsIndex) -> "Solid": ...
    def smooth_union(self, /, other: "Solid", radius: SupportsFloat | SupportsIndex) -> "Solid": ...
    def union(self, /, other: "Solid") -> "Solid": ...
    def volume(self, /, options: "dict[str, Any]") -> "tuple[float, float]":
        """
        The volume and its error.
        """

@final
class TileFolder:
    """
    A folder in which tiles are made. Steps run on so many threads.
    """
    def __new__(cls, /, path: "Any", threads: "int | None") -> TileFolder: ...
    def coarse(self, /, options: "dict[str, Any]") -> "None":
        """
        Fits the coarse levels of the whole. All tiles must be thinned.
        """
    def finish(self, /, entries: "str", options: "dict[str, Any]") -> "None":
        """
        Writes the lists of the tiles that `write` wrote, which are given as JSON. All squares must be there.
        """
    def fit(self, /, tile: "tuple[int, int]", options: "dict[str, Any]") -> "None":
        """
        Fits a tile. The coarse levels must be there.
        """
    def is_sorted(self, /, input: "int", side: "float") -> "bool":
        """
        Whether an input is sorted into tiles of a side.
        """
    def level(self, /, square: "tuple[int, int, int]") -> "dict[str, Any] | None":
        """
        Makes and writes a square of tiles, if it has a surface. Its parts must be there: on the first level tiles, and those around them.
        """
    def levels(self, /) -> "list[list[tuple[tuple[int, int, int], list[tuple[int, int, int]]]]]":
        """
        The squares of tiles that are shown as one, level by level: each with its parts.
        """
    def mesh(self, /, tile: "tuple[int, int]") -> "None":
        """
        Extracts the surface of a tile. It and those around it must be fitted.
        """
    def open(self, /, run: "str") -> "None":
        """
        Makes the folder, or opens one that was begun with the same `run`, which is JSON.
        """
    def plan(self, /, inputs: "int", side: "float", options: "dict[str, Any]") -> "list[tuple[tuple[int, int], list[tuple[int, int]]]]":
        """
        Puts together what was sorted of so many inputs, and resolves every default. Returns the tiles, each with those around it.
        """
    def remove(self, /) -> "None":
        """
        Removes the folder.
        """
    def remove_work(self, /) -> "None":
        """
        Removes what steps handed on.
        """
    def simplify(self, /, tile: "tuple[int, int]") -> "None":
        """
        Simplifies the surface of a tile, if that is asked for. It and those around it must be extracted.
        """
    def sort(self, /, input: "int", path: "Any", side: "float", options: "dict[str, Any]") -> "None":
        """
        Sorts the points of a file into tiles.
        """
    def thin(self, /, tile: "tuple[int, int]") -> "None":
        """
        Thins the points of a tile for coarser levels.
        """
    def write(self, /, tile: "tuple[int, int]", options: "dict[str, Any]") -> "dict[str, Any] | None":
        """
        Writes the surface of a tile, if it has one. It and those around it must be extracted, and it simplified if that is asked for.
        """

def address(points: Any) -> "int":
    """
    The address at which Rust reads an array of points, for tests that nothing is copied.
    """

def command(words: "list[str]") -> "int":
    """
    Runs the command with the given words, of which the first is the program's own name. Returns the exit code.
    """

def features(points: Any, options: "dict[str, Any]") -> "tuple[Features, dict[str, Any]]":
    """
    Finds planes, edges and corners; tells what was done.
    """

def fit(points: Any, options: "dict[str, Any]") -> "tuple[Solid, dict[str, Any]]":
    """
    A model of points, and what was done.
    """

def load_mesh(path: str | PathLike[str]) -> "dict[str, Any]":
    """
    Reads a mesh.
    """

def mesh_self_intersections(mesh: Any) -> "int":
    """
    The number of pairs of triangles that cut through each other.
    """

def mesh_topology(mesh: Any) -> "dict[str, Any]":
    """
    How a mesh hangs together.
    """

def newe(points: Any, width: SupportsIndex, options: "dict[str, Any]") -> "dict[str, Any]":
    """
    Flats through points in the plane or in space.
    """

def normalized_fit(points: Any, width: SupportsIndex, options: "dict[str, Any]") -> "NormalizedFit":
    """
    Fits F to points and segments.
    """

def read_points(paths: "list[Any]") -> "dict[str, Any]":
    """
    Reads files as one cloud: world positions with what was measured beside them.
    """

def reconstruct(points: Any, options: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any]]":
    """
    A mesh of points, and what was done.
    """

def sample(kind: "str", points: "int", noise: "float | None", seed: "int") -> "tuple[Any, dict[str, Any]]":
    """
    Points of a scene, and its exact mesh.
    """

def sample_kinds() -> "list[str]":
    """
    The names of all scenes.
    """

def save_mesh(mesh: Any, path: str | PathLike[str], resolution: "float | None") -> "int":
    """
    Writes a mesh; the suffix tells the format.
    """

def simplify_mesh(mesh: Any, options: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any]]":
    """
    A mesh of fewer triangles, and what was done.
    """

def version() -> "str":
    """
    The version of the package.
    """
