"""`innervate verify --random`: whole networks, until something breaks or somebody says stop."""

from __future__ import annotations

import json
from itertools import count as numbers
from pathlib import Path

from innervate.analysis.words import number_of
from innervate.cli import errors
from innervate.cli.progress import Display


def search(seed: int | None, count: int, as_json: bool, out: Path | None) -> int:
    """Run networks `seed`, `seed` + 1, ...; 1 with the first that breaks something."""
    from innervate.kernel.stop import Stop
    from innervate.running import fuzz

    first, done, broken = 1 if seed is None else seed, 0, None
    with Stop() as stop, Display(as_json) as display:
        for number in numbers(first):
            display.show(f"network {number}: {done} fine so far", done, count, None)
            broken = fuzz.attempt(number)
            done += 1
            if broken is not None or stop.asked or done == count:
                break
    result = {"first": first, "networks": done, "broken": None}
    if broken is None:
        if as_json:
            print(json.dumps(result))
        else:
            last = f" to {first + done - 1}" if done > 1 else ""
            print(f"Nothing broken in {number_of(done, 'network')}, {first}{last}.")
        return errors.INTERRUPTED if stop.asked and done != count else 0
    path = broken.save(out or Path("runs"))
    if as_json:
        print(json.dumps(result | {"broken": broken.why, "seed": broken.seed, "file": str(path)}))
    else:
        print(f"Network {broken.seed} breaks: {broken.why}")
        tries = "1 try" if broken.tries == 1 else f"{broken.tries} tries"
        print(f"Made smaller in {tries}. Play it: innervate run {path}")
        print(f"As drawn: innervate verify --random --seed {broken.seed} --count 1")
    return 1
