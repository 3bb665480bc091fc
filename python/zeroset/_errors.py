"""What can go wrong, one class for each kind.

Messages are one line, and say what to do.
"""


class ZerosetError(Exception):
    """Whatever goes wrong in this package."""


class InputError(ZerosetError, ValueError):
    """Arrays that cannot be used: a wrong shape or type, NaN, too few points, points on one line."""


class ParameterError(ZerosetError, ValueError):
    """A value of a parameter that is not possible, or an unknown word."""


class MemoryLimitError(ZerosetError, MemoryError):
    """More memory would be needed than allowed; the message names a resolution that fits."""


class NoSurfaceError(ZerosetError):
    """There is no surface where it was looked for."""


class FitError(ZerosetError):
    """The equations of a fit have no solution."""


class ModelError(ZerosetError):
    """A model that cannot be: a shape without volume, a mesh that is not closed, an expression that cannot be understood."""


class MeshError(ZerosetError):
    """A mesh that cannot be examined, or bears no surface."""


class FileError(ZerosetError, OSError):
    """The system refuses to read or write a file."""


class FileMissingError(FileError, FileNotFoundError):
    """A file or its folder does not exist."""


class FormatError(FileError, ValueError):
    """A file is damaged, or of a format that is not known or not offered."""


class Cancelled(ZerosetError):
    """The work was stopped. Raise it in a progress callback to stop, or any other exception."""
