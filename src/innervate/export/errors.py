"""What can be wrong with a file that comes or goes."""


class ExportError(Exception):
    """The user's mistake or a damaged file: one line that says what to change."""
