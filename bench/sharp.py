"""How exact and how sharp the meshes of `zeroset reconstruct` are where the truth is known, and what that costs.

Parts, chosen by --only; all by default. CPU is seconds of the processor, user and system, of the whole command with
reading and writing. Meshes are held against the truth by `zeroset compare`.

city: `zeroset sample city`, 100,000 points with noise of 0.001, cell of 0.0047, at each quality.
city-1m: the same with 1,000,000 points and half the cell.
airborne: `zeroset sample airborne-city`, walls with 3 % of the density.
objects: bodies scaled to a diagonal of 1 with 60,000 points spread evenly by area and noise of 0.002, cell as of
    PoissonRecon at depth 7 with its usual margin: the longest side of the box over 116. Beside them Open3D's path:
    normals over 30 neighbours, oriented over tangent planes, screened Poisson at depth 7.
faces: the flat faces of block and featuretype. A triangle of the mesh belongs to the face of the truth that is nearest
    to its middle, if it turns less than 45 degrees from it. Given are the worst angle between the mean normal and the
    truth's, and the worst root mean square distance from the plane of least squares.
smooth: a sphere and fertility. A false crease is a connected set of edges of over 10 degrees, none of whose middles
    is within 2 cells of an edge of the truth of over 10 degrees; its length is the largest extent of its box.
simplify: the city and the airborne city with an error of at most the noise.
delft: draft and normal at 0.5 m, in one run.

    python bench/sharp.py
    python bench/sharp.py --only city objects --quality normal
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import igl
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from common import ROOT, add_common, binary, measured, output_json, table
from faces import Faces, angle
from objects import read, sampled, scaled, write_off

PARTS = ("city", "city-1m", "airborne", "objects", "faces", "smooth", "simplify", "delft")
CITY_CELL, CITY_NOISE, CITY_TAU, CITY_BAND = 0.0047, 0.001, 0.002, 0.01
BODIES = ("fandisk.obj", "featuretype.stl", "block.obj", "anchor.off", "fertility.off")
BODY_POINTS, BODY_NOISE, BODY_TAU, BODY_BAND, BODY_CELLS = 60_000, 0.002, 0.002, 0.01, 116
FACED = ("block.obj", "featuretype.stl")
SAME_FACE = np.cos(np.radians(45.0))
LEAST_FACE = 20  # cells
FALSE_CREASE = np.radians(10.0)
SPHERE_RADIUS = 0.5 / np.sqrt(3.0)  # the diagonal of its box is 1
TILE, TILE_CELL = "delft_ahn3.laz", 0.5
HEAD = ["", "mean", "95 %", "F", "normals", "near edges", "crease", "components", "boundary loops", "non-manifold",
        "self-intersections", "triangles", "CPU s", "wall s", "GB"]


class Bench:
    def __init__(self, args, work):
        self.args, self.work, self.zeroset = args, work, binary(args.zeroset)
        self.bodies = {}

    def sample(self, kind, points):
        cloud, truth = (self.work / f"{kind}-{points}{end}" for end in (".ply", "-truth.ply"))
        measured([self.zeroset, "sample", kind, "-o", cloud, "--truth", truth, "--points", points, "--noise", CITY_NOISE])
        return cloud, truth

    def body(self, name):
        """The cloud, the file of the truth, its mesh and the cell of a body; `None` without its file."""
        if name not in self.bodies:
            if name == "sphere":
                vertices, triangles = sphere()
            else:
                path = Path(self.args.data) / name
                if not path.exists():
                    print(f"{name} is skipped: no such file in the data folder")
                    return None
                vertices, triangles = read(path)
                vertices = scaled(vertices)
            points = sampled(vertices, triangles, BODY_POINTS, BODY_NOISE, np.random.default_rng(0))
            cloud, truth = (self.work / f"{Path(name).stem}{end}" for end in (".xyz", "-truth.off"))
            np.savetxt(cloud, points, fmt="%.9g")
            write_off(truth, vertices, triangles)
            cell = (points.max(axis=0) - points.min(axis=0)).max() / BODY_CELLS
            self.bodies[name] = cloud, truth, (vertices, triangles), cell
        return self.bodies[name]

    def reconstruct(self, cloud, mesh, quality, *options):
        return measured([self.zeroset, "reconstruct", cloud, "-o", mesh, "--quality", quality, "--quiet", *options])

    def row(self, name, mesh, truth, cost, tau, band):
        found = output_json([self.zeroset, "compare", mesh, truth, "--tau", tau, "--edge-band", band, "--json"])
        whole, edges, ours = found["overall"], found["near_edges"], found["mesh"]
        distances = whole["distances"]["combined"]
        return [name, f"{distances['mean']:.6f}", f"{distances['p95']:.5f}", f"{whole['f_score']:.4f}",
                f"{whole['normal_consistency']:.4f}", f"{edges['normal_consistency']:.3f}" if edges else "-",
                f"{found['crease_distance']['mean']:.5f}" if found["crease_distance"] else "-",
                str(len(ours["components"])), str(ours["boundary_loops"]),
                str(ours["nonmanifold_edges"] + ours["nonmanifold_vertices"]),
                str(found["mesh_self_intersections"]["pairs"]), f"{ours['faces']:,}", f"{cost['cpu']:.1f}",
                f"{cost['wall']:.1f}", f"{cost['peak'] / 1e9:.2f}"]

    def scene(self, kind, points, cell, title):
        cloud, truth = self.sample(kind, points)
        rows = [HEAD]
        for quality in self.args.quality:
            mesh = self.work / f"{cloud.stem}-{quality}.ply"
            cost = self.reconstruct(cloud, mesh, quality, "--resolution", cell)
            rows.append(self.row(quality, mesh, truth, cost, CITY_TAU, CITY_BAND))
        show(title, rows)

    def objects(self, names):
        rows = [HEAD]
        for name in names:
            if not (body := self.body(name)):
                continue
            cloud, truth, _, cell = body
            for quality in self.args.quality:
                mesh = self.mesh_of(name, quality)
                cost = self.reconstruct(cloud, mesh, quality, "--scene", "object", "--resolution", cell)
                rows.append(self.row(f"{name}, {quality}", mesh, truth, cost, BODY_TAU, BODY_BAND))
            if self.args.peers:
                mesh = self.work / f"{Path(name).stem}-open3d.ply"
                cost = measured([sys.executable, __file__, "--open3d", cloud, mesh])
                rows.append(self.row(f"{name}, Open3D", mesh, truth, cost, BODY_TAU, BODY_BAND))
        show("objects", rows)

    def mesh_of(self, name, quality):
        return self.work / f"{Path(name).stem}-{quality}.off"

    def faces(self):
        rows = [["body", "faces", "worst angle of a mean normal", "their mean", "worst rms over the noise", "their mean"]]
        for name in FACED:
            if not (body := self.body(name)):
                continue
            cloud, _, (vertices, triangles), cell = body
            for quality in self.args.quality:
                mesh = self.mesh_of(name, quality)
                self.reconstruct(cloud, mesh, quality, "--scene", "object", "--resolution", cell)
                angles, rms = flatness(read(mesh), (vertices, triangles), cell)
                rows.append([f"{name}, {quality}", str(len(angles)), f"{max(angles):.2f}", f"{np.mean(angles):.2f}",
                             f"{max(rms) / BODY_NOISE:.3f}", f"{np.mean(rms) / BODY_NOISE:.3f}"])
        show("flat faces", rows)

    def smooth(self):
        rows = [["body", "longest false crease, in cells", "those over 3 cells"]]
        for name in ("sphere", "fertility.off"):
            if not (body := self.body(name)):
                continue
            cloud, _, truth, cell = body
            for quality in self.args.quality:
                mesh = self.mesh_of(name, quality)
                self.reconstruct(cloud, mesh, quality, "--scene", "object", "--resolution", cell)
                lengths = false_creases(read(mesh), truth, cell)
                rows.append([f"{name}, {quality}", f"{max(lengths, default=0.0):.1f}", str(sum(l > 3 for l in lengths))])
        show("false creases", rows)

    def simplify(self):
        rows = [HEAD]
        for kind in ("city", "airborne-city"):
            cloud, truth = self.sample(kind, 100_000)
            mesh = self.work / f"{kind}-light.ply"
            cost = self.reconstruct(cloud, mesh, "normal", "--resolution", CITY_CELL, "--max-error", CITY_NOISE)
            rows.append(self.row(kind, mesh, truth, cost, CITY_TAU, CITY_BAND))
        show(f"simplified, error at most {CITY_NOISE}", rows)

    def delft(self):
        cloud = Path(self.args.data) / TILE
        if not cloud.exists():
            print(f"{TILE} is skipped: no such file in the data folder")
            return
        rows = [["", "CPU s", "wall s", "GB", "stages"]]
        for quality in self.args.quality:
            report = self.work / f"delft-{quality}.json"
            cost = self.reconstruct(cloud, self.work / f"delft-{quality}.ply", quality, "--resolution", TILE_CELL,
                                    "--report", report)
            stages = json.loads(report.read_text())["seconds"]
            rows.append([quality, f"{cost['cpu']:.1f}", f"{cost['wall']:.1f}", f"{cost['peak'] / 1e9:.2f}",
                         ", ".join(f"{k} {v:.1f}" for k, v in stages.items() if v >= 0.05)])
        show("delft", rows)


def sphere():
    """A sphere of 80 * 4^5 triangles."""
    vertices, triangles = igl.icosahedron() if hasattr(igl, "icosahedron") else icosahedron()
    for _ in range(6):
        vertices, triangles = igl.upsample(vertices, triangles)
        vertices = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    return SPHERE_RADIUS * vertices, triangles


def icosahedron():
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = [(0.0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array([np.roll(c, k) for k in range(3) for c in corners])
    distance = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    beside = (distance > 0.1) & (distance < 2.1)
    triangles = []
    for i in range(12):
        for j in np.flatnonzero(beside[i]):
            for k in np.flatnonzero(beside[i] & beside[j]):
                outward = np.linalg.det(vertices[[i, j, k]]) > 0
                if i < j and i < k and outward:
                    triangles.append((i, j, k))
    return vertices / np.linalg.norm(vertices[0]), np.array(triangles)


def crosses(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def flatness(mesh, truth, cell):
    """For each large flat face of the truth: the angle of its mean normal in degrees, and its flatness."""
    vertices, triangles = mesh
    faces = Faces(*truth)
    middles = vertices[triangles].mean(axis=1)
    nearest = np.asarray(igl.point_mesh_squared_distance(middles, *truth)[1]).ravel()
    cross = crosses(vertices, triangles)
    areas = np.linalg.norm(cross, axis=1)
    of = faces.of[nearest]
    along = np.einsum("ij,ij->i", cross, faces.normals[of]) > SAME_FACE * areas
    angles, rms = [], []
    for f in np.flatnonzero((faces.sizes >= LEAST_FACE * cell**2) & ~faces.is_optional):
        own = np.flatnonzero((of == f) & along)
        if not len(own):
            angles.append(90.0)
            rms.append(np.inf)
            continue
        angles.append(angle(cross[own].sum(axis=0) / np.linalg.norm(cross[own].sum(axis=0)), faces.normals[f]))
        weights = areas[own] / areas[own].sum()
        steps = middles[own] - weights @ middles[own]
        rms.append(np.sqrt(max(0.0, np.linalg.eigvalsh((steps * weights[:, None]).T @ steps)[0])))
    return angles, rms


def creased_edges(vertices, triangles):
    """The edges that turn by more than a false crease does: their ends."""
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    pairs = np.flatnonzero((ends[order][1:] == ends[order][:-1]).all(axis=1))
    cross = crosses(vertices, triangles)
    normals = cross / np.maximum(np.linalg.norm(cross, axis=1), 1e-300)[:, None]
    one, other = normals[order[pairs] // 3], normals[order[pairs + 1] // 3]
    turn = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), np.einsum("ij,ij->i", one, other))
    return ends[order[pairs]][turn > FALSE_CREASE]


def false_creases(mesh, truth, cell):
    """The lengths of connected creases that the truth has not, in cells."""
    edges, true_edges = creased_edges(*mesh), creased_edges(*truth)
    if len(true_edges):
        a, b = truth[0][true_edges[:, 0]], truth[0][true_edges[:, 1]]
        steps = np.linspace(0.0, 1.0, 17)[:, None, None]
        tree = cKDTree(((1 - steps) * a + steps * b).reshape(-1, 3))
        distance = tree.query(mesh[0][edges].mean(axis=1))[0]
        edges = edges[distance > 2 * cell]
    if not len(edges):
        return []
    count = len(mesh[0])
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    lengths = []
    order = np.argsort(label[edges[:, 0]], kind="stable")
    for own in np.split(edges[order], np.flatnonzero(np.diff(label[edges[order][:, 0]])) + 1):
        corners = mesh[0][own.ravel()]
        lengths.append((corners.max(axis=0) - corners.min(axis=0)).max() / cell)
    return lengths


def open3d_path(cloud, mesh):
    """The child process: Open3D from the cloud's file to the mesh's file."""
    import open3d

    points = open3d.io.read_point_cloud(cloud)
    points.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(30))
    points.orient_normals_consistent_tangent_plane(30)
    surface, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(points, depth=7)
    if surface.get_volume() < 0 if surface.is_watertight() else False:
        surface.triangles = open3d.utility.Vector3iVector(np.asarray(surface.triangles)[:, ::-1])
    open3d.io.write_triangle_mesh(mesh, surface)


def show(title, rows):
    print(f"## {title}\n{table(rows)}\n", flush=True)


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "--open3d":
        return open3d_path(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    parser.add_argument("--data", metavar="DIR", default=ROOT.parent / "shared" / "data", help="folder of the truths")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--quality", nargs="+", choices=("draft", "normal", "fine"), default=("draft", "normal"))
    parser.add_argument("--no-peers", dest="peers", action="store_false", help="leave Open3D out")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(args.work or temporary)
        work.mkdir(parents=True, exist_ok=True)
        bench = Bench(args, work)
        if "city" in args.only:
            bench.scene("city", 100_000, CITY_CELL, "city, 100 k points")
        if "city-1m" in args.only:
            bench.scene("city", 1_000_000, CITY_CELL / 2, "city, 1 M points")
        if "airborne" in args.only:
            bench.scene("airborne-city", 100_000, CITY_CELL, "airborne city, 100 k points")
        if "objects" in args.only:
            bench.objects((*BODIES, "sphere"))
        for part in ("faces", "smooth", "simplify", "delft"):
            if part in args.only:
                getattr(bench, part)()


if __name__ == "__main__":
    main()
