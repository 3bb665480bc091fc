"""Cities on a cluster: tiles as a graph of Dask.

`reconstruct` gives Dask the steps that ``zeroset reconstruct INPUTS -o FOLDER/ --tile SIDE`` does on one machine, and the files are the
same, bit for bit. It needs the packages ``distributed`` and ``fsspec``: ``pip install zeroset[dask]``.

| task | does | waits for |
|---|---|---|
| ``zeroset-sort`` | reads an input, sorts its points into tiles | |
| ``zeroset-plan`` | resolves every default | all inputs sorted |
| ``zeroset-thin`` | thins the points of a tile | the plan |
| ``zeroset-coarse`` | fits the coarse levels of the whole | all tiles thinned |
| ``zeroset-fit`` | refines a tile | the coarse levels |
| ``zeroset-mesh`` | has the tile agree with those around it, and extracts its surface | these tiles fitted |
| ``zeroset-simplify`` | simplifies it, only with `max_error` | these tiles extracted |
| ``zeroset-write`` | writes the surface of a tile | these tiles extracted, and it simplified |
| ``zeroset-level`` | makes a square of tiles as one coarser mesh, only for GLB | its four parts |
| ``zeroset-finish`` | writes ``tiles.json`` and ``tileset.json`` | all of these written |

Tasks hand on through files, in a folder that all workers see under the same name: a disk for workers on one machine, else a shared file
system. Through Dask go only names and counts. A file appears when it is complete, and a task whose file is there is done. So a task may
run again, anywhere: a worker may be lost in mid-run, and an interrupted run goes on where it was when it is called again.
"""

from __future__ import annotations

import json
import os
import tempfile
import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from zeroset import _core
from zeroset._core import version
from zeroset._errors import InputError, ParameterError
from zeroset._reconstruct import _files
from zeroset._types import Path, Quality, Scene, Up

try:
    import distributed
    import fsspec
except ImportError as why:
    raise ImportError(f"zeroset.dask needs the package {why.name}: pip install zeroset[dask]", name=why.name) from why

__all__ = ["Tile", "Tiles", "reconstruct"]

_Id = tuple[int, int]
_Square = tuple[int, int, int]


@dataclass(frozen=True)
class Tile:
    """A tile that was written.

    Attributes
    ----------
    name : str
        Its column and row, such as ``"12_7"``.
    file : str
        Its file, relative to the output.
    triangles : int
        How many triangles its surface has.
    points : int
        How many points it holds.
    """

    name: str
    file: str
    triangles: int
    points: int


@dataclass(frozen=True)
class Tiles:
    """What `reconstruct` made.

    Attributes
    ----------
    output : str
        The folder or URL that the tiles lie in.
    tiles : tuple of Tile
        Tiles with a surface, by row and column.
    """

    output: str
    tiles: tuple[Tile, ...]

    @property
    def triangles(self) -> int:
        """Triangles of all tiles."""
        return sum(tile.triangles for tile in self.tiles)


@dataclass(frozen=True)
class _Job:
    """What every task is told. Plain values, which any worker can be sent."""

    folder: str
    output: str
    paths: tuple[str, ...]
    side: float
    threads: int | None
    options: dict[str, Any]
    storage: dict[str, Any]

    def steps(self) -> _core.TileFolder:
        """Open the folder, for the threads of the worker that this runs on."""
        threads = self.threads or distributed.get_worker().state.nthreads
        return _core.TileFolder(self.folder, threads)

    def publish(self, name: str) -> None:
        """Copy a finished file of the folder to the output, if that is elsewhere."""
        if self.output != self.folder:
            files, root = fsspec.core.url_to_fs(self.output, **self.storage)
            target = f"{root.rstrip('/')}/{name}"
            files.makedirs(os.path.dirname(target), exist_ok=True)
            files.put_file(os.path.join(self.folder, name), target)


def _is_local(url: str) -> bool:
    """Tell names of files from URLs."""
    return "://" not in url and "::" not in url


def _located(path: Path) -> str:
    """Make a name that means the same in every process."""
    text = os.fspath(path)
    if text.startswith("file://"):
        text = text.removeprefix("file://")
    return os.path.abspath(text) if _is_local(text) else text


def _facts(job: _Job, path: str) -> dict[str, str]:
    """Tell what a file is known by: another run must find the same."""
    files, root = fsspec.core.url_to_fs(path, **({} if _is_local(path) else job.storage))
    info = files.info(root)
    known = ("size", "mtime", "LastModified", "last_modified", "updated", "etag", "ETag")
    return {"path": path, **{name: str(info[name]) for name in known if name in info}}


def _open(job: _Job) -> dict[str, Any] | None:
    """Make the folder or go on in it. Returns the list of tiles if all is done."""
    run = {
        "zeroset_version": version(),
        "inputs": [_facts(job, path) for path in job.paths],
        "options": repr((job.side, sorted((name, value) for name, value in job.options.items() if name != "memory"))),
    }
    job.steps().open(json.dumps(run))
    is_done = job.output == job.folder and os.path.exists(os.path.join(job.folder, "done.json"))
    return _listed(job) if is_done else None


def _listed(job: _Job) -> dict[str, Any]:
    with open(os.path.join(job.folder, "tiles.json"), encoding="utf-8") as file:
        found: dict[str, Any] = json.load(file)
    return found


def _sort(job: _Job, number: int) -> None:
    steps, path = job.steps(), job.paths[number]
    if _is_local(path):
        steps.sort(number, path, job.side, job.options)
    elif not steps.is_sorted(number, job.side):
        files, root = fsspec.core.url_to_fs(path, **job.storage)
        with tempfile.TemporaryDirectory(prefix="zeroset-") as folder:
            # The suffix tells the format.
            own = os.path.join(folder, os.path.basename(root))
            files.get_file(root, own)
            steps.sort(number, own, job.side, job.options)


@dataclass(frozen=True)
class _Plan:
    """What there is to do: tiles, each with those around it, and squares of tiles, each with its parts, level by level."""

    tiles: list[tuple[_Id, list[_Id]]]
    levels: list[list[tuple[_Square, list[_Square]]]]


def _plan(job: _Job, after: Sequence[None]) -> _Plan:
    steps = job.steps()
    tiles = steps.plan(len(job.paths), job.side, job.options)
    return _Plan(tiles, steps.levels() if job.options["tile_format"] == "glb" else [])


def _thin(job: _Job, tile: _Id) -> None:
    job.steps().thin(tile)


def _coarse(job: _Job, after: Sequence[None]) -> None:
    job.steps().coarse(job.options)


def _fit(job: _Job, tile: _Id, after: None) -> None:
    job.steps().fit(tile, job.options)


def _mesh(job: _Job, tile: _Id, after: Sequence[None]) -> None:
    job.steps().mesh(tile)


def _simplify(job: _Job, tile: _Id, after: Sequence[None]) -> None:
    job.steps().simplify(tile)


def _level(job: _Job, square: _Square, after: Sequence[None]) -> None:
    entry = job.steps().level(square)
    if entry is not None:
        job.publish(entry["file"])


def _write(job: _Job, tile: _Id, after: Sequence[None]) -> dict[str, Any] | None:
    entry = job.steps().write(tile, job.options)
    if entry is not None:
        job.publish(entry["file"])
    return entry


def _finish(job: _Job, entries: Sequence[dict[str, Any] | None], after: Sequence[None]) -> dict[str, Any]:
    steps = job.steps()
    steps.finish(json.dumps([entry for entry in entries if entry is not None]), job.options)
    found = _listed(job)
    job.publish("tiles.json")
    if job.options["tile_format"] == "glb":
        job.publish("tileset.json")
    return found


def _clean(job: _Job) -> None:
    """Remove what was handed on. Begins when nothing can be asked to run again."""
    if job.output == job.folder:
        job.steps().remove_work()
    else:
        job.steps().remove()


class _Graph:
    """The tasks of one run, under names that the dashboard can group."""

    def __init__(self, client: Any, job: _Job, retries: int) -> None:
        self.client, self.retries = client, retries
        # The same job again is another run: Dask must not take results of one whose files are gone.
        self.run = uuid.uuid4().hex[:8]
        self.job = job
        self.futures: list[Any] = []

    def task(self, step: Any, which: str, *arguments: Any) -> Any:
        name = "-".join(part for part in (f"zeroset{step.__name__}".replace("_", "-"), which, self.run) if part)
        made = self.client.submit(step, self.job, *arguments, key=name, retries=self.retries, pure=False)
        self.futures.append(made)
        return made

    def over_tiles(self, plan: _Plan) -> Any:
        """Everything once the tiles are known. Returns the last task."""
        names = {tile: f"{tile[0]}_{tile[1]}" for tile, _ in plan.tiles}
        around = {tile: [tile, *others] for tile, others in plan.tiles}
        coarse = self.task(_coarse, "", [self.task(_thin, name, tile) for tile, name in names.items()])
        fits = {tile: self.task(_fit, name, tile, coarse) for tile, name in names.items()}
        meshes = {tile: self.task(_mesh, name, tile, [fits[t] for t in around[tile]]) for tile, name in names.items()}
        ready = {tile: [meshes[t] for t in around[tile]] for tile in names}
        if self.job.options["max_error"] is not None:
            ready = {tile: [self.task(_simplify, name, tile, ready[tile])] for tile, name in names.items()}
        written = [self.task(_write, name, tile, ready[tile]) for tile, name in names.items()]
        squares: dict[_Square, list[Any]] = {(0, *tile): after for tile, after in ready.items()}
        made: list[Any] = []
        for square, parts in (node for nodes in plan.levels for node in nodes):
            name = "_".join(map(str, square))
            # Futures are collected once, however many parts wait for the same.
            after = list({future.key: future for part in parts for future in squares[part]}.values())
            made.append(self.task(_level, name, square, after))
            squares[square] = [made[-1]]
        return self.task(_finish, "", written, made)


def _client(client: Any) -> Any:
    """Take the client that is given, or the current one."""
    if client is not None:
        return client
    try:
        return distributed.get_client()
    except ValueError:
        raise ParameterError("no Dask client is connected; make one: client = distributed.Client()") from None


def reconstruct(
    paths: Path | Sequence[Path],
    output: Path,
    *,
    tile: float,
    client: Any = None,
    scene: Scene = "auto",
    up: Up = "z",
    resolution: float | None = None,
    quality: Quality = "normal",
    screening: float | None = None,
    smoothness: float | None = None,
    trim: float | Literal["auto"] = "auto",
    min_component: int | Literal["auto", "off"] = "auto",
    constraints: Path | Sequence[Path] = (),
    constraint_polygons: Literal["faces", "outlines"] = "faces",
    classes: Sequence[int] | None = None,
    exclude: Sequence[int] | None = None,
    bounds: Sequence[Sequence[float]] | None = None,
    attributes: Literal["off", "rgb", "intensity", "class"] = "rgb",
    max_error: float | None = None,
    tile_format: Literal["glb", "ply", "zset"] = "glb",
    scratch: Path | None = None,
    storage_options: Mapping[str, Any] | None = None,
    threads: int | None = None,
    retries: int = 2,
    keep_work: bool = False,
) -> Tiles:
    """Make a city tile by tile on a cluster of Dask.

    Parameters
    ----------
    paths : path, or sequence of paths
        The inputs: files that all workers see, or URLs that fsspec knows, such as ``s3://bucket/tile.laz``. They are one cloud.
    output : path
        A new folder for the tiles that all workers see, or the folder of an interrupted run of the same. Or a URL; then give `scratch`.
    tile : float
        Side of a tile, in the unit of the points: 128 cells or more.
    client : distributed.Client, optional
        The client of the cluster; by default the current one.
    scene : {"auto", "terrain", "airborne", "object", "free"}
        What is known. ``"auto"`` is airborne if all inputs are LAS or LAZ. Tiles are for terrain and airborne scenes.
    up : {"z", "x", "y", "-x", "-y", "-z"}
        The axis that points to the sky.
    resolution : float, optional
        Finest cell, in the unit of the points; by default 1.5 times their spacing.
    quality : {"normal", "draft", "fine"}
        A draft leaves edges rounded; fine takes cells two thirds as wide.
    screening : float, optional
        Weight of the points against smoothness; by default by their noise.
    smoothness : float, optional
        Weight of smoothness in the polish, 0 or more.
    trim : float or "auto"
        Drops surface farther than this from the points.
    min_component : int or {"auto", "off"}
        Drops pieces of fewer triangles.
    constraints : path or sequence of paths
        Files of lines and polygons that the surface passes through; all workers see them.
    constraint_polygons : {"faces", "outlines"}
        Whether polygons among them are parts of the surface, or only their rings are.
    classes : sequence of int, optional
        Uses only points of these ASPRS classes.
    exclude : sequence of int, optional
        Leaves out points of these classes; by default 7 and 18, which are noise.
    bounds : array_like of shape (2, 3), optional
        Uses only points in this box of world coordinates.
    attributes : {"rgb", "off", "intensity", "class"}
        Which values the vertices get from the nearest points.
    max_error : float, optional
        Simplifies each tile as far as it moves by no more than this, in the unit of the points.
    tile_format : {"glb", "ply", "zset"}
        How tiles are written: GLB with levels of detail and a ``tileset.json`` for 3D Tiles, PLY in world coordinates, or models.
    scratch : path, optional
        A new folder that all workers see, for the files between tasks. Only for an `output` that is a URL.
    storage_options : dict, optional
        What fsspec needs for the URLs, such as keys.
    threads : int, optional
        Threads of each task; by default those of its worker. The files do not depend on it.
    retries : int
        How often a task that failed is tried again.
    keep_work : bool
        Keeps what was handed from task to task.

    Returns
    -------
    Tiles
        The tiles that were written.

    Raises
    ------
    InputError
        If there are no inputs or no points.
    ParameterError
        If a value is not possible, or there is no client.
    FileError
        If a file cannot be read or written, or the folder holds something else.

    Examples
    --------
    >>> import zeroset.dask
    >>> from distributed import Client
    >>> client = Client("scheduler:8786")  # doctest: +SKIP
    >>> zeroset.dask.reconstruct(["s3://ahn/a.laz", "s3://ahn/b.laz"], "/shared/city", tile=250.0)  # doctest: +SKIP
    """
    given = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    located = tuple(_located(path) for path in given)
    if not located:
        raise InputError("there are no inputs; give at least one file or URL")
    target = _located(output).rstrip("/")
    if not _is_local(target) and scratch is None:
        raise ParameterError(f"an output of {target} needs a scratch folder that all workers see; give scratch")
    if _is_local(target) and scratch is not None:
        raise ParameterError("scratch is only for an output that is a URL; leave it out")
    if scene == "auto" and all(path.lower().endswith((".las", ".laz")) for path in located):
        scene = "airborne"
    options: dict[str, Any] = {
        "scene": scene,
        "up": up,
        "resolution": resolution,
        "depth": None,
        "quality": quality,
        "screening": screening,
        "smoothness": smoothness,
        "trim": trim,
        "min_component": min_component,
        "constraints": [_located(path) for path in _files(constraints)],
        "constraint_polygons": constraint_polygons,
        "classes": None if classes is None else [int(c) for c in classes],
        "exclude": None if exclude is None else [int(c) for c in exclude],
        "bounds": None if bounds is None else [[float(v) for v in corner] for corner in bounds],
        "attributes": attributes,
        "triangles": None,
        "max_error": max_error,
        "tile_format": tile_format,
        "memory": None,
    }
    folder = target if scratch is None else _located(scratch)
    job = _Job(folder, target, located, float(tile), threads, options, dict(storage_options or {}))
    graph = _Graph(_client(client), job, retries)
    try:
        listed = graph.task(_open, "").result()
        if listed is None:
            plan = graph.task(_plan, "", [graph.task(_sort, str(i), i) for i in range(len(located))]).result()
            listed = graph.over_tiles(plan).result()
        if not keep_work:
            graph.task(_clean, "").result()
    finally:
        graph.client.cancel(graph.futures)
    made = [
        Tile(feature["id"], *(feature["properties"][name] for name in ("file", "triangles", "points")))
        for feature in listed["features"]
    ]
    return Tiles(target, tuple(made))
