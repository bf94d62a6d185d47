"""One scenario per protocol, run every way there is; the state's hash, and what it takes.

`python -m boards.parity [--quick] [skin csma radio mesh]`: exit code 1 if two ways disagree, 2 if
something is not installed. `--quick` plays the micro:bit the first calls only.
"""

from __future__ import annotations

import sys

from boards.errors import BoardFailed, BoardMissing
from boards.parity import microbit, nodejs, record
from boards.parity.record import Transcript

QUICK = 100  # calls
CAP = nodejs.CAP


def agree(transcript: Transcript, marks: list[tuple[int, int]], way: str) -> str:
    """How far a way of running it agrees, in words; "" if it does not."""
    wanted = transcript.marks[: len(marks)]
    for i, (one, other) in enumerate(zip(wanted, marks, strict=True)):
        if one != other:
            row = transcript.calls[i]
            print(f"  {way} differs at call {i + 1}: {row[:4]} ...: {one} but {other}")
            return ""
    return f"0x{marks[-1][0]:08x} after {len(marks)} calls, each the same"


def compare(name: str, quick: bool) -> bool:
    """Run a protocol's scenario every way, and say what came of it; True if all agree."""
    transcript = record.record(name)
    plain = transcript.marks[-1][0]
    compiled, fingerprint = record.compiled_mark(name)
    same = (compiled, fingerprint) == (plain, transcript.fingerprint)
    watched = record.WATCHED[name]
    print(f"{name}: {watched.scenario}.toml, node {watched.node}")
    print(f"  compiled     0x{compiled:08x} at the end")
    print(f"  plain        0x{plain:08x} after {len(transcript.marks)} calls")
    played = nodejs.play(transcript)
    said = agree(transcript, played.marks, "MicroPython")
    same = same and bool(said) and len(played.marks) == len(transcript.marks)
    print(f"  MicroPython  {said}")
    if name == "skin":
        marks = microbit.play(transcript, QUICK if quick else len(transcript.calls))
        said = agree(transcript, marks, "micro:bit")
        same = same and bool(said)
        print(f"  micro:bit    {said}")
    what = "code and node" if transcript.role.in_ram else "node alone, its code as flash"
    print(f"  code {played.code} bytes as loaded ({played.flash} as a file), state {played.state},")
    print(f"  with parameters and outbox {played.node}; of {CAP} bytes ({what})")
    print(f"  {played.most} were in use at most, {played.left} could be had at the end")
    return same


def main(arguments: list[str]) -> int:
    """The command; its exit code."""
    names = [name for name in arguments if name != "--quick"]
    unknown = [name for name in names if name not in record.WATCHED]
    if unknown:
        print(f"no protocol {unknown[0]!r}; known: {', '.join(record.WATCHED)}", file=sys.stderr)
        return 2
    names = names or list(record.WATCHED)
    try:
        nodejs.home()
        if "skin" in names:
            microbit.look()
        results = [compare(name, "--quick" in arguments) for name in names]
    except BoardMissing as error:
        print(error, file=sys.stderr)
        return 2
    except BoardFailed as error:
        print(f"a board did not get through: {error}", file=sys.stderr)
        return 1
    print("all the same" if all(results) else "NOT the same")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
