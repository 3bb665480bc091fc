"""How the cost of zeroset grows with the number of points.

`zeroset sample airborne-city` of 10^4, 10^5 and 10^6 points (10^7 with --large), reconstructed at the default
resolution. Measured are CPU and wall seconds of the whole command and its peak resident set; cells, nodes, triangles
and wall seconds by stage come from its report. The last column is the slope of log cost over log points, fitted by
least squares; a slope of 1 is a cost in proportion to the points.
"""

import argparse
import json
import math
import tempfile
from pathlib import Path

from common import add_common, binary, measured, table


def slope(sizes, values):
    """Exponent of values ~ sizes^exponent by least squares over logarithms; `None` where a value is too small."""
    if len(sizes) < 2 or min(values) <= 0:
        return None
    x, y = [math.log(v) for v in sizes], [math.log(v) for v in values]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    parser.add_argument("--kind", default="airborne-city")
    parser.add_argument("--points", type=int, nargs="+", default=[10**4, 10**5, 10**6])
    parser.add_argument("--large", action="store_true", help="10^7 points, too")
    parser.add_argument("--memory", help="passed on to zeroset, such as 8GB")
    args = parser.parse_args()
    zeroset = binary(args.zeroset)
    sizes = sorted(args.points + ([10**7] if args.large else []))
    runs = []
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(args.work or temporary)
        work.mkdir(parents=True, exist_ok=True)
        cloud, mesh, path = work / "cloud.ply", work / "mesh.ply", work / "report.json"
        for n in sizes:
            measured([zeroset, "sample", args.kind, "-o", cloud, "--points", n])
            command = [zeroset, "reconstruct", cloud, "-o", mesh, "--quiet", "--report", path]
            cost = measured(command + (["--memory", args.memory] if args.memory else []))
            runs.append((cost, json.loads(path.read_text())))

    rows = [["", *[f"{n:,}" for n in sizes], "exponent"]]

    def add(name, of, form="{:.3g}", fitted=True):
        values = [of(cost, report) for cost, report in runs]
        exponent = slope(sizes, values) if fitted else None
        rows.append([name, *[form.format(v) for v in values], "" if exponent is None else f"{exponent:.3f}"])

    add("CPU seconds", lambda c, r: c["cpu"], "{:.2f}")
    add("wall seconds", lambda c, r: c["wall"], "{:.2f}")
    add("peak memory, MB", lambda c, r: c["peak"] / 1e6, "{:.1f}")
    add("peak of levels and solver, MB", lambda c, r: r["fit"]["peak_bytes"] / 1e6, "{:.1f}")
    add("bytes a point", lambda c, r: c["peak"] / r["plan"]["points"], "{:.0f}", False)
    add("microseconds of CPU a point", lambda c, r: c["cpu"] / r["plan"]["points"] * 1e6, "{:.1f}", False)
    add("resolution over spacing", lambda c, r: r["plan"]["resolution"] / r["plan"]["spacing"], "{:.2f}", False)
    add("levels", lambda c, r: r["plan"]["levels"], "{}", False)
    add("occupied cells", lambda c, r: r["plan"]["occupied_cells"], "{:,}")
    add("nodes of the finest level", lambda c, r: r["fit"]["levels"][-1]["free_nodes"], "{:,}")
    add("nodes of all levels", lambda c, r: sum(v["free_nodes"] for v in r["fit"]["levels"]), "{:,}")
    add("triangles", lambda c, r: r["mesh"]["triangles"], "{:,}")
    for stage in runs[0][1]["seconds"]:
        if stage != "total":
            add(f"{stage}, wall seconds", lambda c, r, s=stage: r["seconds"][s], "{:.3f}")
    finest = max(len(r["fit"]["levels"]) for _, r in runs)
    for up in range(min(3, finest)):
        name = "finest level" if up == 0 else f"finest level but {up}"
        add(f"{name}, wall seconds", lambda c, r, u=up: r["fit"]["levels"][-1 - u]["seconds"], "{:.3f}")
    print(table(rows))


if __name__ == "__main__":
    main()
