"""The error of this room."""


class RunError(Exception):
    """A run folder that cannot be written or read: one line that says what to change."""
