"""`innervate new network` and `check-protocol`: a network of one's own."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from contextlib import suppress
from keyword import kwlist
from pathlib import Path
from typing import Any

from innervate import folders
from innervate.cli.errors import UserError
from innervate.cli.options import Json
from innervate.network import Network, accesses, networks, read
from innervate.parts import MEDIA

PATTERNS = Path(__file__).parent / "folder"
WORD = "NAME"
TEST_S = 600


def make(target: Path | None, on: str, over: str = "") -> int:
    """Write a network's folder, whole or not at all; never over what is there."""
    target = _checked(target, on, over)
    name = target.name
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        work = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=target.parent))
    except OSError as error:
        raise UserError(f"{target.parent} cannot be written: {error.strerror}") from None
    fresh = work / name  # which may be read by whom the user lets: `work` is the user's alone
    try:
        numbers = _free_numbers(target.parent)
        fresh.mkdir()
        for home in [on, f"{on}_over"] if over else [on]:
            for pattern in sorted((PATTERNS / home).iterdir()):
                made = pattern.name.removesuffix(".txt").replace(WORD, name)
                text = pattern.read_text(encoding="utf-8").replace(WORD, name)
                for old, new in numbers:
                    text = text.replace(old, new)
                (fresh / made).write_text(text.replace("OVER", over), encoding="utf-8")
        fresh.rename(target)
    except OSError as error:
        raise UserError(f"{target} cannot be written: {error.strerror}") from None
    finally:
        shutil.rmtree(work, ignore_errors=True)
    what = f"{on}, above {over}" if over else on
    print(f"Written: {target}, a network over {what}. Try it:")
    for command in (f"innervate check-protocol {target}", f"innervate verify {target}",
                    f"innervate run {target / name}.toml"):  # fmt: skip
        print(f"  {command}")
    return 0


def _checked(target: Path | None, on: str, over: str) -> Path:
    """Where it is to be, if all that was said can be."""
    if target is None:
        raise UserError("name it: innervate new network NAME --on cables")
    name = target.name
    if on not in MEDIA:
        raise UserError(f"--on can be {', '.join(MEDIA)}, not {on[:40]!r}")
    if over and (on != "field" or over not in accesses()):
        raise UserError(f"--over can be {', '.join(accesses())}, with --on field")
    if not (name.isidentifier() and name.isascii() and name == name.lower()):
        raise UserError(f"{name[:60]!r} is no name; use small letters, digits and _, "
                        "like a Python module")  # fmt: skip
    words = {*networks(), *sys.stdlib_module_names, *kwlist, WORD.lower()}
    if name in words or _is_module(name):
        raise UserError(f"the name {name!r} is taken; choose another")
    if target.exists():
        raise UserError(f"{target} is there already; choose another name or move it away")
    return target


def _free_numbers(folder: Path) -> list[tuple[str, str]]:
    """What a pattern says of the numbers that tell networks apart, and what is free of these.

    By one Wireshark knows whose frames it has, by the other nodes that share keys: taken are those
    of the networks that are known, and of the folders beside.
    """
    beside, found = "", []
    for one in folder.glob(f"*/{folders.NETWORK_FILE}"):
        with suppress(OSError):  # it is somebody's, and may be a folder
            beside += one.read_text(encoding="utf-8", errors="replace")
    for word, most, least in (("link_type", 162, 147), ("key_kind", 255, 1)):
        taken = {str(getattr(one, word)) for one in networks().values()}
        taken |= set(re.findall(rf"\b{word} *= *(\d+)", beside))
        free = [one for one in range(most, least - 1, -1) if str(one) not in taken]
        found.append((f"{word}={most}", f"{word}={free[0] if free else most}"))
    return found


def _is_module(name: str) -> bool:
    """True if Python finds a module of that name that is no folder of the present one."""
    from importlib.util import find_spec

    spec = find_spec(name)
    return spec is not None and spec.origin is not None


def check_protocol(folder: Path, /, *, tests: bool = True, as_json: Json = False) -> int:
    """Say all that is wrong with a network's protocol; 2 if something is, 1 if it can break.

    Args:
        folder: The network's folder.
        tests: Run its tests, and say which functions of the protocol they do not reach.
        as_json: Print what was found as JSON and nothing else.
    """
    network = read(folder)
    found = folders.findings(folder.resolve(), network)
    said: dict[str, Any] = {"network": network.name, "wrong": [str(one) for one in found]}
    lines = [*said["wrong"]]
    if not found:
        _look_further(folder, network, tests, said, lines)
    if as_json:
        print(json.dumps(said, indent=2))
    else:
        for line in lines:
            print(line)
    return 2 if found else 1 if said["faults"] else 0


def _look_further(
    folder: Path, network: Network, with_tests: bool, said: dict[str, Any], lines: list[str]
) -> None:
    """Its parts, the outbox, every order of events on two nodes, and what no test reaches."""
    for part, place in network.parts.items():
        if place.startswith(f"{network.package}."):
            getattr(network, part)
    room = getattr(network.protocol, "OUTBOX", 16)
    said["outbox"] = {}
    for handler, (most, where) in folders.actions_of(folder.resolve(), network).items():
        said["outbox"][handler] = most
        if most is None:
            lines.append(f"{where}: {handler}: how many actions it may put is not seen from its "
                         f"loops; the outbox holds {room}")  # fmt: skip
        elif most > room:
            lines.append(f"{where}: {handler} may put {most} actions, the outbox holds {room}; "
                         f"write OUTBOX = {most}")  # fmt: skip
    from innervate.running.exploring import explore

    (case,) = explore(network, graph="pair", states=5_000)
    said["explored"], said["broken"] = case.record, case.record["broken"]
    lines += case.lines
    if with_tests:
        said.update(_tested(folder, network))
        lines += [f"{place}: no test reaches {what}" for what, place in said["unreached"].items()]
        if said["tests_failed"]:
            lines.append(said["tests_failed"])
    lines.append(f"{network.name}: {_conclusion(said, room, case)}")


def _conclusion(said: dict[str, Any], room: int, case: Any) -> str:
    """What holds, what does not, which is noted under `faults`, and how far that was seen."""
    counts = said["outbox"].values()
    most = max((n for n in counts if n is not None), default=0)
    seen = " where that is seen" if None in counts else ""
    states = f"{'all' if case.is_complete else 'the first'} {case.record['states']:,} states"
    shown = {"the outbox is too small": most > room,
             "some order of events breaks it": said["broken"],
             "its tests fail": said.get("tests_failed")}  # fmt: skip
    said["faults"] = [fault for fault, is_there in shown.items() if is_there]
    reached = ""
    if "reached" in said:
        reached = f", {said['reached']} of {said['functions']} functions reached by tests"
    fits = "values and frames fit,"
    if said["faults"]:
        fits = f"but: {', '.join(said['faults'])} (see above);"
    return (f"the dialect is kept, {fits} at most {most} actions a call of {room}{seen}, "
            f"{states} explored{reached}")  # fmt: skip


def _tested(folder: Path, network: Network) -> dict[str, Any]:
    """The functions of a protocol that the folder's tests reach, and those that they do not."""
    if not list(folder.glob("test_*.py")):
        raise UserError(f"{folder} has no test_*.py; write one, or leave them out: --no-tests")
    with tempfile.TemporaryDirectory() as place:
        out = Path(place) / "reached.json"
        names = [str(path) for path in folders.sources(folder.resolve(), network)]
        command = [sys.executable, "-m", "innervate.cli.reaching", str(out), str(folder.resolve()),
                   *names]  # fmt: skip
        # pytest cuts the reason of a failure where its line ends
        wide = os.environ | {"COLUMNS": "1000"}
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=TEST_S, check=False, env=wide
        )
        if not out.is_file():
            last = (done.stderr or done.stdout).strip().splitlines()[-1:]
            raise UserError(f"the tests of {folder} could not be run: {' '.join(last)}")
        told = json.loads(out.read_text(encoding="utf-8"))
    unreached = {name: f"{folders.shown(Path(path))}:{line}"
                 for name, path, line in told["unreached"]}  # fmt: skip
    failed = "" if told["code"] == 0 else _failed(folder, done.stdout)
    count = told["reached"] + len(unreached)
    return {
        "reached": told["reached"],
        "functions": count,
        "unreached": unreached,
        "tests_failed": failed,
    }


def _failed(folder: Path, said: str) -> str:
    lines = [line for line in said.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return f"{folder}: {lines[0] if lines else 'its tests did not end well'}"
