"""Makes the pictures of docs/methods/solids.md.

    python3 pictures.py --delft delft_ahn3.laz --distcap distcap.xyz [--zeroset PATH]

Models and meshes go to a temporary folder. Needs numpy, Pillow, pyvista and a display; without one, `xvfb-run -a python3 ...`.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pyvista as pv
from PIL import Image

HERE = Path(__file__).resolve().parent
PANEL = (640, 520)
OVERSAMPLING = 2
# A house on the tile with what stands around it, and the lawn of a court.
HOUSE = [
    [85019.1, 447461.4], [85028.6, 447472.9], [85035.6, 447476.4], [85042.4, 447475.4], [85048.0, 447477.3], [85055.5, 447474.5],
    [85056.0, 447468.9], [85051.7, 447465.8], [85048.0, 447464.9], [85039.9, 447455.4], [85029.8, 447463.1], [85025.5, 447458.4],
]
TOWER = "union(cylinder(84973,447514,-2; 84973,447514,14; 6); cone(84973,447514,14; 84973,447514,20; 7; 0))"


def panel(mesh, focus, radius, toward):
    """What is within the radius of the focus fills the height of the panel."""
    origin = np.asarray(focus, float)
    mesh = mesh.copy()
    mesh.points = (np.asarray(mesh.points, float) - origin).astype(np.float32)
    middles = mesh.cell_centers().points
    mesh = mesh.extract_cells(np.linalg.norm(middles, axis=1) < 2.5 * radius).extract_surface(algorithm="dataset_surface")
    plotter = pv.Plotter(off_screen=True, window_size=[OVERSAMPLING * c for c in PANEL])
    plotter.set_background("#f4f6f8", top="#dfe8ef")
    plotter.add_mesh(mesh, color="#cfd3d8", ambient=0.25, diffuse=0.8, specular=0.05)
    toward = np.asarray(toward, float)
    plotter.camera.position = 4.0 * radius * toward / np.linalg.norm(toward)
    plotter.camera.focal_point = (0.0, 0.0, 0.0)
    plotter.camera.up = (0.0, 0.0, 1.0)
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = radius
    image = Image.fromarray(plotter.screenshot(None, return_img=True))
    plotter.close()
    return image.resize(PANEL, Image.Resampling.LANCZOS)


def picture(name, rows):
    """Panels in rows."""
    whole = Image.new("RGB", (PANEL[0] * len(rows[0]), PANEL[1] * len(rows)))
    for j, row in enumerate(rows):
        for i, image in enumerate(row):
            whole.paste(image, (i * PANEL[0], j * PANEL[1]))
    whole.save(HERE / name, quality=88)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--zeroset", default="zeroset")
    parser.add_argument("--delft", required=True)
    parser.add_argument("--distcap", required=True)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)

        def zeroset(*words):
            subprocess.run([args.zeroset, *map(str, words), "--quiet"], check=True, cwd=work)

        def mesh(*words):
            zeroset(*words, "-o", "mesh.ply")
            return pv.read(work / "mesh.ply")

        tile, cap = Path(args.delft).resolve(), Path(args.distcap).resolve()
        ring = HOUSE + HOUSE[:1]
        (work / "house.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
        zeroset("fit", tile, "-o", "tile.zset", "--resolution", 0.5)
        zeroset("fit", tile, "-o", "ground.zset", "--resolution", 0.5, "--classes", 2)
        around = ["--bounds", "84940,447400,85080,447560"]
        healed = ["subtract", "subtract(extrude(house.geojson; -5; 60); ground.zset)"]
        toward, focus = (-1.0, -1.2, 1.0), (85036.0, 447466.0, 4.0)
        before = mesh("mesh", "tile.zset", *around)
        after = mesh("edit", "tile.zset", *healed, "union", TOWER, *around)
        views = [panel(before, focus, 25.0, toward), panel(after, focus, 25.0, toward)]
        picture("delft.jpg", [views + [panel(after, (84973.0, 447514.0, 6.0), 25.0, toward)]])

        zeroset("fit", cap, "-o", "cap.zset", "--scene", "object")
        parts = [
            mesh("mesh", "cap.zset"),
            mesh("edit", "box(0.05,0,-0.06; 0.95,1,0.45)", "subtract", "cap.zset"),
            mesh("edit", "cap.zset", "subtract", "box(0.4,0,0.2; 0.6,0.4,0.42)"),
        ]
        sides = [(1.0, -1.0, 0.8), (-1.0, 0.9, 0.7)]
        picture("distcap.jpg", [[panel(part, part.center, 0.4 * part.length, side) for part in parts] for side in sides])

        # Points of a round tower with a flared foot, with noise, and a square top of the same height as wide.
        shape = "union(cylinder(0,0,0; 0,0,6; 2); cone(0,0,0; 0,0,2; 3; 2))"
        zeroset("mesh", shape, "-o", "shape.ply", "--cell", 0.08)
        points = np.asarray(pv.read(work / "shape.ply").points, float)
        points += np.random.default_rng(1).normal(0.0, 0.01, points.shape)
        np.savetxt(work / "tower.xyz", points[points[:, 2] > 0.05], "%.5f")
        zeroset("fit", "tower.xyz", "-o", "tower.zset", "--scene", "object", "--resolution", 0.15)
        towers = [mesh("mesh", "tower.zset"), mesh("edit", "tower.zset", "union", "box(-2.3,-2.3,5; 2.3,2.3,7.5)")]
        picture("tower.jpg", [[panel(tower, (0.0, 0.0, 3.6), 5.2, (1.0, -1.6, 0.7)) for tower in towers]])


if __name__ == "__main__":
    main()
