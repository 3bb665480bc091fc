"""Tiles against a run without, kills, and the cost of larger clouds.

    python bench/tiles.py --zeroset BIN --work DIR [--delft delft_ahn3.laz] [--points 2000000] [--quality normal]

Prints, for Delft in four tiles and for a simulated city in nine: components, open edges, vertices shared bit for bit, and the distance of either
surface from the other, in cells; then whether a run that was killed ten times ends with the same bits; then seconds and memory for
each million points, with tiles as wide as 4 GB allow for.
"""

import argparse
import json
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import igl
import numpy as np


def run(binary, *words):
    subprocess.run([binary, *map(str, words), "--quiet"], check=True)


def read_ply(path):
    with open(path, "rb") as file:
        counts, fields = {}, []
        while (line := file.readline().decode().strip()) != "end_header":
            words = line.split()
            if words[0] == "element":
                counts[words[1]] = int(words[2])
            elif words[0] == "property" and "face" not in counts:
                fields.append((words[2], {"double": "<f8", "float": "<f4", "uchar": "u1", "ushort": "<u2"}[words[1]]))
        vertices = np.frombuffer(file.read(counts["vertex"] * np.dtype(fields).itemsize), dtype=fields)
        faces = np.frombuffer(file.read(counts["face"] * 13), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    return np.stack([vertices[c] for c in "xyz"], 1).astype(float), faces["corners"].astype(np.int64)


def samples(vertices, faces, count, seed=1):
    rng = np.random.default_rng(seed)
    corners = vertices[faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[rng.choice(len(faces), count, p=areas / areas.sum())]
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return chosen[:, 0] + u * (chosen[:, 1] - chosen[:, 0]) + v * (chosen[:, 2] - chosen[:, 0])


def distances(one, other, cell, count=200_000):
    origin = one[0].min(0)
    points = samples(one[0] - origin, one[1], count)
    squared = igl.point_mesh_squared_distance(points, np.ascontiguousarray(other[0] - origin), other[1])[0]
    return np.sqrt(np.maximum(squared, 0)) / cell


def open_edges(mesh):
    sides = np.sort(np.concatenate([mesh[1][:, [0, 1]], mesh[1][:, [1, 2]], mesh[1][:, [2, 0]]]), axis=1)
    edges, times = np.unique(sides, axis=0, return_counts=True)
    return mesh[0][edges[times == 1]].mean(1)


def compare(binary, work, cloud, cell, side, quality, options=()):
    common = ["reconstruct", cloud, "--resolution", cell, "--quality", quality, *options]
    run(binary, *common, "-o", work / "whole.ply")
    run(binary, *common, "-o", work / "tiled.ply", "--tile", side)
    shutil.rmtree(work / "tiles", ignore_errors=True)
    run(binary, *common, "-o", f"{work / 'tiles'}/", "--tile", side, "--tile-format", "ply")
    for name in ("whole", "tiled"):
        info = subprocess.run([binary, "info", work / f"{name}.ply", "--json"], check=True, capture_output=True)
        found = json.loads(info.stdout)["topology"]
        keys = ("nonmanifold_edges", "nonmanifold_vertices", "duplicate_triangles", "boundary_edges", "boundary_loops")
        print(f"  {name}: {found['faces']} triangles, {len(found['components'])} components,", {k: found[k] for k in keys})
    whole, tiled = read_ply(work / "whole.ply"), read_ply(work / "tiled.ply")
    for name, one, other in (("tiled to whole", tiled, whole), ("whole to tiled", whole, tiled)):
        found = distances(one, other, cell)
        print(f"  {name}: median {np.median(found):.4f}, mean {found.mean():.4f}, 99 % {np.quantile(found, 0.99):.3f} cells")
    # Open edges of the tiled mesh beside faces, far from open edges of the whole.
    edges, own = open_edges(tiled), open_edges(whole)
    beside = edges[(np.abs((edges[:, :2] / side + 0.5) % 1 - 0.5) * side < 2 * cell).any(1)]
    astray = sum(np.min(np.linalg.norm(own - edge, axis=1)) > 6 * cell for edge in beside)
    print(f"  open edges beside faces: {len(beside)}, of which far from those of the whole: {astray}")
    # What tiles share, in world coordinates.
    shared = different = 0
    tiles = {p.stem: p for p in (work / "tiles" / "tiles").iterdir()}
    rims = {}
    for name, path in tiles.items():
        mesh = read_ply(path)
        edges = np.sort(np.concatenate([mesh[1][:, [0, 1]], mesh[1][:, [1, 2]], mesh[1][:, [2, 0]]]), axis=1)
        unique, times = np.unique(edges, axis=0, return_counts=True)
        rims[name] = {v.tobytes() for v in mesh[0][np.unique(unique[times == 1])]}
    for one, own in rims.items():
        x, y = map(int, one.split("_"))
        for dx, dy in ((1, 0), (0, 1)):
            other = rims.get(f"{x + dx}_{y + dy}")
            if other:
                shared += len(own & other)
                axis = 0 if dx else 1
                face = (x + 1 if dx else y + 1) * side
                near = lambda rim: {v for v in rim if abs(np.frombuffer(v)[axis] - face) < 1.01 * cell}
                different += len(near(own) ^ near(other))
    print(f"  vertices on rims of neighbours that are equal bit for bit: {shared}; of one side only, within a cell of a face: {different}")
    return whole, tiled


def files(folder):
    named = {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    return {name: data for name, data in named.items() if not Path(name).name.startswith(".zeroset-")}


def kills(binary, work, cloud, cell, side, quality, options=()):
    words = ["reconstruct", cloud, "--resolution", cell, "--quality", quality, "--tile", side, *options, "--quiet"]
    for name in ("unhurt", "killed"):
        shutil.rmtree(work / name, ignore_errors=True)
    begun = time.time()
    run(binary, *words[:-1], "-o", f"{work / 'unhurt'}/")
    whole = time.time() - begun
    chance, done = random.Random(7), 0
    while done < 10:
        child = subprocess.Popen([binary, *map(str, words), "-o", f"{work / 'killed'}/"])
        time.sleep(chance.uniform(0.02, 0.25) * whole)
        if child.poll() is not None:
            break
        child.send_signal(signal.SIGKILL)
        child.wait()
        done += 1
    run(binary, *words[:-1], "-o", f"{work / 'killed'}/")
    same = files(work / "unhurt") == files(work / "killed")
    print(f"  killed {done} times; same bits: {same}")


def cost(binary, work, points, quality):
    """Tiles as wide as 4 GB allow for. Noise is a third of the spacing, so that cells are as rough in a large cloud as in a small one."""
    cloud = work / f"cost-{points}.las"
    if not cloud.exists():
        words = ["sample", "airborne-city", "--points", points, "--noise", round(0.33 / points**0.5, 7), "-o", cloud]
        subprocess.run([binary, *map(str, words)], check=True)
    shutil.rmtree(work / "cost", ignore_errors=True)
    report = work / "cost.json"
    run(binary, "reconstruct", cloud, "-o", f"{work / 'cost'}/", "--memory", "4GB", "--jobs", 2, "--quality", quality, "--report", report)
    found = json.loads(report.read_text())
    seconds, peak, tiles = found["total_seconds"], found["memory_peak_bytes"] / 1e9, found["plan"]["tiles"]
    stages = {"sort": found["sort_seconds"], **found["seconds"]}
    print(f"  {points / 1e6:g} M points, {len(tiles)} tiles of {found['plan']['side'] / found['plan']['report']['resolution']:.0f} cells: "
          f"{seconds:.1f} s, {seconds / points * 1e6:.1f} s a million, {peak:.2f} GB at most, {found['triangles'] / 1e6:.1f} M triangles;")
    print("    s a million:", {stage: round(value / points * 1e6, 2) for stage, value in stages.items()})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--zeroset", required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--delft", type=Path)
    parser.add_argument("--points", type=int, default=2_000_000)
    parser.add_argument("--costs", type=int, nargs="*", default=[1_000_000, 5_000_000, 50_000_000])
    parser.add_argument("--quality", default="normal")
    parser.add_argument("--only", nargs="*", default=["delft", "city", "kills", "cost"])
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    if args.delft and "delft" in args.only:
        print("Delft in four tiles")
        compare(args.zeroset, args.work, args.delft, 0.5, 250, args.quality)
    if args.delft and "kills" in args.only:
        print("Delft, killed")
        kills(args.zeroset, args.work, args.delft, 0.5, 120, "draft")
    if "city" in args.only:
        print("city in nine tiles")
        cloud = args.work / f"city-{args.points}.las"
        words = ["sample", "airborne-city", "--points", args.points, "--noise", 0.0003, "-o", cloud]
        subprocess.run([args.zeroset, *map(str, words)], check=True)
        cell = round(1.5 / args.points**0.5, 6)
        compare(args.zeroset, args.work, cloud, cell, 1 / 3, args.quality, ["--scene", "airborne"])
    if "cost" in args.only:
        print("cost")
        for points in args.costs:
            cost(args.zeroset, args.work, points, args.quality)


main()
