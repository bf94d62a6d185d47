"""The error of this room."""


class TopologyError(Exception):
    """A network that cannot be cabled as asked; the message says what to change, in one line.

    `subject` names the thing at fault where one is known ("urdf", "links", "reach_mm",
    "interfaces", ...), so that a caller can point at the line it came from.
    """

    def __init__(self, message: str, subject: str = "") -> None:
        super().__init__(message)
        self.subject = subject
