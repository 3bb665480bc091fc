"""Renders parts of two meshes side by side, each row one view.

    python3 pictures.py before.ply after.ply picture.jpg views.json

A view is `{"focus": [x, y, z], "radius": r, "from": [dx, dy, dz], "up": [x, y, z]}` in the coordinates of the meshes: what is
within the radius of the focus fills the height. Without one of the first two the whole mesh is shown.

Needs numpy, Pillow, pyvista and a display; without one, `xvfb-run -a python3 ...`.
"""

import json
import sys

import numpy as np
import pyvista as pv
from PIL import Image

WIDTH, ROW = 1600, 520
# Pixels of the picture in each direction for one of the result, against stairs at the edges.
OVERSAMPLING = 2
# What stands between the focus and the eye is cut away beyond so many radii.
DEPTH = 2.5


def read(path, origin):
    """A mesh about an origin: far from it single precision, in which pictures are drawn, is too coarse."""
    mesh = pv.read(path)
    mesh.points = (np.asarray(mesh.points, float) - origin).astype(np.float32)
    return mesh


def show(plotter, mesh, view, origin):
    center, radius = np.asarray(mesh.center), mesh.length / 2.0
    if "focus" in view:
        center, radius = np.asarray(view["focus"], float) - origin, view["radius"]
        middles = mesh.cell_centers().points
        mesh = mesh.extract_cells(np.linalg.norm(middles - center, axis=1) < DEPTH * radius).extract_surface(algorithm="dataset_surface")
    plotter.set_background("#f4f6f8", top="#dfe8ef")
    plotter.add_mesh(mesh, color="#cfd3d8", ambient=0.25, diffuse=0.8, specular=0.05)
    toward = np.asarray(view["from"], float)
    toward /= np.linalg.norm(toward)
    plotter.camera.focal_point = center
    plotter.camera.position = center + 4.0 * radius * toward
    plotter.camera.up = view.get("up", (0.0, 0.0, 1.0))
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = radius
    plotter.camera.clipping_range = (0.01 * radius, 20.0 * radius)


def main(before, after, target, views):
    with open(views) as file:
        views = json.load(file)
    origin = np.asarray(views[0].get("focus", (0.0, 0.0, 0.0)), float)
    meshes = [read(path, origin) for path in (before, after)]
    size = [OVERSAMPLING * WIDTH, OVERSAMPLING * ROW * len(views)]
    plotter = pv.Plotter(off_screen=True, shape=(len(views), 2), border=False, window_size=size)
    for row, view in enumerate(views):
        for column, mesh in enumerate(meshes):
            plotter.subplot(row, column)
            show(plotter, mesh, view, origin)
    picture = Image.fromarray(plotter.screenshot(None, return_img=True))
    picture.resize((WIDTH, ROW * len(views)), Image.LANCZOS).save(target, quality=86, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
