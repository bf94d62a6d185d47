"""The error of this room."""


class LiveError(Exception):
    """A node that cannot run as written, or does not answer: one line that says what to change."""
