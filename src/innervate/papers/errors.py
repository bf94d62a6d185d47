"""The error of this room."""

from innervate.running.errors import RunError


class PapersError(RunError):
    """A paper or figure that is not there, or a folder that cannot be used: one line."""
