"""How well and at what cost zeroset finds planes, edges and corners, where the truth is known and on a real tile.

Parts, chosen by --only; all by default. CPU is seconds of the processor, user and system, of the whole command with
reading and writing.

city: `zeroset sample city` with noise of 0.001, several seeds. Only true faces of 50 points and more count, and edges
    and corners with points on all sides. A plane is right within 5 degrees and 3 times the noise, an edge within 2
    times, a corner within 3 times. On the first seed the planes of other libraries are judged in the same way:
    plane_peers.py.
airborne: `zeroset sample airborne-city`, over all of the truth, seen by the cloud or not.
creases: bodies scaled to a diagonal of 1, with 60,000 points spread evenly by area and noise of 0.001. Recall and
    precision of crease length within 0.01, over the whole truth. A true crease is straight where both its sides are
    flat, of 0.002 or more in area each; else it is curved.
noise: the same bodies with noise of 0.002, about half the spacing, several seeds: their flat faces (faces.py), and edges
    within 2 and corners within 3 times the noise.
smooth: planes on bodies that have none, or hardly any.
delft: cost; the share of roof points (class 6 and |n_z| > 0.3 over their 16 nearest of class 6) on a plane and within
    0.1 m of it; the share of the points of class 1 off roofs (no point of class 6 within 2 m in plan, or more than
    0.5 m above the highest there) on planes, which are false there, by and large.
polygons: whether the outlines are simple: polygons.py. Of the first seeds, and of delft.

    python bench/features.py
    python bench/features.py --only city airborne --seeds 0
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import plane_peers
import polygons
from common import ROOT, add_common, binary, measured, output_json, read_points, table
from faces import Faces
from objects import read, sampled_with_triangles, scaled, write_off

PARTS = ("city", "airborne", "creases", "noise", "smooth", "delft", "polygons")
NOISE = 0.001
BODIES = ("fandisk.obj", "anchor.off", "block.obj", "featuretype.stl")
BODY_POINTS = 60_000
BODY_TOLERANCE = 0.01
STRONG_NOISE = 0.002
FLAT_SIDE = 0.002  # least area of a flat side of a straight crease
SAME_FACE = np.radians(0.5)
SHARP = np.radians(30.0)
SAME_PLACE = 1e-6  # over the diagonal
STEP = 0.0005  # between the samples of a crease
TILE = "delft_ahn3.laz"


class Bench:
    def __init__(self, args, work):
        self.args, self.work, self.zeroset = args, work, binary(args.zeroset)
        self.outlines = []

    def sample(self, kind, seed, points):
        cloud, truth = (self.work / f"{kind}-{seed}{end}" for end in (".ply", "-truth.ply"))
        measured([self.zeroset, "sample", kind, "-o", cloud, "--truth", truth, "--points", points, "--noise", NOISE,
                  "--seed", seed])
        return cloud, truth

    def features(self, cloud, stem, *options):
        """Finds features: their file, that of the points, and the cost."""
        found, points = (self.work / f"{stem}{end}" for end in ("-found.json", "-found.ply"))
        cost = measured([self.zeroset, "features", cloud, "-o", found, "-o", points, "--quiet", *options])
        return found, points, cost

    def compare(self, found, truth, *options):
        return output_json([self.zeroset, "compare", "--features", found, truth, "--json", *options])


def shown(value, form="{:.3f}"):
    return "-" if value is None else form.format(value)


def mean_row(rows):
    """The last line of a table: means of columns of numbers."""
    columns = zip(*[row[1:] for row in rows])
    cells = []
    for column in columns:
        values = [v for v, _ in column if v is not None]
        cells.append((np.mean(values) if values else None, column[0][1]))
    return ["mean", *cells]


def seed_table(title, head, rows, extra=()):
    rows = rows + ([mean_row(rows)] if len(rows) > 1 else []) + list(extra)
    print(f"\n## {title}\n")
    print(table([head] + [[row[0], *[shown(*cell) for cell in row[1:]]] for row in rows]), flush=True)


def plane_cells(planes):
    recall = planes["all"]
    errors = [(planes[name] or {}).get("mean") for name in ("angle_error_deg", "offset_error")]
    return [(planes["found"], "{:.0f}"), (recall["by_area"], "{:.4f}"), (recall["by_count"], "{:.3f}"),
            (planes["precision"], "{:.3f}"), (errors[0], "{:.2f}"), (errors[1], "{:.6f}")]


def city(bench):
    tolerances = ["--tau", 3 * NOISE, "--edge-tolerance", 2 * NOISE, "--corner-tolerance", 3 * NOISE]
    rows, peers, absent = [], [], []
    for seed in bench.args.seeds:
        cloud, truth = bench.sample("city", seed, bench.args.points)
        found, _, cost = bench.features(cloud, f"city-{seed}")
        agreement = bench.compare(found, truth, "--cloud", cloud, *tolerances)
        edges, corners = agreement["edges"], agreement["corners"]
        rows.append([f"seed {seed}", *plane_cells(agreement["planes"]), (edges["recall"], "{:.3f}"),
                     (edges["precision"], "{:.3f}"), (corners["recall"], "{:.3f}"), (corners["precision"], "{:.3f}"),
                     (cost["cpu"], "{:.2f}")])
        if seed == bench.args.seeds[0]:
            bench.outlines.append(found)
            for peer, name in plane_peers.NAMES.items():
                if not plane_peers.available(peer):
                    absent.append(name)
                    continue
                result, theirs = bench.work / f"{peer}.npz", bench.work / f"{peer}-found.json"
                command = [sys.executable, plane_peers.__file__, peer, cloud, result, NOISE, agreement["spacing"]]
                runs = []
                for _ in range(plane_peers.RUNS[peer]):
                    cost = measured(command)
                    plane_peers.write_features(result, theirs)
                    runs.append((bench.compare(theirs, truth, "--cloud", cloud, *tolerances)["planes"], cost))
                planes, cost = max(runs, key=lambda run: run[0]["all"]["by_area"])
                nothing = [(None, "{}")] * 4
                peers.append([f"{name}, seed {seed}", *plane_cells(planes), *nothing, (cost["cpu"], "{:.2f}")])
    head = ["city", "planes", "recall by area", "by count", "precision", "angle, deg", "offset", "edge recall",
            "edge precision", "corner recall", "corner precision", "CPU s"]
    seed_table(f"City, {bench.args.points} points", head, rows, peers)
    for name in absent:
        print(f"\n{name} is left out: not installed")


def airborne(bench):
    rows = []
    for seed in bench.args.seeds:
        cloud, truth = bench.sample("airborne-city", seed, bench.args.points)
        found, _, cost = bench.features(cloud, f"airborne-{seed}")
        planes = bench.compare(found, truth, "--tau", 3 * NOISE)["planes"]
        walls, roofs = planes["walls"], planes["roofs_and_ground"]
        rows.append([f"seed {seed}", (planes["found"], "{:.0f}"), (walls["by_area"], "{:.4f}"),
                     (walls["by_count"], "{:.3f}"), (roofs["by_area"], "{:.4f}"), (roofs["by_count"], "{:.3f}"),
                     (planes["precision"], "{:.3f}"), (planes["orientation"], "{:.3f}"), (cost["cpu"], "{:.2f}")])
        if seed == bench.args.seeds[0]:
            bench.outlines.append(found)
    head = ["airborne city", "planes", "walls by area", "by count", "roofs, ground by area", "by count", "precision",
            "right side", "CPU s"]
    seed_table(f"Airborne city, {bench.args.points} points, all of the truth", head, rows)


def welded(vertices, triangles):
    """The same mesh with one vertex for corners that differ by rounding alone: else its creases are taken for seams."""
    grid = SAME_PLACE * np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0))
    _, first, place = np.unique(np.round(vertices / grid), axis=0, return_index=True, return_inverse=True)
    return vertices[first], place.reshape(-1)[triangles]


def creases(vertices, triangles):
    """Segments of the sharp edges of a closed mesh, and whether both their sides are flat."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    area = 0.5 * np.linalg.norm(normals, axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    pairs = np.flatnonzero((ends[order][1:] == ends[order][:-1]).all(axis=1))
    first, second = owner[order[pairs]], owner[order[pairs + 1]]
    angle = np.arccos(np.clip((normals[first] * normals[second]).sum(axis=1), -1.0, 1.0))

    # Flat faces: triangles joined to a seed that they are parallel to; the largest triangles are the first seeds.
    beside = [[] for _ in triangles]
    for i, j in zip(first, second):
        beside[i].append(j)
        beside[j].append(i)
    least, large, taken = np.cos(SAME_FACE), np.zeros(len(triangles), bool), np.zeros(len(triangles), bool)
    for seed in np.argsort(-area, kind="stable"):
        if taken[seed]:
            continue
        taken[seed] = True
        face = [seed]
        for i in face:
            for j in beside[i]:
                if not taken[j] and normals[j] @ normals[seed] >= least:
                    taken[j] = True
                    face.append(j)
        large[face] = area[face].sum() >= FLAT_SIDE
    sharp = angle >= SHARP
    return vertices[ends[order[pairs[sharp]]]], large[first[sharp]] & large[second[sharp]]


def spread(segments):
    """Positions at equal steps along segments, and the segment of each."""
    counts = np.maximum(1, np.ceil(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1) / STEP)).astype(int)
    of = np.repeat(np.arange(len(segments)), counts)
    along = (np.arange(len(of)) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) / counts[of]
    return segments[of, 0] + along[:, None] * (segments[of, 1] - segments[of, 0]), of


def bodies(bench):
    rows, skipped = [], []
    for name in BODIES:
        path = Path(bench.args.data) / name
        if not path.exists():
            skipped.append(name)
            continue
        vertices, triangles = welded(*read(path))
        vertices = scaled(vertices)
        cloud, truth, _ = body(bench, path.stem, vertices, triangles)
        found, _, cost = bench.features(cloud, path.stem)
        edges = bench.compare(found, truth, "--edge-tolerance", BODY_TOLERANCE)["edges"]
        lines = [np.array(edge["polyline"]) for edge in json.loads(found.read_text())["edges"]]
        segments = np.concatenate([np.stack([l[:-1], l[1:]], axis=1) for l in lines]) if lines else np.zeros((0, 2, 3))
        true, straight = creases(vertices, triangles)
        on_true, of = spread(true)
        if len(segments):
            seen = cKDTree(spread(segments)[0]).query(on_true)[0] <= BODY_TOLERANCE
        else:
            seen = np.zeros(len(on_true), bool)
        lengths = np.linalg.norm(true[:, 1] - true[:, 0], axis=1)
        parts = [(seen[chosen].mean() if chosen.any() else None) for chosen in (straight[of], ~straight[of])]
        rows.append([path.stem, (edges["true_length"], "{:.2f}"), (lengths[~straight].sum() / lengths.sum(), "{:.2f}"),
                     (edges["recall"], "{:.3f}"), *[(p, "{:.3f}") for p in parts], (edges["precision"], "{:.3f}"),
                     (edges["kind"], "{:.3f}"), (cost["cpu"], "{:.2f}")])
    head = ["body", "true length", "curved share", "crease recall", "straight", "curved", "precision", "kind right",
            "CPU s"]
    print(f"\n## Creases of bodies, {BODY_POINTS} points, within {BODY_TOLERANCE}\n")
    print(table([head] + [[row[0], *[shown(*cell) for cell in row[1:]]] for row in rows]), flush=True)
    for name in skipped:
        print(f"\n{name} is skipped: no such file in the data folder")


def body(bench, stem, vertices, triangles, noise=NOISE, seed=0):
    """The files of a cloud and its truth, and the triangle of each point."""
    cloud, truth = (bench.work / f"{stem}{end}" for end in (".xyz", "-truth.off"))
    rng = np.random.default_rng(seed)
    points, chosen = sampled_with_triangles(vertices, triangles, BODY_POINTS, noise, rng)
    np.savetxt(cloud, points, fmt="%.9g")
    write_off(truth, vertices, triangles)
    return cloud, truth, chosen


def strong_noise(bench):
    rows, skipped = [], []
    for name in BODIES:
        path = Path(bench.args.data) / name
        if not path.exists():
            skipped.append(name)
            continue
        vertices, triangles = welded(*read(path))
        vertices = scaled(vertices)
        faces = Faces(vertices, triangles)
        for seed in bench.args.seeds:
            cloud, truth, chosen = body(bench, path.stem, vertices, triangles, STRONG_NOISE, seed)
            found, points, cost = bench.features(cloud, path.stem)
            tolerances = ["--edge-tolerance", 2 * STRONG_NOISE, "--corner-tolerance", 3 * STRONG_NOISE]
            agreement = bench.compare(found, truth, *tolerances)
            edges, corners = agreement["edges"], agreement["corners"]
            labelled = read_points(points)
            positions = np.stack([labelled[a] for a in "xyz"], axis=1)
            planes = json.loads(found.read_text())["planes"]
            normals = np.array([p["normal"] for p in planes]).reshape(-1, 3)
            offsets = np.array([p["offset"] for p in planes])
            judged = faces.judged(positions, chosen, labelled["plane"], normals, offsets)
            rows.append([f"{path.stem}, seed {seed}", (judged["faces"], "{}"), (judged["recall"], "{:.3f}"),
                         (judged["precision"], "{:.3f}"), (judged["angle"], "{:.2f}"), (judged["least_angle"], "{:.2f}"),
                         (judged["shift"], "{:.5f}"), (edges["recall"], "{:.3f}"), (edges["precision"], "{:.3f}"),
                         (corners["recall"], "{:.3f}"), (corners["precision"], "{:.3f}"), (cost["cpu"], "{:.2f}")])
    head = ["body", "faces", "face recall", "precision", "angle, deg", "least squares", "offset", "edge recall",
            "edge precision", "corner recall", "corner precision", "CPU s"]
    print(f"\n## Bodies with noise of {STRONG_NOISE}, {BODY_POINTS} points\n")
    print(table([head] + [[row[0], *[shown(*cell) for cell in row[1:]]] for row in rows]), flush=True)
    for name in skipped:
        print(f"\n{name} is skipped: no such file in the data folder")


def smooth(bench):
    clouds = [(kind, bench.sample(kind, 0, BODY_POINTS)[0]) for kind in ("sphere", "torus")]
    path = Path(bench.args.data) / "fertility.off"
    if path.exists():
        vertices, triangles = read(path)
        clouds.append(("fertility", body(bench, "fertility", scaled(vertices), triangles)[0]))
    rows = [["smooth body", "planes", "share of points on planes", "edges", "length of edges", "CPU s"]]
    for name, cloud in clouds:
        found, points, cost = bench.features(cloud, name)
        content = json.loads(found.read_text())
        share = (read_points(points)["plane"] >= 0).mean()
        edges = content["edges"]
        rows.append([name, str(len(content["planes"])), f"{share:.4f}", str(len(edges)),
                     f"{sum(e['length'] for e in edges):.3f}", f"{cost['cpu']:.2f}"])
    print(f"\n## Smooth bodies, {BODY_POINTS} points\n")
    print(table(rows), flush=True)
    if not path.exists():
        print("\nfertility.off is skipped: no such file in the data folder")


def level_parts(positions, neighbours=16):
    """|n_z| of the plane of least squares through the nearest neighbours of each point."""
    tree = cKDTree(positions)
    up = np.empty(len(positions))
    for start in range(0, len(positions), 1 << 16):
        chunk = slice(start, start + (1 << 16))
        near = positions[tree.query(positions[chunk], neighbours)[1]]
        near = near - near.mean(axis=1, keepdims=True)
        up[chunk] = np.abs(np.linalg.eigh(np.einsum("nki,nkj->nij", near, near))[1][:, 2, 0])
    return up


def off_roofs(others, roofs):
    """Whether a point has no roof within 2 m in plan, or is over 0.5 m above the highest point there."""
    near = cKDTree(roofs[:, :2]).query_ball_point(others[:, :2], 2.0)
    return np.array([not n or height > roofs[n, 2].max() + 0.5 for n, height in zip(near, others[:, 2])])


def delft(bench):
    tile = Path(bench.args.data) / TILE
    if not tile.exists():
        print(f"\n{TILE} is skipped: no such file in the data folder")
        return
    rows = [["Delft", "points", "CPU s", "wall s", "peak, MB", "planes", "edges", "corners", "roof points on planes",
             "class 6 on planes", "class 1 off roofs on planes"]]
    for name, options in (("all classes", []), ("--classes 1,6", ["--classes", "1,6"])):
        found, path, cost = bench.features(tile, "delft" + "-".join(options), *options)
        bench.outlines.append(found)
        content, points = json.loads(found.read_text()), read_points(path)
        positions = np.stack([points[a] for a in "xyz"], axis=1)
        plane, kind = points["plane"], points["classification"]
        normals = np.array([p["normal"] for p in content["planes"]])
        offsets = np.array([p["offset"] for p in content["planes"]])
        on = plane >= 0
        distance = np.full(len(points), np.inf)
        distance[on] = np.abs((positions[on] * normals[plane[on]]).sum(axis=1) - offsets[plane[on]])
        close = distance <= 0.1
        building, other = positions[kind == 6], positions[kind == 1]
        roof = level_parts(building) > 0.3
        rows.append([name, f"{len(points):,}", f"{cost['cpu']:.1f}", f"{cost['wall']:.1f}", f"{cost['peak'] / 1e6:.0f}",
                     *[str(len(content[k])) for k in ("planes", "edges", "corners")],
                     f"{close[kind == 6][roof].mean():.4f}", f"{close[kind == 6].mean():.4f}",
                     f"{on[kind == 1][off_roofs(other, building)].mean():.4f}"])
    print("\n## Delft, AHN3\n")
    print(table(rows), flush=True)


def outlines(bench):
    if not bench.outlines:
        print("\nNo outlines to look at: `polygons` needs city, airborne or delft, too")
        return
    results = [polygons.checked(path) for path in bench.outlines]
    print("\n## Outlines\n")
    print(table([polygons.HEAD] + [row for row, _ in results]), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    parser.add_argument("--data", metavar="DIR", default=ROOT.parent / "shared" / "data", help="folder of the truths")
    parser.add_argument("--points", type=int, default=100_000, help="points of a city [default: 100000]")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2, 3, 4])
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    args = parser.parse_args()
    parts = dict(zip(PARTS, (city, airborne, bodies, strong_noise, smooth, delft, outlines)))
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(args.work or temporary)
        work.mkdir(parents=True, exist_ok=True)
        bench = Bench(args, work)
        for name in PARTS:
            if name in args.only:
                parts[name](bench)


if __name__ == "__main__":
    main()
