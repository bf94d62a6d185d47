"""The error of this room."""


class SweepError(Exception):
    """A sweep that cannot be begun, gone on with or read: one line that says what to change."""


class DamagedError(SweepError):
    """The job table's file is damaged: a page of it, which may be one of many."""
