"""`innervate papers`: figures and claims of a paper, made anew."""

import csv
from importlib import import_module
from pathlib import Path
from typing import Any

from innervate.cli.options import Flag, Texts
from innervate.cli.progress import Display
from innervate.network import first


def papers(
    paper: str | None = None,
    /,
    *,
    only: Texts = None,
    quick: Flag = False,
    redraw: Flag = False,
    page: Path | None = None,
    out: Path = Path("papers"),
) -> int:
    """Draw and tabulate a paper's figures; say how many claims hold.

    Args:
        paper: Which paper: skin (if left out), radio or mesh; or compare: networks beside others.
        only: A figure by its name, like fig8a of the skin, fig12 of the radio or skin of compare;
            may be given again.
        quick: Few seeds and settings: in about a minute.
        redraw: Use kept results even if the sources have changed since.
        page: Of compare: a page of Markdown whose tables are made anew between its marks.
        out: Folder for pictures, tables and kept results.
    """
    from innervate.papers.book import into_page, ready_for  # draws: not before it is wanted

    system, only = first() if paper is None else paper, only or []
    ready_for(system, page, only)
    made = _draw(system, out, quick=quick, only=only, redraw=redraw)
    if page is not None:
        into_page(page, system, out, only)
    for line in verdict_lines(made.with_suffix(".csv")):
        print(line)
    print(f"Look at them in a browser: {made}")
    return 0


def _draw(system: str, out: Path, **how: Any) -> Path:
    """Draw behind a line that says how far it is; the page that was made."""
    room: Any = import_module("innervate.papers")
    with Display() as display:
        display.begin(f"papers {system}: figures and table into {out}", line=True)

        def tell(step: Any) -> None:
            what = f"{step.done} of {step.total} done: {step.what}"
            display.show(what, step.done, step.total, step.left_s)

        try:
            made: Path = room.main(system, out, progress=tell, **how)
        except KeyboardInterrupt:
            what = "what was done is kept, and the same command goes on from there"
            raise KeyboardInterrupt(f"interrupted; {what}") from None
    return made


def verdict_lines(table: Path) -> list[str]:
    """What the table says: how many claims hold, and which do not."""
    from innervate.papers.experiment import FAILS, Claim, summary  # draws: not before it is wanted

    with table.open(encoding="utf-8", newline="") as file:
        claims = [Claim(**row) for row in csv.DictReader(file)]
    lines = [summary(claims)]
    for claim in claims:
        if claim.verdict == FAILS:
            lines.append(f"  {claim.whose}: {claim.claim}")
            lines.append(f"      measured: {claim.measurement}")
            if claim.reason:
                lines.append(f"      because: {claim.reason}")
    return lines
