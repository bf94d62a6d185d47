"""How help is laid out: in lines as long as the terminal's, and not as in the sources."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cyclopts.help import HelpPanel
    from rich.console import Console, ConsoleOptions

BREAK = re.compile(r"(?<=\S)[ \t]*\n(?=\S)")  # within a paragraph


class Flowing:
    """As usual, but paragraphs may have been written in several lines."""

    def __call__(self, console: Console, options: ConsoleOptions, panel: HelpPanel) -> None:
        """One box of commands or options."""
        from cyclopts.help.formatters import DefaultFormatter

        for entry in panel.entries:
            _flow(entry.description)
        DefaultFormatter()(console, options, panel)

    def render_usage(self, console: Console, options: ConsoleOptions, usage: Any) -> None:
        """The line that says how to call it."""
        from cyclopts.help.formatters import DefaultFormatter

        DefaultFormatter().render_usage(console, options, usage)

    def render_description(self, console: Console, options: ConsoleOptions, text: Any) -> None:
        """What the command does, in paragraphs."""
        from cyclopts.help.formatters import DefaultFormatter

        _flow(text)
        DefaultFormatter().render_description(console, options, text)


def _flow(text: Any) -> None:
    """Join the lines of each paragraph."""
    plain: Any = getattr(text, "primary_renderable", None)
    if hasattr(plain, "plain"):
        plain.plain = BREAK.sub(" ", plain.plain)
