"""How well zeroset tells inside from outside on bodies whose truth is known.

Each body is scaled to a diagonal of 1 and sampled: 60,000 points spread evenly by area, with Gaussian noise of 0.002.
zeroset reconstructs them as an object at a finest cell of the longest side of their box over 107. Measured is the share
of 20,000 and of 100,000 random points at which mesh and truth agree whether the winding number is over 1/2; the points
are uniform in the box of the cloud, grown by a tenth of its longest side on every side. Where the fast winding number
comes near 1/2 it is computed again exactly. As most of these points are outside both, the overlap is given, too: the
points inside both over those inside either. It tells more about thin bodies.

The last body is made here: a plate of 1 x 0.7 x 0.03 with 3 x 2 pockets, walls and floor 0.01 thick, not scaled, with
noise of 0.001. A body whose file is absent is skipped. The standard error of a share p over n points is
sqrt(p (1 - p) / n).
"""

import argparse
import math
import tempfile
from pathlib import Path

import igl
import numpy as np

from common import ROOT, add_common, binary, measured, output_json, table

BODIES = [
    ("fertility.off", 0.998),
    ("fandisk.obj", 0.9979),
    ("anchor.off", 0.9973),
    ("block.obj", 0.997),
    ("featuretype.stl", 0.994),
]
PLATE_TARGET = 0.99
CELLS_ALONG = 107
MARGIN = 0.1
DOUBTFUL = 0.2  # the fast winding number is trusted this far from 1/2


def plate():
    """A closed plate with 3 x 2 pockets from above, as a union of bricks: vertices and triangles."""
    wall = 0.01

    def planes(length, pockets):
        pocket = (length - (pockets + 1) * wall) / pockets
        return np.cumsum([0.0] + [wall, pocket] * pockets + [wall])

    at = [planes(1.0, 3), planes(0.7, 2), np.array([0.0, wall, 0.03])]
    full = np.zeros([len(p) + 1 for p in at], bool)  # a layer of empty bricks all around
    for i in range(1, len(at[0])):
        for j in range(1, len(at[1])):
            full[i, j, 1] = True
            full[i, j, 2] = i % 2 == 1 or j % 2 == 1
    corners, triangles = {}, []
    for cell in np.argwhere(full):
        for axis in range(3):
            for side in (0, 1):
                beyond = cell.copy()
                beyond[axis] += 2 * side - 1
                if full[tuple(beyond)]:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                face = []
                for du, dv in [(0, 0), (1, 0), (1, 1), (0, 1)][:: 2 * side - 1]:
                    corner = cell - 1
                    corner[axis] += side
                    corner[u] += du
                    corner[v] += dv
                    face.append(corners.setdefault(tuple(corner), len(corners)))
                triangles += [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]
    vertices = np.array([[at[a][c[a]] for a in range(3)] for c in corners])
    return vertices, np.array(triangles, dtype=np.int64)


def read(path):
    """Vertices and triangles of a mesh file; corners in the same place become one vertex, as STL has none."""
    vertices, triangles = igl.read_triangle_mesh(str(path))
    if Path(path).suffix == ".stl":
        vertices, number = np.unique(vertices, axis=0, return_inverse=True)
        triangles = number.reshape(-1)[triangles]
    return np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(triangles, dtype=np.int64)


def write_off(path, vertices, triangles):
    with open(path, "w") as out:
        out.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
        np.savetxt(out, vertices, fmt="%.17g")
        np.savetxt(out, np.insert(triangles, 0, 3, axis=1), fmt="%d")


def scaled(vertices):
    """The same shape with the diagonal of its box 1 and its middle in the origin."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return (vertices - 0.5 * (low + high)) / np.linalg.norm(high - low)


def sampled(vertices, triangles, count, noise, rng):
    """Points spread evenly by area over triangles, with Gaussian noise on every coordinate."""
    return sampled_with_triangles(vertices, triangles, count, noise, rng)[0]


def sampled_with_triangles(vertices, triangles, count, noise, rng):
    """The same, with the triangle of each point."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = rng.choice(len(triangles), size=count, p=area / area.sum())
    root, v = np.sqrt(rng.random((count, 1))), rng.random((count, 1))
    points = (1 - root) * a[chosen] + root * (1 - v) * b[chosen] + root * v * c[chosen]
    return points + rng.normal(scale=noise, size=points.shape), chosen


def inside(mesh, points):
    """Whether the generalised winding number of the mesh is over 1/2 at each point."""
    winding = np.asarray(igl.fast_winding_number(*mesh, points)).ravel()
    doubtful = np.flatnonzero(np.abs(winding - 0.5) < DOUBTFUL)
    for chunk in np.array_split(doubtful, math.ceil(len(doubtful) / 256) or 1):
        if len(chunk):
            winding[chunk] = np.asarray(igl.winding_number(*mesh, points[chunk])).ravel()
    return winding > 0.5


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    parser.add_argument("--data", metavar="DIR", default=ROOT.parent / "shared" / "data", help="folder of the truths")
    parser.add_argument("--points", type=int, default=60_000)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    zeroset = binary(args.zeroset)

    bodies = []
    for name, target in BODIES:
        path = Path(args.data) / name
        if path.exists():
            vertices, triangles = read(path)
            bodies.append((name, scaled(vertices), triangles, 0.002, target))
        else:
            print(f"{name} is skipped: no such file in the data folder")
    bodies.append(("plate with pockets", *plate(), 0.001, PLATE_TARGET))

    head = ["body", "20 k points", "100 k points", "target", "reached", "overlap", "volume over truth's", "triangles",
            "components", "closed", "genus (truth)", "rms distance", "CPU s"]
    rows = [head]
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(args.work or temporary)
        work.mkdir(parents=True, exist_ok=True)
        for name, vertices, triangles, noise, target in bodies:
            rng = np.random.default_rng(args.seed)
            stem = name.replace(" ", "-").replace(".", "-")
            cloud, truth, mesh = (work / f"{stem}{end}" for end in (".xyz", "-truth.off", ".off"))
            points = sampled(vertices, triangles, args.points, noise, rng)
            np.savetxt(cloud, points, fmt="%.9g")
            write_off(truth, vertices, triangles)
            low, high = points.min(axis=0), points.max(axis=0)
            longest = (high - low).max()
            cost = measured([zeroset, "reconstruct", cloud, "-o", mesh, "--scene", "object", "--quiet",
                             "--resolution", longest / CELLS_ALONG])
            both = read(mesh), (vertices, triangles)
            tests = rng.uniform(low - MARGIN * longest, high + MARGIN * longest, size=(100_000, 3))
            within = [inside(m, tests) for m in both]
            agree = np.equal(*within)
            overlap = np.logical_and(*within).sum() / np.logical_or(*within).sum()
            shares = agree[:20_000].mean(), agree.mean()
            found = output_json([zeroset, "compare", mesh, truth, "--samples", "30000", "--json"])
            ours, exact = found["mesh"], found["truth"]
            volumes = [m["volume"] for m in (ours, exact)]
            rows.append([name, *[f"{s:.5f}" for s in shares], f"{target}", "yes" if shares[1] >= target else "no",
                         f"{overlap:.4f}", f"{volumes[0] / volumes[1]:.4f}" if all(volumes) else "-", f"{ours['faces']:,}",
                         str(len(ours["components"])), "yes" if ours["closed"] else "no",
                         f"{ours['genus']} ({exact['genus']})",
                         f"{found['overall']['distances']['combined']['rms']:.5f}", f"{cost['cpu']:.1f}"])
            print(f"{name}: {shares[1]:.5f}", flush=True)
    print()
    print(table(rows))


if __name__ == "__main__":
    main()
