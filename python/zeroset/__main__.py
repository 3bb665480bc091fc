"""``python -m zeroset`` is the command ``zeroset``."""

from zeroset._command import main

main()
