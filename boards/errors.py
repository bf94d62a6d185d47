"""What can go wrong with boards; each message is one line."""


class BoardMissing(Exception):
    """Something is not installed; says what to install."""


class BoardFailed(Exception):
    """A board did not get through what it was given."""
