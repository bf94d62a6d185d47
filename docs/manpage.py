"""Makes the man page from the commands' own help: `python -m docs.manpage`, with `--check` too.

It is written to docs/innervate.1, and a wheel puts it where `man innervate` finds it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import innervate
from innervate.cli.app import HELP, app
from innervate.cli.examples import BELOW

PAGE = Path(__file__).resolve().parent / "innervate.1"
CODES = (("0", "Done."),
         ("1", "Done, and the answer is no: a check fails, something is broken, runs differ, "
               "nothing that was tried is enough; or a mistake of ours."),
         ("2", "A mistake in what was given; one line says what to change."),
         ("130", "Interrupted; what was done is kept."))  # fmt: skip
VARIABLES = (
    ("INNERVATE_CACHE", "Folder for compiled loops."),
    ("INNERVATE_NETWORKS", "Folders of networks of one's own, separated as in PATH."),
    ("INNERVATE_READY", "0: take neither loops nor nodes as C that came ready with the toolkit."),
    ("INNERVATE_RUN", "Folder in which running nodes have their sockets."),
)


def made() -> str:
    """The page in the language of man."""
    lines = [
        f'.TH INNERVATE 1 "" "innervate {innervate.__version__}" "innervate"',
        ".ad l",
        ".nh",
        ".SH NAME", "innervate \\- networks inside and between robots",
        ".SH SYNOPSIS", "\\fBinnervate\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]",
        ".SH DESCRIPTION", *_paragraphs(HELP),
        ".SH COMMANDS",
    ]  # fmt: skip
    for words in commands():
        lines += _command(words)
    lines += [".SH EXIT STATUS", *_terms(CODES), ".SH ENVIRONMENT", *_terms(VARIABLES)]
    pages = "The pages of the documentation come with the toolkit: \\fBinnervate docs\\fR."
    return "\n".join([*lines, ".SH SEE ALSO", pages]) + "\n"


def commands() -> Iterator[str]:
    """Every command as it is typed: "run", "live up"; those of a group after it."""
    for name in sorted(name for name in app if not name.startswith("-")):
        yield name
        inner = sorted(part for part in app[name] if not part.startswith("-"))
        yield from (f"{name} {part}" for part in inner)


def _command(words: str) -> list[str]:
    command: Any = app
    for word in words.split():
        command = command[word]
    about = command.help.partition("    Args:\n")[0]
    if command.default_command is None:
        return [f'.SS "{_plain(words)}"', *_paragraphs(about)]
    given = [one for one in command.assemble_argument_collection(parse_docstring=True) if one.show]
    operands = [_operand(one) for one in given if one.index is not None]
    lines = [f'.SS "{_plain(" ".join([words, *operands]))}"', *_paragraphs(about)]
    lines += _terms((", ".join(_plain(name) for name in one.names), one.parameter.help or "")
                    for one in given)  # fmt: skip
    examples = BELOW.get(words, ("", ()))[1]
    if examples:
        lines += [".PP", "For example:", ".PP", ".nf", ".RS", *map(_plain, examples), ".RE", ".fi"]
    return lines


def _operand(argument: Any) -> str:
    name = argument.names[0]
    return str(name) if argument.required else f"[{name}]"


def _paragraphs(text: str) -> list[str]:
    parts = [" ".join(part.split()) for part in text.strip().split("\n\n")]
    return [line for part in parts if part for line in (".PP", _plain(part))]


def _terms(rows: Any) -> list[str]:
    return [line for term, says in rows
            for line in (".TP", f"\\fB{term}\\fR", _plain(" ".join(says.split())))]  # fmt: skip


def _plain(text: str) -> str:
    """Text with what man would read otherwise escaped."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{escaped}" if escaped.startswith((".", "'")) else escaped


def main(words: list[str]) -> int:
    """Write it, or say whether it is out of date."""
    if "--check" not in words:
        PAGE.write_text(made(), encoding="utf-8")
        return 0
    current = PAGE.read_text(encoding="utf-8") == made()
    print("" if current else "docs/innervate.1 is out of date: python -m docs.manpage")
    return 0 if current else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
