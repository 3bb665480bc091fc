"""Renders the pictures of this folder from the files of the README's commands.

    python3 pictures.py delft points.ply found.json delft.jpg delft-gables.jpg
    python3 pictures.py city points.ply found.json airborne-city.jpg
    python3 pictures.py body points.ply found.json fandisk.jpg

Needs matplotlib, numpy, Pillow, pyvista, scipy and shapely; for the last two a display, too: without one, `xvfb-run
-a python3 ...`.
"""

import json
import sys

import numpy as np
from PIL import Image, ImageChops

OVERSAMPLING = 2
NUMPY_TYPES = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}
UPRIGHT = 0.1736  # |n_z| of walls: within 10 degrees
LOOSE = (0.80, 0.80, 0.79)
CONVEX, CONCAVE, UNKNOWN, WALL = "#d62718", "#1763c9", "#666666", "#26262c"
BODY_VIEW = (-1.1, 0.9, -0.75)
BOX = (84876, 447480, 80)  # west, south and side of the detail


def read_points(path):
    """The vertices of a binary PLY file of zeroset as a record array."""
    with open(path, "rb") as file:
        count, fields = 0, []
        while (line := file.readline().decode()) != "end_header\n":
            words = line.split()
            if words[0] == "element":
                count = int(words[2])
            elif words[0] == "property":
                fields.append((words[2], NUMPY_TYPES[words[1]]))
        return np.fromfile(file, fields, count)


def load(points, found):
    points = read_points(points)
    with open(found) as file:
        return np.stack([points[a] for a in "xyz"], axis=1), points["plane"], json.load(file)


def palette(features, plane):
    """A colour for each plane and, last, for points on none: muted, so that edges stand out."""
    from matplotlib.colors import hsv_to_rgb

    count = len(features["planes"])
    rng = np.random.default_rng(7)
    # Golden steps keep planes of like size, mostly neighbours, far apart in hue.
    hue = (np.arange(count) * 0.618034) % 1.0
    colors = hsv_to_rgb(np.stack([hue, rng.uniform(0.18, 0.34, count), rng.uniform(0.86, 0.97, count)], axis=1))
    return np.vstack([colors, LOOSE])[plane]


def edge_color(edge):
    return {"convex": CONVEX, "concave": CONCAVE}.get(edge["kind"], UNKNOWN)


def upright(plane):
    return abs(plane["normal"][2]) < UPRIGHT


def map_from_above(positions, colors, features, box, size, target):
    """Points by plane, edges, and walls as lines in plan."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import LineCollection

    west, south, east, north = box
    meter = 72.0 * size / (east - west)  # typographic points
    figure = plt.figure(figsize=(size, size * (north - south) / (east - west)), facecolor="white")
    axes = figure.add_axes([0, 0, 1, 1])
    axes.set_axis_off()
    order = np.argsort(positions[:, 2], kind="stable")
    order = order[((positions[order, :2] > [west, south]) & (positions[order, :2] < [east, north])).all(axis=1)]
    axes.scatter(*positions[order, :2].T, s=(0.42 * meter) ** 2, c=colors[order], linewidths=0)
    walls = [np.array(ring)[:, :2] for plane in features["planes"] if upright(plane) for ring in plane["polygon"]]
    ends = []
    for ring in walls:
        along = (ring - ring.mean(axis=0)) @ np.linalg.svd(ring - ring.mean(axis=0), full_matrices=False)[2][0]
        ends.append(ring[[along.argmin(), along.argmax()]])
    axes.add_collection(LineCollection(ends, colors=WALL, linewidths=0.32 * meter, capstyle="round"))
    lines = [np.array(edge["polyline"])[:, :2] for edge in features["edges"]]
    shown = [edge_color(edge) for edge in features["edges"]]
    axes.add_collection(LineCollection(lines, colors=shown, linewidths=0.2 * meter, capstyle="round"))
    axes.set_xlim(west, east)
    axes.set_ylim(south, north)
    figure.canvas.draw()
    figure.savefig(target, dpi=100, pil_kwargs={"quality": 80, "optimize": True})
    plt.close(figure)


def delft(points, found, whole, detail):
    positions, plane, features = load(points, found)
    colors = palette(features, plane)
    low, high = positions[:, :2].min(axis=0), positions[:, :2].max(axis=0)
    map_from_above(positions, colors, features, (*low, *high), 12.5, whole)
    west, south, side = BOX
    map_from_above(positions, colors, features, (west, south, west + side, south + side), 10, detail)


def plotter_of(width, height):
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=[OVERSAMPLING * width, OVERSAMPLING * height])
    plotter.set_background("white")
    return plotter


def add_edges(plotter, features, radius):
    import pyvista

    for kind in (CONVEX, CONCAVE, UNKNOWN):
        lines = [np.array(e["polyline"]) for e in features["edges"] if edge_color(e) == kind]
        if lines:
            tubes = pyvista.MultiBlock([pyvista.lines_from_points(line) for line in lines]).combine()
            tubes = tubes.extract_surface(algorithm=None).tube(radius=radius)
            plotter.add_mesh(tubes, color=kind, ambient=0.5, diffuse=0.6)


def save(plotter, width, height, target, margin=None):
    """Writes the picture; with a margin, cut to what is not white."""
    picture = Image.fromarray(plotter.screenshot(None, return_img=True))
    if margin is not None:
        left, top, right, bottom = ImageChops.invert(picture.convert("L")).getbbox()
        gap = OVERSAMPLING * margin
        picture = picture.crop((left - gap, top - gap, right + gap, bottom + gap))
        height = round(width * picture.height / picture.width)
    picture.resize((width, height), Image.LANCZOS).save(target, quality=86, optimize=True)


def triangles_of(plane):
    """The polygon of a plane, cut into triangles: positions of their corners, three by three."""
    import shapely

    normal = np.array(plane["normal"])
    rings = [np.array(ring) for ring in plane["polygon"]]
    origin = rings[0][0]
    u = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    u /= np.linalg.norm(u)
    axes = np.array([u, np.cross(normal, u)])
    shape = shapely.Polygon()
    for ring in rings:
        # Holes are rings within rings.
        shape = shape.symmetric_difference(shapely.make_valid(shapely.Polygon((ring - origin) @ axes.T)))
    pieces = shapely.constrained_delaunay_triangles(shape).geoms
    return [origin + shapely.get_coordinates(piece)[:3] @ axes for piece in pieces]


def add_planes(plotter, planes, **looks):
    import pyvista

    corners = [triangle for plane in planes for triangle in triangles_of(plane)]
    faces = np.insert(np.arange(3 * len(corners)).reshape(-1, 3), 0, 3, axis=1)
    plotter.add_mesh(pyvista.PolyData(np.concatenate(corners), faces), **looks)


def city(points, found, target):
    import pyvista

    width, height = 1400, 840
    positions, plane, features = load(points, found)
    colors = palette(features, np.arange(len(features["planes"])))
    plotter = plotter_of(width, height)
    ground = max(features["planes"], key=lambda p: p["area"])
    for number, found_plane in enumerate(features["planes"]):
        color = "#eceae4" if found_plane is ground else "#8b8e98" if upright(found_plane) else colors[number]
        add_planes(plotter, [found_plane], color=color, ambient=0.45, diffuse=0.6)
    # The points, where they lie above the planes by their noise.
    plotter.add_points(positions[positions[:, 2] > 0.005], color="#202020", point_size=2.2, lighting=False)
    plotter.add_points(positions[positions[:, 2] <= 0.005], color="#b9b4a6", point_size=1.6, lighting=False)
    add_edges(plotter, features, 0.0008)
    plotter.camera.focal_point = (0.5, 0.48, 0.02)
    plotter.camera.position = (0.5 - 0.40, 0.46 - 0.90, 0.74)
    plotter.camera.up = (0, 0, 1)
    plotter.camera.view_angle = 28
    save(plotter, width, height, target)


def splats(positions, colors, radius):
    """A hexagon across the surface at each point, so that none shines through from behind."""
    import pyvista
    from scipy.spatial import cKDTree

    near = positions[cKDTree(positions).query(positions, 24)[1]]
    near = near - near.mean(axis=1, keepdims=True)
    axes = np.linalg.eigh(np.einsum("nki,nkj->nij", near, near))[1]
    turns = np.arange(6) * np.pi / 3
    around = np.cos(turns)[:, None, None] * axes[None, :, :, 2] + np.sin(turns)[:, None, None] * axes[None, :, :, 1]
    corners = (positions[None] + radius * around).transpose(1, 0, 2).reshape(-1, 3)
    faces = np.insert(np.arange(len(corners)).reshape(-1, 6), 0, 6, axis=1)
    mesh = pyvista.PolyData(corners, faces)
    mesh.cell_data["color"] = (255 * colors).astype(np.uint8)
    return mesh


def body(points, found, target):
    import pyvista

    width, height = 1000, 900
    positions, plane, features = load(points, found)
    plotter = plotter_of(width, height)
    plotter.add_mesh(splats(positions, palette(features, plane), 0.0055), scalars="color", rgb=True, ambient=0.4,
                     diffuse=0.65, specular=0.0)
    add_edges(plotter, features, 0.003)
    if features["corners"]:
        corners = pyvista.PolyData(np.array([c["position"] for c in features["corners"]]))
        ball = pyvista.Sphere(radius=0.006)
        plotter.add_mesh(corners.glyph(geom=ball, scale=False, orient=False), color="#1c1c1c")
    middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    plotter.camera.focal_point = middle
    plotter.camera.position = middle + np.array(BODY_VIEW)
    plotter.camera.up = (0, 0, 1)
    plotter.camera.view_angle = 34
    save(plotter, width, height, target, margin=20)


if __name__ == "__main__":
    {"delft": delft, "city": city, "body": body}[sys.argv[1]](*sys.argv[2:])
