"""Compares zeroset with Open3D's usual path on one synthetic cloud, in one run.

Measured are seconds of the processor (user and system, all threads), wall seconds and the peak resident set, each in a
child process of its own that reads the same cloud and writes a mesh; reading and writing are included. Both meshes are
then held against the exact truth by `zeroset compare`.

Both get the same finest cell. Open3D's path: normals from the 30 nearest neighbours, oriented over the tangent planes
of 30 neighbours, screened Poisson at the depth whose cells have that size (its cube is widened to make them exactly
so), the surface cut to the box of the points, and the vertices of lowest density (1.5 %) taken away. zeroset gets the
raw points and its defaults.

    python bench/quick_peer.py
    python bench/quick_peer.py --kind airborne-city --points 100000
"""

import argparse
import json
import math
import sys
import tempfile
import time
from pathlib import Path

from common import add_common, binary, measured, output_json, table

CELL_REL = 1.2  # the cell over the spacing of the points
NEIGHBOURS = 30
TRIM = 0.015  # share of the vertices, those of lowest density
LEAST_SCALE = 1.1  # Open3D's default for the cube over the box


def open3d_path(cloud, mesh, cell, stages):
    """The child process: Open3D from the cloud's file to the mesh's file."""
    start = time.perf_counter()
    import numpy
    import open3d

    seconds = {}

    def done(name):
        nonlocal start
        now = time.perf_counter()
        seconds[name], start = now - start, now

    done("import")
    points = open3d.io.read_point_cloud(cloud)
    done("read")
    points.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(NEIGHBOURS))
    done("normals")
    points.orient_normals_consistent_tangent_plane(NEIGHBOURS)
    done("orientation")
    extent = float(max(points.get_max_bound() - points.get_min_bound()))
    depth = math.ceil(math.log2(LEAST_SCALE * extent / cell))
    scale = cell * 2**depth / extent
    surface, density = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(points, depth=depth, scale=scale)
    done("poisson")
    # Without the cut the sheet beyond the box would be held against Open3D.
    density, vertices = numpy.asarray(density), numpy.asarray(surface.vertices)
    low, high = points.get_min_bound(), points.get_max_bound()
    beyond = ((vertices < low - cell) | (vertices > high + cell)).any(axis=1)
    surface.remove_vertices_by_mask(beyond)
    density = density[~beyond]
    surface.remove_vertices_by_mask(density < numpy.quantile(density, TRIM))
    done("trim")
    open3d.io.write_triangle_mesh(mesh, surface)
    done("write")
    Path(stages).write_text(json.dumps({"depth": depth, "scale": scale, "seconds": seconds}))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    parser.add_argument("--kind", default="city", help="scene of `zeroset sample` [default: city]")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--cell", type=float, help=f"finest cell [default: {CELL_REL} times the spacing]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--open3d-child", nargs=4, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.open3d_child:
        cloud, mesh, cell, stages = args.open3d_child
        return open3d_path(cloud, mesh, float(cell), stages)

    zeroset = binary(args.zeroset)
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(args.work or temporary)
        work.mkdir(parents=True, exist_ok=True)
        cloud, truth, report, stages = (work / n for n in ("cloud.ply", "truth.ply", "report.json", "stages.json"))
        ours, theirs = work / "zeroset.ply", work / "open3d.ply"
        measured([zeroset, "sample", args.kind, "-o", cloud, "--truth", truth, "--points", args.points,
                  "--seed", args.seed])
        measured([zeroset, "reconstruct", cloud, "--dry-run", "--quiet", "--report", report])
        plan = json.loads(report.read_text())["plan"]
        cell = args.cell or CELL_REL * plan["spacing"]
        costs = [
            measured([zeroset, "reconstruct", cloud, "-o", ours, "--resolution", cell, "--quiet", "--report", report]),
            measured([sys.executable, __file__, "--open3d-child", cloud, theirs, cell, stages]),
        ]
        figures = [output_json([zeroset, "compare", mesh, truth, "--json"]) for mesh in (ours, theirs)]
        done, peer = json.loads(report.read_text()), json.loads(stages.read_text())

    print(f"{args.kind}, {args.points} points, seed {args.seed}: spacing {plan['spacing']:.6f}, cell {cell:.6f} "
          f"({cell / plan['spacing']:.2f} spacings), scene {done['plan']['scene']}; Open3D depth {peer['depth']}, "
          f"scale {peer['scale']:.3f}; tau {figures[0]['tau']:.6f}\n")
    rows = [["", "zeroset", "Open3D", "Open3D / zeroset"]]

    def add(name, values, form="{:.5g}", ratio=True):
        a, b = values
        shown = [("-" if v is None else form.format(v)) for v in (a, b)]
        rows.append([name, *shown, f"{b / a:.2f}" if ratio and a and b else ""])

    add("CPU seconds", [c["cpu"] for c in costs], "{:.1f}")
    add("wall seconds", [c["wall"] for c in costs], "{:.1f}")
    add("peak memory, MB", [c["peak"] / 1e6 for c in costs], "{:.0f}")
    add("microseconds of CPU a point", [c["cpu"] / args.points * 1e6 for c in costs], "{:.1f}")
    all_of, near = [f["overall"] for f in figures], [f["near_edges"] or {} for f in figures]
    for name in ("mean", "rms", "p95", "max"):
        add(f"distance, {name}", [f["distances"]["combined"][name] for f in all_of])
    for way in ("mesh_to_truth", "truth_to_mesh"):
        add(f"{way.replace('_', ' ')}, rms", [f["distances"][way]["rms"] for f in all_of])
    for name in ("f_score", "precision", "recall", "normal_consistency", "orientation"):
        add(name.replace("_", " "), [f[name] for f in all_of], "{:.5f}", ratio=False)
    if all(near):
        add("distance near edges, rms", [f["distances"]["combined"]["rms"] for f in near])
        add("F-score near edges", [f["f_score"] for f in near], "{:.5f}", ratio=False)
        add("normal consistency near edges", [f["normal_consistency"] for f in near], "{:.5f}", ratio=False)
    add("inside or outside right", [f["occupancy"] for f in figures], "{:.5f}", ratio=False)
    add("triangles", [f["mesh"]["faces"] for f in figures], "{:d}")
    add("components", [len(f["mesh"]["components"]) for f in figures], "{:d}", ratio=False)
    add("boundary loops", [f["mesh"]["boundary_loops"] for f in figures], "{:d}", ratio=False)
    add("non-manifold edges", [f["mesh"]["nonmanifold_edges"] for f in figures], "{:d}", ratio=False)
    print(table(rows))
    for name, seconds in (("zeroset", done["seconds"]), ("Open3D", peer["seconds"])):
        print(f"\nwall seconds of {name}: " + ", ".join(f"{k} {v:.2f}" for k, v in seconds.items()), end="")
    print()


if __name__ == "__main__":
    main()
