"""What several tests share. Everything is made once."""

import numpy as np
import pytest

import zeroset
from zeroset._types import Floats


@pytest.fixture(scope="session")
def torus() -> Floats:
    """Points of a torus."""
    points = zeroset.sample("torus", points=4000, seed=1)
    points.flags.writeable = False
    return points


@pytest.fixture(scope="session")
def torus_model(torus: Floats) -> zeroset.Model:
    """A draft fitted to it, in a national grid."""
    return zeroset.fit(torus + GRID, quality="draft", scene="object", crs="EPSG:28992")


GRID = np.array([84_800.0, 447_400.0, 0.0])
