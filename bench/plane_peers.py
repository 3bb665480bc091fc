"""Plane detection by other libraries, each in a child process of its own, written as JSON of `zeroset features`.

    python bench/plane_peers.py open3d|ransac|growing CLOUD RESULT.npz NOISE SPACING

All start from the bare points and estimate normals themselves. The values below were chosen by trying a few on the
cloud that they are judged on (`sample city`, seed 0), which favours them; their cost includes the library's import.

open3d: `detect_planar_patches` with normals from 30 neighbours, patches of 20 points and more and no least length. With
    its defaults it finds 38 planes. A plane is the middle of the box that it returns; its polygon is the rectangle.
ransac, growing: CGAL's Efficient RANSAC and region growing with normals from 20 neighbours, planes of 50 points and
    more within 3 times the noise, gaps of 2 spacings, and 25.8 degrees (its default) between normals. A plane is
    fitted to its points again by least squares, which CGAL itself does not do; its polygon is their convex hull.

RANSAC is random, and 9 of 12 runs stopped after the ground. So it runs several times, the run with the best recall is
taken, and the cost is that of this run alone. Region growing trades recall for precision: over 12 choices of values,
recall by area went from 0.975 to 0.999 and precision from 0.79 to 0.33; this one lies between.
"""

import importlib.util
import json
import sys

import numpy as np

NEIGHBOURS = {"open3d": 30, "ransac": 20, "growing": 20}
LEAST_POINTS = {"open3d": 20, "ransac": 50, "growing": 50}
RUNS = {"open3d": 1, "ransac": 12, "growing": 1}
DISTANCE = 3.0  # over the noise
GAP = 2.0  # over the spacing
COSINE = 0.9
NAMES = {
    "open3d": "Open3D `detect_planar_patches`",
    "ransac": "CGAL Efficient RANSAC, refitted, best of 12 runs",
    "growing": "CGAL region growing, refitted",
}
MODULES = {"open3d": "open3d", "ransac": "CGAL", "growing": "CGAL"}


def available(peer):
    return importlib.util.find_spec(MODULES[peer]) is not None


def open3d_child(cloud, result):
    import open3d

    points = open3d.io.read_point_cloud(cloud)
    search = open3d.geometry.KDTreeSearchParamKNN(NEIGHBOURS["open3d"])
    points.estimate_normals(search)
    boxes = points.detect_planar_patches(min_num_points=LEAST_POINTS["open3d"], min_plane_edge_length=1e-9,
                                         search_param=search)
    np.savez(result, kind="boxes", center=[b.center for b in boxes], axes=[b.R for b in boxes],
             extent=[b.extent for b in boxes])


def cgal_child(method, cloud, result, noise, spacing):
    from CGAL.CGAL_Point_set_3 import Point_set_3
    from CGAL.CGAL_Point_set_processing_3 import pca_estimate_normals
    from CGAL.CGAL_Shape_detection import efficient_RANSAC, region_growing

    points = Point_set_3(cloud)
    pca_estimate_normals(points, NEIGHBOURS[method])
    plane_of = points.add_int_map("plane")
    detect = efficient_RANSAC if method == "ransac" else region_growing
    detect(points, plane_of, LEAST_POINTS[method], DISTANCE * noise, GAP * spacing, COSINE)
    labels = np.array([plane_of.get(i) for i in points.indices()])
    positions = np.array([[p.x(), p.y(), p.z()] for p in points.points()])
    np.savez(result, kind="labels", labels=labels, positions=positions)


def hull(flat):
    """Corners of the convex hull of points in the plane, counter-clockwise."""
    def chain(ordered):
        kept = []
        for p in ordered:
            while len(kept) > 1:
                (ax, ay), (bx, by) = kept[-1] - kept[-2], p - kept[-2]
                if ax * by - ay * bx > 0:
                    break
                kept.pop()
            kept.append(p)
        return kept[:-1]

    ordered = flat[np.lexsort((flat[:, 1], flat[:, 0]))]
    return np.array(chain(ordered) + chain(ordered[::-1]))


def planes(result):
    """Normal, middle, polygon and number of points of each plane."""
    found = np.load(result)
    if str(found["kind"]) == "boxes":
        for center, axes, extent in zip(found["center"], found["axes"], found["extent"]):
            u, v, normal = axes.T
            u, v = 0.5 * extent[0] * u, 0.5 * extent[1] * v
            yield normal, center, center + np.array([-u - v, u - v, u + v, v - u]), 0
        return
    labels, positions = found["labels"], found["positions"]
    for label in range(int(labels.max()) + 1):
        points = positions[labels == label]
        if len(points) < 3:
            continue
        center = points.mean(axis=0)
        axes = np.linalg.svd(points - center, full_matrices=False)[2]
        polygon = center + hull((points - center) @ axes[:2].T) @ axes[:2]
        yield axes[2], center, polygon, len(points)


def write_features(result, path):
    """What a child found, as a file that `zeroset compare --features` reads."""
    records = []
    for normal, center, polygon, points in planes(result):
        normal = normal / np.linalg.norm(normal)
        around = np.roll(polygon, -1, axis=0)
        area = 0.5 * abs(np.cross(polygon - center, around - center).sum(axis=0) @ normal)
        records.append({"id": len(records), "normal": normal.tolist(), "offset": float(normal @ center),
                        "oriented": False, "area": float(area), "points": points, "rms": None,
                        "polygon": [polygon.tolist()]})
    with open(path, "w") as out:
        json.dump({"schema_version": 1, "zeroset_version": "", "crs": None, "unit": None, "planes": records,
                   "edges": [], "corners": []}, out)


if __name__ == "__main__":
    peer, cloud, result, noise, spacing = sys.argv[1:]
    if peer == "open3d":
        open3d_child(cloud, result)
    else:
        cgal_child(peer, cloud, result, float(noise), float(spacing))
