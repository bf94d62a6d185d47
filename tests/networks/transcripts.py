"""Transcripts of small networks: what commands gave when they were read, and what they give now."""

import os

REWRITE = os.environ.get("INNERVATE_REWRITE", "") not in ("", "0")


def check(path, replay):
    """A file says what its commands give; INNERVATE_REWRITE=1 writes that into it instead."""
    text = path.read_text()
    given = replay(text)
    if REWRITE:
        path.write_text(given)
    else:
        assert given == text, f"{path.name} gives something else"
