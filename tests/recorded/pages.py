"""What a page or a drawing of ours shows, as lines of text by section and drawing."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from itertools import groupby

from tests.recorded.looks import Picture, digest, number

FEW = 4  # elements of one kind in a row that are written out
ROWS = 8  # of a table
LONG = 96  # letters of an attribute
VOID = {"meta", "link", "br", "hr", "img", "input"}
HEADS = {"h1", "h2", "h3"}
FILES = {"style", "script", "pre"}  # known by a digest
INLINE = {
    "td",
    "th",
    "b",
    "span",
    "a",
    "code",
    "em",
    "strong",
    "tspan",
    "animate",
    "animatetransform",
}  # part of what is around them
NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")


def rounded(text: str) -> str:
    """Its numbers with four digits."""
    return NUMBER.sub(lambda found: number(float(found[0])), text)


def short(text: str) -> str:
    """A long text by its beginning, length and digest."""
    if len(text) <= LONG:
        return text
    return f"{text[: LONG // 2]}... ({len(text)} #{digest(text)})"


def picture(page: str) -> Picture:
    """What is on a page, by its parts: what stands under each heading, and each drawing."""
    reader = Reader()
    reader.feed(page)
    reader.close()
    return {name: list(folded(lines)) for name, lines in reader.parts.items() if lines}


def folded(lines: list[tuple[str, str]]) -> list[str]:
    """Lines; of many of one kind the first, the last and a digest of all."""
    found = []
    for kind, group in groupby(lines, key=lambda one: one[0]):
        words = [line for _, line in group]
        most = ROWS if kind in ("tr", "text", "li") else FEW
        if len(words) > most:
            between = f"... {len(words)} {kind} #{digest(chr(10).join(words))}"
            words = [*words[: most // 2], between, words[-1]]
        found += words
    return found


class Reader(HTMLParser):
    """Sorts what it reads into parts.

    Attributes:
        parts: (kind, line) of what is in each.
    """

    def __init__(self) -> None:
        super().__init__()
        self.parts: dict[str, list[tuple[str, str]]] = {}
        self._open: list[tuple[str, str]] = []  # tag, and how its line begins
        self._words: list[list[str]] = []
        self._part = self._named("top")
        self._before: list[str] = []  # parts that drawings interrupt

    def _named(self, name: str) -> str:
        """A part of that name; of the same name the next."""
        taken, count = name, 1
        while taken in self.parts:
            count += 1
            taken = f"{name} ({count})"
        self.parts[taken] = []
        return taken

    def _add(self, kind: str, line: str) -> None:
        self.parts[self._part].append((kind, line))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        known = {name: value or "" for name, value in attrs}
        if tag == "svg":
            self._before.append(self._part)
            self._part = self._named(f"drawing: {known.get('aria-label', '')}")
        kind = f"{tag}.{known.pop('class')}" if "class" in known else tag
        values = " ".join(
            f"{name}={short(value if name == 'aria-label' else rounded(value))}"
            for name, value in known.items() if name != "xmlns"
        )  # fmt: skip
        if tag in VOID:
            self._add(kind, f"{kind} {values}")
            return
        self._open.append((kind, f"{kind} {values}".strip()))
        self._words.append([])
        if self._before and tag in ("g", "svg"):
            self._add(kind, self._open[-1][1])

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_data(self, data: str) -> None:
        if self._words:
            self._words[-1].append(data)

    def handle_endtag(self, tag: str) -> None:
        kind, begin = self._open.pop()
        text = " ".join("".join(self._words.pop()).split())
        drawn = bool(self._before)
        if tag in FILES:
            self._add(kind, f"{begin} ({len(text)} letters #{digest(text)})")
        elif self._words and (tag in INLINE or (drawn and tag == "title")):
            self._words[-1].append(f" {text} |" if begin == tag else f" [{begin}] {text} |")
        elif tag not in ("svg", "g") and (text or drawn):
            self._add(kind if drawn else tag, f"{begin}: {text}" if text else begin)
        if tag in HEADS:
            self._part = self._named(text)
        if tag == "svg":
            self._part = self._before.pop()
