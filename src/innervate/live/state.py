"""What a node keeps on disk over a restart: counters of its seals, the epoch that it has seen."""

from __future__ import annotations

import json
import os
from pathlib import Path

from innervate.live.errors import LiveError


class State:
    """A file that is replaced as a whole, so that a power cut leaves the old or the new one.

    Args:
        path: the file; None = nothing is kept.

    Attributes:
        fresh: True if there was no such file: the node runs for the first time.
        counter: frames may be sealed with counters from here on.
        seen: newest counter per sender.
        epoch: newest epoch of a gateway that was followed; 0 = none.
    """

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.fresh = True
        self.counter = 0
        self.seen: dict[int, int] = {}
        self.epoch = 0
        if path is None or not path.exists():
            return
        try:
            kept = json.loads(path.read_text())
            self.counter = int(kept["counter"])
            self.seen = {int(sender): int(count) for sender, count in kept["seen"].items()}
            self.epoch = int(kept["epoch"]) & 255
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            raise LiveError(
                f"{path}: not a node's state; remove it (its network's key is safe: counters "
                "then follow the clock)"
            ) from None
        self.fresh = False

    def write(self) -> None:
        """Write the file.

        Raises:
            LiveError: it cannot be written.
        """
        if self.path is None:
            return
        seen = {str(sender): count for sender, count in self.seen.items()}
        text = json.dumps({"counter": self.counter, "seen": seen, "epoch": self.epoch})
        new = self.path.with_name(self.path.name + ".new")
        try:
            with new.open("w") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            os.replace(new, self.path)
        except OSError as error:
            raise LiveError(f"{self.path}: cannot be written: {error.strerror}") from None
