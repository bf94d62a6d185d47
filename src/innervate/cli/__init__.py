"""The command line; heavy rooms are imported inside commands."""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["main"]


def main(tokens: Sequence[str] | None = None) -> int:
    """Carry out a command line; its exit code (see app.main)."""
    try:  # the commands take a moment to load: Ctrl-C is no error then either
        words = list(sys.argv[1:] if tokens is None else tokens)
        if words[:2] == ["live", "node"]:
            from innervate.live.hangup import hold

            hold()  # until the node listens for it
            if len(words) == 3 and not words[2].startswith("-"):
                return _node(words[2])  # a node on a small computer needs no other command
        from innervate.cli import app

        return app.main(tokens)
    except KeyboardInterrupt:
        print("innervate: interrupted", file=sys.stderr)
        return 130
    finally:
        _drop_unwritten()


def _drop_unwritten() -> None:
    """What a full disk did not take goes nowhere: Python would try again as it ends, and say so."""
    for stream in filter(None, (sys.stdout, sys.stderr)):  # None: it is closed
        try:
            stream.flush()
        except OSError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)
        except ValueError:
            pass  # closed by who called


def _node(file: str) -> int:
    """`innervate live node FILE` without what parses commands: half the start-up time."""
    from pathlib import Path

    try:
        from innervate.live.main import run

        return run(Path(file))
    except Exception as error:
        from innervate.cli import errors

        return errors.conclude(error)
