"""`innervate fit`: a scenario out of a capture."""

import json
from pathlib import Path

from innervate.cli.errors import say
from innervate.cli.options import Json


def fit(capture: Path, /, *, out: Path | None = None, as_json: Json = False) -> int:
    """Write the scenario, or print it; say how well its simulation matches. 1 if links differ.

    Args:
        capture: A capture by innervate, of a run or of live nodes; or what `live status --json`
            said.
        out: The scenario file to write; it is printed if left out.
        as_json: Print the scenario and how well it matches as JSON and nothing else.
    """
    from innervate.export import files, fitting, measure  # not for who mistypes a command

    found = measure.measure(capture)
    text = fitting.scenario_of(found, capture.stem)
    if out is not None:
        files.write_text(out, text)
    links = len({frozenset(key) for key in found.ways})
    if as_json:
        lines, same = fitting.check(text, found)
        print(json.dumps({
            "kind": found.kind, "links": links, "packets": found.packets,
            "seconds": found.seconds, "cut": sorted(found.cut), "notes": found.notes,
            "same_links": same, "match": [line.strip() for line in lines],
            "file": None if out is None else str(out), "scenario": text,
        }, indent=2, ensure_ascii=False))  # fmt: skip
        return 0 if same else 1
    print(text if out is None else f"Written: {out}. Run it with `innervate run {out}`.\n", end="")
    tell = say if out is None else print
    seen = f"{found.packets} packets in {found.seconds:.3f} s: " if found.packets else ""
    tell(f"{seen}a {found.kind} of {links} links")
    if found.cut:
        tell(f"cut for some time, and whole in the scenario: {', '.join(sorted(found.cut))}")
    for note in found.notes:
        tell(note)
    lines, same = fitting.check(text, found)
    for line in lines:
        tell(line)
    return 0 if same else 1
