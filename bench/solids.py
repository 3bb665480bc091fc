"""Solids against the mesh Booleans of the library manifold, and what models cost.

    python3 bench/solids.py [--zeroset PATH] [--work DIR] [--delft FILE]

Booleans: each solid is made by `zeroset mesh` from an expression, and by manifold3d from meshes. Told are the error of the volume, where it is
known exactly, the symmetric difference of both as a share of the volume, the genus of the largest piece and the number of pieces (zeroset's
and manifold's), and the seconds of each (zeroset's with its start
and all reading and writing, manifold's without).

Cost: evaluations a second of a fitted model of about a million nodes, on one thread and on all; with `--delft`, the size of its model at
0.5 m, the seconds to open it, and what is told of a building that is added: cut and fill against its volume.
"""

import argparse
import json
import math
import tempfile
import time
from pathlib import Path

import igl
import manifold3d as m3
import numpy as np

from common import add_common, binary, measured, output_json

SEGMENTS = 2048


def numbers(values):
    return ",".join(repr(float(v)) for v in values)


def box(low, high):
    low, high = np.asarray(low, float), np.asarray(high, float)
    return f"box({numbers(low)}; {numbers(high)})", m3.Manifold.cube(high - low).translate(low)


def cylinder(low, high, radius):
    """Upright, from `low` to the height `high`."""
    text = f"cylinder({numbers(low)}; {low[0]!r},{low[1]!r},{high!r}; {radius!r})"
    return text, m3.Manifold.cylinder(high - low[2], radius, radius, SEGMENTS).translate(low)


def turned(solid, degrees, shift):
    """Turned about the axes x, then y, then z."""
    text, mesh = solid
    turns = " ".join(f"rotate({axis}, {angle!r}deg)" for axis, angle in zip("xyz", degrees))
    return f"{text} {turns} at({numbers(shift)})", mesh.rotate(degrees).translate(shift)


def combined(operation, solids):
    texts, meshes = zip(*solids)
    operations = {"union": lambda a, b: a + b, "subtract": lambda a, b: a - b, "intersect": lambda a, b: a ^ b}
    result = meshes[0]
    for mesh in meshes[1:]:
        result = operations[operation](result, mesh)
    return f"{operation}({'; '.join(texts)})", result


def cases():
    """Name, cell, solid, and the exact volume or None."""
    block = box([0, 0, 0], [4, 2, 1])
    bore = cylinder([2.0, 1.0, -1.0], 2.0, 0.5)
    yield "box minus cylinder", 0.04, combined("subtract", [block, bore]), 8.0 - 0.25 * math.pi
    rng = np.random.default_rng(5)
    for k in range(6):
        # Corners of one lie well inside of the other, so that faces meet at an angle.
        pair = [turned(box([-1, -0.8, -0.6], [1, 0.8, 0.6]), rng.uniform(-60, 60, 3).tolist(), [0.0, 0.0, 0.0])]
        pair.append(turned(box([-0.5, -0.5, -1.4], [0.5, 0.5, 1.4]), rng.uniform(-60, 60, 3).tolist(), [0.1, 0.05, 0.0]))
        for operation in ("union", "subtract", "intersect"):
            yield f"two boxes {k} {operation}", 0.02, combined(operation, pair), None
    ring = []
    for k in range(8):
        angle = k * 45.0
        brick = box([-0.45, -0.2, -0.15 - 0.02 * k], [0.45, 0.2, 0.15 + 0.02 * k])
        place = [math.cos(math.radians(angle)), math.sin(math.radians(angle)), 0.0]
        ring.append(turned(brick, [0.0, 0.0, angle + 90.0], place))
    yield "eight boxes", 0.015, combined("union", ring), None


def read(path):
    """A mesh of zeroset as a manifold."""
    vertices, triangles = igl.read_triangle_mesh(str(path))
    return m3.Manifold(m3.Mesh64(vert_properties=vertices, tri_verts=triangles.astype(np.uint64)))


def booleans(zeroset, work):
    print(f"{'solid':24} {'volume off':>11} {'sym. diff.':>11} {'genus':>6} {'pieces':>7} {'zeroset':>8} {'manifold':>9}")
    for name, cell, (text, _), exact in cases():
        begin = time.perf_counter()
        truth = next(solid for n, _, (_, solid), _ in cases() if n == name)
        volume = truth.volume()
        theirs = time.perf_counter() - begin
        path = work / "solid.ply"
        ours = measured([zeroset, "mesh", text, "-o", path, "--cell", cell, "--quiet"])["wall"]
        mesh = read(path)
        assert mesh.status() == m3.Error.NoError, f"{name}: {mesh.status()}"
        apart = (mesh - truth).volume() + (truth - mesh).volume()
        off = mesh.volume() / (exact or volume) - 1.0
        pieces = [sorted(solid.decompose(), key=lambda piece: -piece.volume()) for solid in (mesh, truth)]
        genus = "/".join(f"{own[0].genus()}" for own in pieces)
        count = "/".join(f"{len(own)}" for own in pieces)
        print(f"{name:24} {off:11.2e} {apart / volume:11.2e} {genus:>6} {count:>7} {ours:8.2f} {theirs:9.3f}")


def evaluation(zeroset, work):
    cloud, model, points = work / "city.ply", work / "city.zset", work / "points.npy"
    measured([zeroset, "sample", "city", "--points", 100_000, "--noise", 0.001, "-o", cloud])
    measured([zeroset, "fit", cloud, "-o", model, "--scene", "terrain", "--resolution", 0.0047, "--quiet"])
    nodes = output_json([zeroset, "info", model, "--json"])["fitted"][0]["nodes"]
    rng = np.random.default_rng(1)
    positions = np.column_stack([rng.random((5_000_000, 2)), rng.uniform(-0.02, 0.18, 5_000_000)])
    np.save(points, positions)
    for threads in (1, None):
        words = [zeroset, "eval", model, "--points", points, "-o", work / "values.npy", "--report", "-", "--quiet"]
        report = output_json(words + (["--threads", threads] if threads else []))
        rate = report["points"] / report["seconds"] / 1e6
        print(f"values and gradients, {nodes} nodes, threads {threads or 'all'}: {rate:.1f} million a second")


def delft(zeroset, work, cloud):
    tile, planned = work / "tile.zset", work / "planned.zset"
    measured([zeroset, "fit", cloud, "-o", tile, "--resolution", 0.5, "--quiet"])
    seconds = min(measured([zeroset, "info", tile])["wall"] for _ in range(5))
    print(f"model of Delft: {tile.stat().st_size / 1e6:.1f} MB, opened and told of in {seconds:.2f} s")
    # A block that stands free of everything else from its lower side on.
    block = "box(84960,447505,12; 84975,447520,30) rotate(z, 25deg; 84967,447512,0)"
    measured([zeroset, "edit", tile, "union", block, "-o", planned, "--quiet"])
    change = output_json([zeroset, "volume", tile, planned, "--report", "-"])["change"]
    back = output_json([zeroset, "volume", planned, tile, "--report", "-"])["change"]
    exact = 15.0 * 15.0 * 18.0
    print(f"a block of {exact:.0f}: filled {change['fill']['volume']:.1f} +- {change['fill']['error']:.1f}, "
          f"cut on the way back {back['cut']['volume']:.1f}, {100 * (change['fill']['volume'] / exact - 1):+.2f} %")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    parser.add_argument("--delft", metavar="FILE", help="the airborne tile delft_ahn3.laz")
    args = parser.parse_args()
    zeroset = binary(args.zeroset)
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(args.work or temporary)
        work.mkdir(parents=True, exist_ok=True)
        booleans(zeroset, work)
        evaluation(zeroset, work)
        if args.delft:
            delft(zeroset, work, args.delft)


if __name__ == "__main__":
    main()
