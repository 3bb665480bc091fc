"""Raw point clouds to implicit models and meshes, without normals and without orientation.

| name | does |
|---|---|
| `reconstruct` | points in, a mesh out |
| `fit` | points in, a `Model` out: a solid that can be asked, measured, cut and joined |
| `features` | points in, planes, edges and corners out |
| `read`, `sample` | points of files, of test scenes |
| `box`, `sphere`, `cylinder`, `cone`, `half_space`, `prism`, `height_field` | shapes to cut and join with |
| `newe`, `NormalizedFit` | small exact tools |

F < 0 inside. Triangles are counter-clockwise from outside. Lengths are in the unit of the points, angles in degrees. Every error is a
`ZerosetError` of its own kind.

>>> import zeroset
>>> points = zeroset.sample("torus", points=5000)
>>> zeroset.reconstruct(points, quality="draft").topology()["genus"]
1
"""

from zeroset._core import version as _version
from zeroset._data import Cloud, read, sample, sample_truth
from zeroset._errors import (
    Cancelled,
    FileError,
    FileMissingError,
    FitError,
    FormatError,
    InputError,
    MemoryLimitError,
    MeshError,
    ModelError,
    NoSurfaceError,
    ParameterError,
    ZerosetError,
)
from zeroset._features import Corner, Edge, Features, Plane, features
from zeroset._mesh import Mesh
from zeroset._model import Change, Model, Volume
from zeroset._reconstruct import fit, reconstruct
from zeroset._shapes import box, cone, cylinder, half_space, height_field, prism, sphere
from zeroset._small import Newe, NormalizedFit, newe

__version__ = _version()

__all__ = [
    "Cancelled",
    "Change",
    "Cloud",
    "Corner",
    "Edge",
    "Features",
    "FileError",
    "FileMissingError",
    "FitError",
    "FormatError",
    "InputError",
    "MemoryLimitError",
    "Mesh",
    "MeshError",
    "Model",
    "ModelError",
    "Newe",
    "NoSurfaceError",
    "NormalizedFit",
    "ParameterError",
    "Plane",
    "Volume",
    "ZerosetError",
    "box",
    "cone",
    "cylinder",
    "features",
    "fit",
    "half_space",
    "height_field",
    "newe",
    "prism",
    "read",
    "reconstruct",
    "sample",
    "sample_truth",
    "sphere",
]
