"""Whether the polygons of planes in JSON of `zeroset features` are sound.

    python bench/polygons.py FOUND.json...

Each polygon is laid in its own plane. It is sound if every ring is simple, rings do not cross, holes lie inside, and
its area is the one that the file states to 1e-6 of it. `off plane` is the largest distance of a corner from its
plane.
"""

import argparse
import json
from pathlib import Path

import numpy as np
import shapely
from shapely.validation import explain_validity

from common import table

AREA_REL = 1e-6


def in_plane(plane):
    """The rings in coordinates of the plane, and the largest distance of a corner from it."""
    normal = np.array(plane["normal"])
    origin = normal * plane["offset"]
    u = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    u /= np.linalg.norm(u)
    axes = np.array([u, np.cross(normal, u)])
    rings = [np.array(ring) for ring in plane["polygon"]]
    first = rings[0][0] if rings else origin
    off = max((np.abs(ring @ normal - plane["offset"]).max() for ring in rings), default=0.0)
    return [(ring - first) @ axes.T for ring in rings], off, lambda p: first + np.array(p) @ axes


def signed_area(ring):
    x, y = (ring - ring[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def defects(plane):
    """What is wrong with one polygon: pairs of a name and a text."""
    rings, off, world = in_plane(plane)
    if not rings:
        return [("empty", "no rings")], off
    wrong = []

    def place(shape):
        reason = explain_validity(shape)
        if "[" not in reason:
            return reason
        at = world([float(c) for c in reason.split("[")[1].rstrip("]").split()[:2]])
        return f"{reason.split('[')[0]} at {', '.join(f'{c:.4f}' for c in at)}"

    areas = [signed_area(ring) for ring in rings]
    for ring in rings:
        shape = shapely.Polygon(ring)
        if not shape.is_valid:
            wrong.append(("ring", place(shape)))
    outer = [i for i, a in enumerate(areas) if a > 0]
    repaired = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings]
    holes = {i: [] for i in outer}
    for i in (i for i, a in enumerate(areas) if a <= 0):
        around = [o for o in outer if repaired[o].contains(repaired[i].representative_point())]
        if around:
            holes[min(around, key=lambda o: areas[o])].append(rings[i])
        else:
            wrong.append(("hole", f"a hole of area {-areas[i]:.3g} lies in no ring"))
    if not any(kind == "ring" for kind, _ in wrong):
        parts = [shapely.Polygon(rings[o], holes[o]) for o in outer]
        whole = shapely.MultiPolygon(parts) if len(parts) > 1 else parts[0]
        if not whole.is_valid:
            wrong.append(("rings", place(whole)))
    if abs(sum(areas) - plane["area"]) > AREA_REL * max(plane["area"], 1e-300):
        wrong.append(("area", f"{sum(areas):.6g}, stated {plane['area']:.6g}"))
    return wrong, off


def checked(path):
    """A row of the table, and a line for each defect."""
    planes = json.loads(Path(path).read_text())["planes"]
    lines, count, farthest = [], {}, 0.0
    unsound = 0
    for plane in planes:
        wrong, off = defects(plane)
        farthest = max(farthest, off)
        unsound += any(kind != "area" for kind, _ in wrong)
        for kind in {kind for kind, _ in wrong}:
            count[kind] = count.get(kind, 0) + 1
        lines += [f"{Path(path).name}: plane {plane['id']}, {plane['points']} points, {kind}: {text}"
                  for kind, text in wrong]
    rings = sum(len(plane["polygon"]) for plane in planes)
    share = unsound / len(planes) if planes else 0.0
    named = ("ring", "rings", "hole", "empty", "area")
    row = [Path(path).stem, str(len(planes)), str(rings), f"{unsound} ({share:.2%})",
           *[str(count.get(kind, 0)) for kind in named], f"{farthest:.1e}"]
    return row, lines


HEAD = ["polygons", "planes", "rings", "unsound", "ring not simple", "rings cross", "hole outside", "no ring",
        "area differs", "off plane"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("found", nargs="+")
    results = [checked(path) for path in parser.parse_args().found]
    print("\n".join(line for _, lines in results for line in lines))
    print()
    print(table([HEAD] + [row for row, _ in results]))


if __name__ == "__main__":
    main()
