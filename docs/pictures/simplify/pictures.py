"""Renders two meshes side by side with their edges.

    python3 pictures.py before.ply after.ply picture.jpg

Needs numpy, Pillow, pyvista and a display; without one, `xvfb-run -a python3 ...`.
"""

import sys

import pyvista as pv
from PIL import Image

WIDTH, HEIGHT = 1600, 760
# Pixels of the picture in each direction for one of the result, against stairs at the edges.
OVERSAMPLING = 2
VIEW = (-1.1, 0.9, -0.75)


def show(plotter, column, path):
    mesh = pv.read(path)
    plotter.subplot(0, column)
    plotter.set_background("#f4f6f8", top="#dfe8ef")
    plotter.add_mesh(
        mesh, color="#c9cdd2", show_edges=True, edge_color="#3b4a5a", line_width=1.2, ambient=0.3, diffuse=0.75, specular=0.05
    )
    plotter.add_text(f"{mesh.n_cells:,} triangles", position="lower_left", font_size=26, color="#26262c")
    plotter.view_vector(VIEW, viewup=(0, 1, 0))
    plotter.camera.zoom(1.02)


def main(before, after, target):
    plotter = pv.Plotter(off_screen=True, shape=(1, 2), border=False, window_size=[OVERSAMPLING * WIDTH, OVERSAMPLING * HEIGHT])
    for column, path in enumerate((before, after)):
        show(plotter, column, path)
    picture = Image.fromarray(plotter.screenshot(None, return_img=True))
    picture.resize((WIDTH, HEIGHT), Image.LANCZOS).save(target, quality=86, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
