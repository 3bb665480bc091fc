"""Pictures: zeroset render against VTK through PyVista, both without a display.

    python bench/render.py --zeroset BIN --work DIR [--triangles 1000000]

Draws hills of so many triangles, and as many points, on 1600 by 1200 pixels, in turn, five times each, and prints the fastest. Reading is left out of both.
"""

import argparse
import json
import subprocess
import time
from pathlib import Path

import numpy as np
import pyvista


def hills(triangles):
    n = int((triangles / 2) ** 0.5) + 1
    x, y = np.meshgrid(np.linspace(0, 20, n), np.linspace(0, 20, n), indexing="ij")
    z = np.sin(x) * np.cos(1.3 * y) + 0.3 * np.sin(5 * x + 3 * y)
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    return np.stack([x, y, z], -1).reshape(-1, 3), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def write_ply(path, vertices, triangles):
    rows = np.empty(len(triangles), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    rows["n"], rows["corners"] = 3, triangles
    properties = "".join(f"property float {axis}\n" for axis in "xyz")
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
    if len(triangles):
        header += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\n"
    path.write_bytes((header + "end_header\n").encode() + vertices.astype("<f4").tobytes() + rows.tobytes())


def ours(binary, work, file):
    report = work / "report.json"
    words = ["render", file, "-o", work / "ours.png", "--color", "plain", "--quiet", "--report", report]
    subprocess.run([binary, *map(str, words)], check=True)
    return json.loads(report.read_text())["seconds"]["draw"]


def theirs(work, data, **options):
    plotter = pyvista.Plotter(off_screen=True, window_size=(1600, 1200))
    plotter.add_mesh(data, **options)
    begun = time.perf_counter()
    plotter.screenshot(work / "theirs.png")
    seconds = time.perf_counter() - begun
    plotter.close()
    return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--zeroset", required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--triangles", type=int, default=1_000_000)
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    vertices, triangles = hills(args.triangles)
    rng = np.random.default_rng(1)
    points = vertices[rng.integers(0, len(vertices), args.triangles)] + rng.normal(0, 0.01, (args.triangles, 3))
    write_ply(args.work / "mesh.ply", vertices, triangles)
    write_ply(args.work / "points.ply", points, triangles[:0])
    mesh = pyvista.PolyData.from_regular_faces(vertices, triangles)
    cloud = pyvista.PolyData(points)
    for name, data, options in (("mesh", mesh, {}), ("points", cloud, {"point_size": 2})):
        pairs = [(ours(args.zeroset, args.work, args.work / f"{name}.ply"), theirs(args.work, data, **options)) for _ in range(5)]
        own, other = np.min(pairs, 0)
        print(f"{name}: zeroset {own:.3f} s, VTK {other:.3f} s, ratio {own / other:.2f}")


main()
