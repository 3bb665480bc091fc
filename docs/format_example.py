"""F of the first fitted model at world positions, with NumPy alone: python3 format_example.py model.zset < positions.txt"""
import json
import struct
import sys

import numpy as np


def open_zset(path):
    """The header and the arrays by their names."""
    data = open(path, "rb").read()
    magic, version, _, length = struct.unpack_from("<8sIIQ", data)
    assert magic == b"\x89ZSET\r\n\x1a" and version == 1, "not a model of version 1"
    header = json.loads(data[24 : 24 + length])
    arrays = {}
    for name, a in header["arrays"].items():
        flat = np.frombuffer(data, a["dtype"], int(np.prod(a["shape"])), 24 + length + a["offset"])
        arrays[name] = flat.reshape(a["shape"])
    return header, arrays


def morton(block):
    """Keys of blocks: bit b of coordinate a is bit 3 b + a of the key."""
    return sum((block[..., a] >> b & 1) << (3 * b + a) for b in range(21) for a in range(3))


def evaluate(header, arrays, world, i=0):
    """F of model i at world positions, of shape (n, 3); NaN where no block is stored."""
    model, lattice = header["models"][i], header["models"][i]["lattice"]
    keys, packed = arrays[f"models/{i}/keys"].astype(np.int64), arrays[f"models/{i}/values"]
    known, inside = (
        np.unpackbits(arrays[f"models/{i}/{name}"].view("u1"), axis=1, bitorder="little").astype(bool)
        for name in ("known", "inside")
    )
    far = np.abs(packed).max(initial=np.finfo("f4").tiny)
    values = np.where(inside, -far, far)
    values[known] = packed

    local = (world - model["world_from_local"]) @ np.array(model["frame"]).T
    t = (local - lattice["origin"]) / lattice["spacing"]
    last = 8 * (np.array(lattice["blocks"]) << lattice["finest"]) - 1
    cell = np.clip(np.floor(t), 0, last - 1).astype(np.int64)
    fraction = t - cell
    axes = np.argsort(-fraction, axis=1, kind="stable")
    steps = np.cumsum(np.eye(3, dtype=np.int64)[axes], axis=1)
    nodes = cell[:, None] + np.concatenate([np.zeros_like(steps[:, :1]), steps], axis=1)

    block = morton(nodes >> 3)
    place = np.minimum(np.searchsorted(keys, block), len(keys) - 1)
    f = np.where(keys[place] == block, values[place, (nodes & 7) @ [1, 8, 64]], np.nan)
    f[((t < 0) | (t > last)).any(axis=1)] = np.nan
    return f[:, 0] + (np.take_along_axis(fraction, axes, axis=1) * np.diff(f, axis=1)).sum(axis=1)


if __name__ == "__main__":
    np.savetxt(sys.stdout, evaluate(*open_zset(sys.argv[1]), np.loadtxt(sys.stdin, ndmin=2)), fmt="%.17g")
