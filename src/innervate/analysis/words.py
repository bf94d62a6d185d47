"""Figures as people read them: a part is never said to be the whole, no number has an exponent."""

LEAST = 1e-5  # of a whole: less is not told apart


def figure_words(value: float, digits: int = 3) -> str:
    """A number with so many digits, or as many as stand before its point: "0.0123", "1,234"."""
    shown = f"{value:.{digits}g}"
    return f"{value:,.0f}" if "e+" in shown else shown


def share_words(ratio: float) -> str:
    """A fraction as a percentage: "0.678 %", "99.99 %", "less than 0.001 %"."""
    if 0 < ratio < LEAST:
        return "less than 0.001 %"
    if 1 - LEAST < ratio < 1:
        return "more than 99.999 %"
    shown = f"{100 * ratio:.3g}"
    decimals = 2
    while ratio < 1 and float(shown) >= 100:
        shown = f"{100 * ratio:.{decimals}f}"
        decimals += 1
    return f"{shown} %"
