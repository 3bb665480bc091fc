"""Renders delft.jpg from the mesh of the README's command.

    python3 docs/pictures/delft.py delft.ply docs/pictures/delft.jpg

Needs numpy, Pillow, pyvista and a display; without one, `xvfb-run -a python3 ...`.
"""

import sys

import numpy as np
import pyvista as pv
from PIL import Image

WIDTH, HEIGHT = 1600, 900
# Pixels of the picture in each direction for one of the result, against stairs at the edges.
OVERSAMPLING = 2
# Ambient occlusion has no depths beyond the picture, so its outermost rows are left out.
MARGIN = 6
NUMPY_TYPES = {"double": "<f8", "float": "<f4", "uchar": "u1"}


def read_ply(path):
    """Vertices as a record array and triangles as an index array, from a binary PLY file of zeroset."""
    with open(path, "rb") as file:
        counts, fields = {}, []
        while (line := file.readline().decode()) != "end_header\n":
            words = line.split()
            if words[0] == "element":
                counts[words[1]] = int(words[2])
            elif words[0] == "property" and words[1] != "list":
                fields.append((words[2], NUMPY_TYPES[words[1]]))
        vertices = np.fromfile(file, fields, counts["vertex"])
        faces = np.fromfile(file, [("count", "u1"), ("indices", "<i4", 3)], counts["face"])
    return vertices, faces["indices"]


def ramp(low, high, share):
    """Colours between two, by a share from 0 to 1."""
    share = np.clip(share, 0.0, 1.0)[:, None]
    return (1.0 - share) * np.array(low) + share * np.array(high)


def colors(heights, up, classes):
    """A colour for each vertex: its class, lighter with height, and walls told from roofs by the normal."""
    share = (heights + 5.5) / 16.0
    color = ramp((0.73, 0.70, 0.62), (0.81, 0.78, 0.70), share)
    tree, building, bridge, water = classes == 1, classes == 6, classes == 26, classes == 9
    color[tree] = ramp((0.36, 0.46, 0.31), (0.64, 0.71, 0.49), share)[tree]
    roof = ramp((0.69, 0.42, 0.31), (0.83, 0.60, 0.49), share)
    flat = np.clip((np.abs(up) - 0.25) / 0.2, 0.0, 1.0)[:, None]
    color[building] = (flat * roof + (1.0 - flat) * np.array((0.90, 0.86, 0.78)))[building]
    color[bridge] = (0.72, 0.72, 0.70)
    color[water] = (0.45, 0.60, 0.68)
    return (255 * color).astype(np.uint8)


def light(azimuth, height, color, intensity):
    """A lamp that shines at the middle from a direction in degrees."""
    angle = np.radians(azimuth)
    place = (300 * np.cos(angle), 300 * np.sin(angle), height)
    return pv.Light(position=place, focal_point=(0, 0, 0), color=color, intensity=intensity, light_type="scene light")


def main(source, target):
    vertices, triangles = read_ply(source)
    points = np.stack([vertices["x"], vertices["y"], vertices["z"]], axis=1)
    points -= points.mean(axis=0)
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles]).ravel()
    mesh = pv.PolyData(points, faces).compute_normals(
        cell_normals=False, split_vertices=False, consistent_normals=False, auto_orient_normals=False
    )
    up = np.asarray(mesh.point_data["Normals"])[:, 2]
    mesh.point_data["color"] = colors(points[:, 2], up, vertices[vertices.dtype.names[3]])

    size = [OVERSAMPLING * WIDTH, OVERSAMPLING * (HEIGHT + 2 * MARGIN)]
    plotter = pv.Plotter(off_screen=True, window_size=size, lighting="none")
    plotter.set_background("#f4f6f8", top="#dfe8ef")
    plotter.add_mesh(
        mesh, scalars="color", rgb=True, smooth_shading=True, ambient=0.3, diffuse=0.8, specular=0.05, specular_power=10
    )
    azimuth, elevation, distance, target_x, target_y = np.radians(-122), np.radians(33), 215, -2, 2
    plotter.add_light(light(-177, 260, "#fff2dc", 0.95))
    plotter.add_light(light(-52, 250, "#cfe0ff", 0.3))
    plotter.enable_ssao(radius=5, bias=0.25, kernel_size=128, blur=True)
    ground = distance * np.cos(elevation)
    plotter.camera.focal_point = (target_x, target_y, 0)
    plotter.camera.position = (
        target_x + ground * np.cos(azimuth),
        target_y + ground * np.sin(azimuth),
        distance * np.sin(elevation),
    )
    plotter.camera.up = (0, 0, 1)
    plotter.camera.view_angle = 30
    plotter.camera.clipping_range = (20, 1200)
    picture = Image.fromarray(plotter.screenshot(None, return_img=True))
    picture = picture.resize((WIDTH, HEIGHT + 2 * MARGIN), Image.LANCZOS)
    picture.crop((0, MARGIN, WIDTH, HEIGHT + MARGIN)).save(target, quality=86, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
