"""What can go wrong with watching."""


class WatchError(Exception):
    """Why nothing can be watched, in one line that says what to change."""


class Refused(Exception):
    """Why a command from a page is not carried out, in one line."""
