"""What a user of the explorer can do wrong."""


class VerifyError(ValueError):
    """One line that says what to change."""
