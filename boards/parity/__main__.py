"""One scenario per protocol, run every way there is; the state's hash, and what it takes.

`python -m boards.parity [--quick] [skin csma radio mesh] [NAME=FILE]`: exit code 1 if two ways
disagree, 2 if something is not installed. Any network that declares its protocol and lies over
cables can be named (see INNERVATE_NETWORKS); FILE is another scenario than its plainest, or than
that of `boards/parity`. `--quick` plays the micro:bit the first calls only.
"""

from __future__ import annotations

import sys
from pathlib import Path

from boards.errors import BoardFailed, BoardMissing
from boards.parity import microbit, nodejs, record
from boards.parity.record import Transcript
from boards.roles import roles_or_told
from innervate.live.board import Role
from innervate.scenario import ScenarioError

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


def compare(role: Role, file: Path | None, quick: bool) -> bool:
    """Run a protocol's scenario every way, and say what came of it; True if all agree."""
    transcript = record.record(role, file)
    plain = transcript.marks[-1][0]
    compiled, fingerprint = record.compiled_mark(role, file)
    same = (compiled, fingerprint) == (plain, transcript.fingerprint)
    watched = file or record.own_file(role)
    what = "as it is by itself" if watched is None else watched.name
    print(f"{role.name}: {what}, node {role.watched.node}")
    print(f"  compiled     0x{compiled:08x} at the end")
    print(f"  plain        0x{plain:08x} after {len(transcript.marks)} calls")
    if len(transcript.marks) == 1:
        print(f"  it was only switched on; {role.name}=FILE: a scenario in which it is told more")
    played = nodejs.play(transcript)
    said = agree(transcript, played.marks, "MicroPython")
    same = same and bool(said) and len(played.marks) == len(transcript.marks)
    print(f"  MicroPython  {said}")
    if role.emulated is not None:
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
    if (known := roles_or_told()) is None:
        return 2
    named = [name.partition("=") for name in arguments if name != "--quick"]
    files = {name: Path(file) for name, is_file, file in named if is_file}
    wanted = [name for name, *_ in named] or list(known)
    unknown = [name for name in wanted if name not in known]
    if unknown:
        print(f"no protocol {unknown[0]!r}; known: {', '.join(known)}", file=sys.stderr)
        return 2
    try:
        nodejs.home()
        if any(known[name].emulated for name in wanted):
            microbit.look()
        results = [compare(known[n], files.get(n), "--quick" in arguments) for n in wanted]
    except (BoardMissing, ScenarioError) as error:
        print(error, file=sys.stderr)
        return 2
    except BoardFailed as error:
        print(f"a board did not get through: {error}", file=sys.stderr)
        return 1
    print("all the same" if all(results) else "NOT the same")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
