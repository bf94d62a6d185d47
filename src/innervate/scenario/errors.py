"""The error of this room."""


class ScenarioError(Exception):
    """A scenario that cannot be run as written: one line that says what to change.

    Attributes:
        path: the file as the user named it, "--set a.b=c", or "" for a scenario made in code.
        line: line in the file, from 1; 0 where there is none.
        key: dotted key ("event.0.at_s"); "" for the file as a whole.
        message: what is wrong and what to change.
    """

    def __init__(self, message: str, path: str = "", line: int = 0, key: str = "") -> None:
        self.path = one_line(path)
        self.line = line
        self.key = one_line(key)
        self.message = one_line(message)
        place = f"{self.path}:{line}" if self.path and line else self.path
        super().__init__(f"{place}: {self.message}" if place else self.message)


def one_line(text: str) -> str:
    """The text with everything escaped that a terminal would not print as it is."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
