"""F of the first fitted model at world positions, with NumPy alone: python3 format_example.py model.zset < positions.txt"""
import json, struct, sys
import numpy as np

def read(path):
    data = open(path, "rb").read()
    magic, version, _, length = struct.unpack_from("<8sIIQ", data)
    assert magic == b"\x89ZSET\r\n\x1a" and version == 1, "not a model of version 1"
    header = json.loads(data[24 : 24 + length])
    flat = lambda a: np.frombuffer(data, a["dtype"], int(np.prod(a["shape"])), 24 + length + a["offset"])
    return header, {name: flat(a).reshape(a["shape"]) for name, a in header["arrays"].items()}

def evaluate(header, arrays, world, i=0):
    """F of model i at world positions, of shape (n, 3); NaN where no block is stored."""
    model, lattice = header["models"][i], header["models"][i]["lattice"]
    keys, packed, known, inside = (arrays[f"models/{i}/{name}"] for name in ("keys", "values", "known", "inside"))
    known, inside = (np.unpackbits(m.view("u1"), axis=1, bitorder="little").astype(bool) for m in (known, inside))
    values = np.where(inside, -1, 1) * np.abs(packed).max(initial=np.finfo("f4").tiny)
    values[known] = packed
    local = (world - model["world_from_local"]) @ np.array(model["frame"]).T
    last = 8 * (np.array(lattice["blocks"]) << lattice["finest"]) - 1
    t = np.clip((local - lattice["origin"]) / lattice["spacing"], 0, last)
    cell = np.minimum(t.astype(np.int64), last - 1)
    axes = np.argsort(cell - t, axis=1, kind="stable")  # the greatest fraction first
    steps = np.cumsum(np.eye(3, dtype=np.int64)[axes], axis=1)
    nodes = cell[:, None] + np.concatenate([0 * steps[:, :1], steps], axis=1)
    morton = sum((nodes[..., a] >> 3 + b & 1) << 3 * b + a for b in range(18) for a in range(3))
    block = np.minimum(np.searchsorted(keys, morton.astype("u8")), len(keys) - 1)
    f = np.where(keys[block] == morton.astype("u8"), values[block, (nodes & 7) @ [1, 8, 64]], np.nan)
    return f[:, 0] + (np.take_along_axis(t - cell, axes, axis=1) * np.diff(f, axis=1)).sum(axis=1)

if __name__ == "__main__":
    np.savetxt(sys.stdout, evaluate(*read(sys.argv[1]), np.loadtxt(sys.stdin, ndmin=2)), fmt="%.17g")
