"""The command line; heavy rooms are imported inside commands."""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["main"]


def main(tokens: Sequence[str] | None = None) -> int:
    """Carry out a command line; its exit code (see app.main)."""
    try:  # the commands take a moment to load: Ctrl-C is no error then either
        from innervate.cli import app

        return app.main(tokens)
    except KeyboardInterrupt:
        print("innervate: interrupted", file=sys.stderr)
        return 130
