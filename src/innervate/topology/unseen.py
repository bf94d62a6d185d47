"""Characters that nobody sees: they turn words behind them round, or make two names look alike."""

import unicodedata

# Unicode's general categories: controls; formats, which are marks of direction, joiners and spaces
# of no width; halves of characters; separators of lines and paragraphs.
_UNSEEN = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})


def unseen(text: str) -> str:
    """What is wrong with a text by the first such character; "" if it has none.

    "holds U+202E (right-to-left override), which nobody sees; leave it out".

    Letters that are written from right to left are seen: they are allowed.
    """
    if text.isascii() and text.isprintable():
        return ""
    odd = next((char for char in text if unicodedata.category(char) in _UNSEEN), "")
    if not odd:
        return ""
    name = unicodedata.name(odd, "").lower()
    what = f"U+{ord(odd):04X}{f' ({name})' if name else ''}"
    return f"holds {what}, which nobody sees; leave it out"
