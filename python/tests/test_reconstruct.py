"""Meshes and models of points."""

import os
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import GRID

import zeroset
from zeroset._types import Floats


def test_a_torus_has_one_hole(torus: Floats) -> None:
    mesh = zeroset.reconstruct(torus)
    found = mesh.topology()
    assert found["closed"] and found["genus"] == 1 and found["nonmanifold_edges"] == 0
    # The noise of the points is 0.001.
    across = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1]) - 0.35
    assert np.abs(np.hypot(across, mesh.vertices[:, 2]) - 0.15).mean() < 0.001
    assert mesh.volume == pytest.approx(2.0 * np.pi**2 * 0.35 * 0.15**2, rel=0.01)
    assert mesh.report["plan"]["scene"] == "object" and mesh.report["triangles"] == len(mesh.triangles)


def test_threads_and_types_do_not_change_the_mesh(torus: Floats) -> None:
    rounded = torus.astype(np.float32)
    one = zeroset.reconstruct(rounded, quality="draft", threads=1)
    two = zeroset.reconstruct(rounded.astype(np.float64), quality="draft", threads=2)
    np.testing.assert_array_equal(one.local, two.local)
    np.testing.assert_array_equal(one.triangles, two.triangles)


def test_national_grids_keep_their_digits(torus: Floats) -> None:
    near = zeroset.reconstruct(torus, quality="draft", scene="object")
    far = zeroset.reconstruct(torus + GRID, quality="draft", scene="object", crs="EPSG:28992")
    assert far.crs == "EPSG:28992" and far.world_from_local.any() and not near.world_from_local.any()
    assert near.vertices is near.local
    np.testing.assert_allclose(far.vertices.min(axis=0), near.vertices.min(axis=0) + GRID, atol=0.01)
    assert np.abs(far.local).max() < 100.0


def test_values_reach_the_vertices(torus: Floats) -> None:
    left = torus[:, 0] < 0.0
    colors = np.where(left[:, None], [255, 0, 0], [0, 0, 255]).astype(np.uint8)
    mesh = zeroset.reconstruct(torus, quality="draft", colors=colors, classes=np.where(left, 2, 6))
    assert mesh.colors is not None and mesh.classes is None
    assert (mesh.colors[mesh.vertices[:, 0] < -0.05] == [255, 0, 0]).all()
    classes = zeroset.reconstruct(torus, quality="draft", classes=np.where(left, 2, 6)).classes
    assert classes is not None and classes.dtype == np.uint8 and set(classes) == {2, 6}


def test_a_mesh_can_be_made_small(torus: Floats) -> None:
    mesh = zeroset.reconstruct(torus, quality="draft", triangles=500)
    assert len(mesh.triangles) <= 500
    assert mesh.report["simplify"]["triangles_after"] == len(mesh.triangles)


def test_progress_is_told_on_the_calling_thread(torus: Floats) -> None:
    told: list[tuple[str, float]] = []
    threads: set[int] = set()

    def progress(stage: str, share: float) -> None:
        told.append((stage, share))
        threads.add(threading.get_ident())

    zeroset.reconstruct(torus, quality="draft", progress=progress)
    shares = [share for _, share in told]
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert told[0][0] == "measuring the points" and "extracting the surface" in {stage for stage, _ in told}
    assert threads == {threading.get_ident()}


def test_what_the_callback_raises_stops_the_work(torus: Floats) -> None:
    calls = 0

    def progress(stage: str, share: float) -> None:
        nonlocal calls
        calls += 1
        raise zeroset.Cancelled("enough")

    with pytest.raises(zeroset.Cancelled, match="enough"):
        zeroset.reconstruct(torus, progress=progress)
    assert calls == 1


def test_ctrl_c_stops_the_work() -> None:
    points = zeroset.sample("city", points=150_000)
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    # A process in the background begins with the signal ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer.start()
        start = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            zeroset.reconstruct(points, resolution=0.1)
    finally:
        signal.signal(signal.SIGINT, before)
    # Undisturbed this takes more than a minute.
    assert time.monotonic() - start < 20.0


def test_other_threads_go_on_meanwhile(torus: Floats) -> None:
    turns = 0
    is_done = threading.Event()

    def count() -> None:
        nonlocal turns
        while not is_done.wait(0.001):
            turns += 1

    thread = threading.Thread(target=count)
    thread.start()
    zeroset.reconstruct(torus, quality="draft")
    is_done.set()
    thread.join()
    assert turns > 20


def test_constraints_come_from_files(tmp_path: Path) -> None:
    points = zeroset.sample("box", points=3000)
    path = tmp_path / "features.dxf"
    zeroset.features(points, scene="object").save(path)
    mesh = zeroset.reconstruct(points, scene="object", constraints=path)
    assert mesh.report["constraints"] is not None and mesh.report["plan"]["constraints"] is not None
