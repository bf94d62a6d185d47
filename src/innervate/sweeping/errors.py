"""The error of this room."""

from __future__ import annotations


class SweepError(Exception):
    """A sweep that cannot be begun, gone on with or read: one line that says what to change."""
