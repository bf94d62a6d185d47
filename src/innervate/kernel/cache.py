"""Where what was compiled is kept, and how processes take turns there; it knows no compiler."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]


def cache_root() -> Path:
    """Where compiled code is kept: INNERVATE_CACHE, the user's cache folder, or a temporary one.

    The first that can be written.
    """
    chosen = os.environ.get("INNERVATE_CACHE")
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    spare = Path(tempfile.gettempdir()) / f"innervate-{os.getuid() if hasattr(os, 'getuid') else 0}"
    for root in ([Path(chosen)] if chosen else []) + [Path(home) / "innervate"]:
        with contextlib.suppress(OSError):
            root.mkdir(parents=True, exist_ok=True)
            if os.access(root, os.W_OK):
                return root
    return spare


@contextlib.contextmanager
def alone(path: Path) -> Iterator[None]:
    """While nobody else is here with a file of this name, where files can be locked at all."""
    with contextlib.ExitStack() as opened:
        with contextlib.suppress(OSError):
            file = opened.enter_context(path.open("ab"))
            if fcntl is not None:
                fcntl.flock(file, fcntl.LOCK_EX)
        yield


def is_free(file: IO[Any]) -> bool:
    """True if nobody else holds an open file, which from now on is ours until it is closed."""
    try:
        if fcntl is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        pass
    return True
