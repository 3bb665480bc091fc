"""What the benches share: the binary, child processes with their cost, tables, small mesh files."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent


def add_common(parser):
    """Options that every bench has."""
    parser.add_argument("--zeroset", metavar="PATH", help="the command to measure [default: built from this tree]")
    parser.add_argument("--work", metavar="DIR", help="keep clouds and meshes here [default: a temporary folder]")


def binary(path):
    """The command: as given, or built from this tree."""
    if path:
        return str(Path(path).resolve())
    subprocess.run(["cargo", "build", "--release", "-p", "zeroset-cli"], cwd=ROOT, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return str(ROOT / target / "release" / "zeroset")


def measured(command):
    """Runs a command in a child process of its own.

    Returns what it cost from its start to its end, reading and writing of files included: `cpu`, seconds of the
    processor in user and system mode over all threads; `wall`, seconds; `peak`, bytes of the largest resident set.
    Idle OpenMP threads sleep rather than spin, so that waiting is not counted as work.
    """
    environment = dict(os.environ, OMP_WAIT_POLICY="passive")

    start = time.perf_counter()
    child = subprocess.Popen([str(c) for c in command], env=environment, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - start
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{command[0]} ended with {child.returncode}: {' '.join(map(str, command))}")
    # Linux counts the resident set in KiB, macOS in bytes.
    unit = 1 if sys.platform == "darwin" else 1024
    return {"cpu": usage.ru_utime + usage.ru_stime, "wall": wall, "peak": usage.ru_maxrss * unit}


def output_json(command):
    """Runs a command and reads what it prints as JSON."""
    return json.loads(subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE).stdout)


def read_points(path):
    """The vertices of a binary PLY file of zeroset as a record array."""
    types = {"double": "<f8", "float": "<f4", "int": "<i4", "uint": "<u4", "ushort": "<u2", "uchar": "u1"}
    with open(path, "rb") as file:
        count, fields, element = 0, [], None
        while (line := file.readline().decode()) != "end_header\n":
            words = line.split()
            if words[0] == "element":
                element = words[1]
                count = int(words[2]) if element == "vertex" else count
            elif words[0] == "property" and element == "vertex":
                fields.append((words[2], types[words[1]]))
        return np.fromfile(file, fields, count)


def table(rows):
    """Rows of text as a Markdown table; the first row is the head."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]

    def line(row):
        cells = [c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths))]
        return "| " + " | ".join(cells) + " |"

    rule = "|" + "|".join(("-" * (w + 2)) if i == 0 else ("-" * (w + 1) + ":") for i, w in enumerate(widths)) + "|"
    return "\n".join([line(rows[0]), rule] + [line(r) for r in rows[1:]])
