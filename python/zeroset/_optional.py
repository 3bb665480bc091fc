"""Packages that are only needed for conversions."""

import importlib
from typing import Any


def load(name: str) -> Any:
    """Import an optional package.

    Parameters
    ----------
    name : str
        Its name.

    Returns
    -------
    module
        The package.

    Raises
    ------
    ImportError
        If it is not installed; the message says what to install.
    """
    try:
        return importlib.import_module(name)
    except ImportError as why:
        raise ImportError(f"this needs the package {name}: pip install {name}", name=name) from why
