"""The error of this room."""

from __future__ import annotations


class LiveError(Exception):
    """A node that cannot run as written, or does not answer: one line that says what to change."""
