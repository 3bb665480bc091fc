"""Tiles through Dask: really through processes and sockets, on loopback."""

import os
import subprocess
import sys
import threading
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import zeroset

distributed = pytest.importorskip("distributed")
psutil = pytest.importorskip("psutil")
import zeroset.dask  # noqa: E402

TILE, RESOLUTION = 0.55, 0.004
OPTIONS: Any = {"tile": TILE, "resolution": RESOLUTION, "scene": "airborne", "quality": "draft"}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A city in two files, which overlap."""
    folder = tmp_path_factory.mktemp("inputs")
    points = zeroset.sample("airborne-city", points=60_000, seed=4)
    paths = [folder / "a.xyz", folder / "b.xyz"]
    for i, path in enumerate(paths):
        np.savetxt(path, points[i::2], fmt="%.17g")
    return paths


@pytest.fixture(scope="module")
def expected(inputs: list[Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What the command makes of them."""
    folder = tmp_path_factory.mktemp("command") / "city"
    words = ["-o", f"{folder}/", "--tile", str(TILE), "--resolution", str(RESOLUTION), "--jobs", "2"]
    words += ["--scene", "airborne", "--quality", "draft"]
    command = [sys.executable, "-m", "zeroset", "reconstruct", *map(str, inputs), *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = contents(folder)
    glb = [name for name in found if name.endswith(".glb")]
    assert len(glb) == 5 and "levels/1/0_0.glb" in glb
    return found


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """A cluster of two processes."""
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
    )
    with cluster, distributed.Client(cluster) as client:
        yield client


def contents(folder: Path) -> dict[str, bytes]:
    """What others read of a folder: tiles, levels and their lists."""
    names = [*folder.glob("tiles/*"), *folder.glob("levels/*/*"), *folder.glob("tile*.json")]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in names}


def test_same_bits_as_the_command(inputs: list[Path], expected: dict[str, bytes], client: Any, tmp_path: Path) -> None:
    folder = tmp_path / "city"
    made = zeroset.dask.reconstruct(inputs, folder, client=client, **OPTIONS)
    assert contents(folder) == expected
    assert not (folder / "work").exists()
    assert [tile.name for tile in made.tiles] == ["0_0", "1_0", "0_1", "1_1"]
    assert sum(tile.points for tile in made.tiles) == sum(len(path.read_text().splitlines()) for path in inputs)
    # All is there: nothing is made again.
    begun = time.monotonic()
    assert zeroset.dask.reconstruct(inputs, folder, client=client, **OPTIONS) == made
    assert time.monotonic() - begun < 5.0
    with pytest.raises(zeroset.FileError, match="other inputs or options"):
        zeroset.dask.reconstruct(inputs[:1], folder, client=client, **OPTIONS)


def test_a_worker_is_lost(inputs: list[Path], expected: dict[str, bytes], client: Any, tmp_path: Path) -> None:
    folder = tmp_path / "city"
    victim = next(iter(client.run(os.getpid).values()))
    killed = threading.Event()

    def kill() -> None:
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline:
            if any(folder.glob("work/fit/*.strip")):
                if not (folder / "tiles.json").exists():
                    psutil.Process(victim).kill()
                    killed.set()
                return
            time.sleep(0.002)

    killer = threading.Thread(target=kill)
    killer.start()
    zeroset.dask.reconstruct(inputs, folder, client=client, **OPTIONS)
    killer.join()
    assert killed.is_set()
    assert not psutil.pid_exists(victim) or psutil.Process(victim).status() == psutil.STATUS_ZOMBIE
    assert contents(folder) == expected


def test_simplified(inputs: list[Path], client: Any, tmp_path: Path) -> None:
    part: Any = {**OPTIONS, "bounds": [[0.4, 0.4, -1.0], [0.7, 0.6, 1.0]]}
    coarse, fine = tmp_path / "coarse", tmp_path / "fine"
    simple = zeroset.dask.reconstruct(inputs, coarse, client=client, **part, max_error=0.002)
    assert 0 < simple.triangles < zeroset.dask.reconstruct(inputs, fine, client=client, **part).triangles / 3
    with pytest.raises(zeroset.ParameterError, match="max_error"):
        zeroset.dask.reconstruct(inputs, tmp_path / "a", client=client, **part, max_error=-1.0, retries=0)


def test_urls(inputs: list[Path], expected: dict[str, bytes], client: Any, tmp_path: Path) -> None:
    archive = tmp_path / "inputs.zip"
    with zipfile.ZipFile(archive, "w") as file:
        for path in inputs:
            file.write(path, path.name)
    urls = [f"zip://{path.name}::{archive.as_uri()}" for path in inputs]
    output = f"local://{(tmp_path / 'remote').as_posix()}"
    with pytest.raises(zeroset.ParameterError, match="scratch"):
        zeroset.dask.reconstruct(urls, output, client=client, **OPTIONS)
    made = zeroset.dask.reconstruct(urls, output, client=client, scratch=tmp_path / "scratch", **OPTIONS)
    assert made.output == output
    assert contents(tmp_path / "remote") == expected
    assert not (tmp_path / "scratch").exists()


def test_errors_come_through(inputs: list[Path], client: Any, tmp_path: Path) -> None:
    with pytest.raises(zeroset.ParameterError, match="tile"):
        zeroset.dask.reconstruct(inputs, tmp_path / "a", client=client, **{**OPTIONS, "tile": 0.1}, retries=0)
    with pytest.raises(FileNotFoundError):
        zeroset.dask.reconstruct([tmp_path / "none.xyz"], tmp_path / "b", client=client, **OPTIONS, retries=0)
    with pytest.raises(zeroset.InputError):
        zeroset.dask.reconstruct([], tmp_path / "c", client=client, **OPTIONS)
