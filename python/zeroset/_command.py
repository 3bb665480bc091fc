"""The command ``zeroset``, in this process."""

import sys

from zeroset import _core


def main() -> None:
    """Run the command with the words of the command line, and end with its exit code."""
    sys.exit(_core.command(["zeroset", *sys.argv[1:]]))
