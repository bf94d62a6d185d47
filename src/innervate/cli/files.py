"""`innervate scenarios`, `new`, `check`, `schema`: scenario files, without a simulation."""

import json
import os
import re
import shlex
from dataclasses import fields
from itertools import takewhile
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from innervate import scenario
from innervate.cli.errors import UserError
from innervate.cli.options import Json, MeasuredOptions, OwnOptions, Seed, Sets
from innervate.export import files
from innervate.network import networks, use


def scenarios(*, as_json: Json = False) -> int:
    """List the bundled scenarios, a line each: the first sentence of the file's first comment.

    Args:
        as_json: Print names, sentences and files as JSON.
    """
    known = scenario.bundled()
    if as_json:
        listed = [
            {"name": name, "shows": _first_sentence(path), "path": str(path)}
            for name, path in known.items()
        ]
        print(json.dumps(listed, indent=2, ensure_ascii=False))
        return 0
    width = max(len(name) for name in known)
    for name, path in known.items():
        print(f"{name:<{width}}  {_first_sentence(path)}")
    return 0


def _first_sentence(path: Path) -> str:
    """Of the comment that a file begins with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comment = takewhile(lambda line: line.startswith("#"), lines)
    text = " ".join(line.lstrip("# ") for line in comment)
    return re.split(r"(?<=\.) (?=[A-Z])", text, maxsplit=1)[0]


def check_unused(options: Any, whose: str) -> None:
    """Refuse options of something else than what is made.

    Raises:
        UserError: one of them was given.
    """
    usual = type(options)()
    for one in fields(options):
        if getattr(options, one.name) != getattr(usual, one.name):
            raise UserError(f"--{one.name.replace('_', '-')} is for {whose}")


def new(
    kind: str,
    file: Path | None = None,
    /,
    *,
    measured: Annotated[MeasuredOptions, Parameter(name="*")] = MeasuredOptions(),
    own: Annotated[OwnOptions, Parameter(name="*")] = OwnOptions(),
) -> int:
    """Write a commented scenario or a network's folder; never over what is there.

    Args:
        kind: What it describes: skin, radio or mesh. network: a folder with a network of your own.
        file: Where to write it; a scenario is printed if left out. Of a network, its folder: NAME.
        measured: Which nodes and links of a measured network count.
        own: What a network of your own is joined by.
    """
    if kind == "network":
        from innervate.cli import making

        check_unused(measured, "a measured network, not for your own")
        return making.make(file, own.on, own.over)
    check_unused(own, "a network of your own: innervate new network NAME")
    found = ""
    if measured.network is not None:
        text, found = _of_network(kind, file, measured)
    elif measured.wanted:
        raise UserError(
            "--types, --min-tq, --around, --nodes and --gateways are of a --network; name one"
        )
    else:
        text = scenario.template(kind)
    if file is None:
        print(text, end="")
    else:
        _write_new(file, text, found)
    return 0


def _write_new(file: Path, text: str, found: str) -> None:
    """Write a scenario, and say what of a measured network is in it and how to go on."""
    if os.path.lexists(file):
        raise UserError(f"{file} is there already; choose another name or move it away")
    files.write_text(file, text)
    if found:
        print(found)
    word = shlex.quote(str(file))
    print(f"Written: {file}. Check it with `innervate check {word}`, run it with "
          f"`innervate run {word}`.")  # fmt: skip


def _of_network(kind: str, file: Path | None, measured: MeasuredOptions) -> tuple[str, str]:
    """The text of a scenario of a measured network, and what it holds."""
    able = [name for name, known in networks().items() if known.has("measured_template")]
    if kind not in able:
        raise UserError(f"--network is for a {' or a '.join(able)}: "
                        f"innervate new {able[0]} FILE --network {measured.network}")  # fmt: skip
    folder = file.parent if file is not None else Path()
    network = measured.network
    if not network:
        raise UserError("--network needs a file or a name; see: innervate new --help")
    name = file.stem if file is not None else Path(network).stem
    if os.path.lexists(network):  # unlike exists(), no name is too long for it
        network = _seen_from(folder, Path(network))
    text, taken = networks()[kind].measured_template(name, network, measured.wanted, str(folder))
    return text, f"{scenario.summary(scenario.loads(text, folder=str(folder)))}\n{taken}"


def _seen_from(folder: Path, file: Path) -> str:
    """A file's path as it is written beside a scenario; folders may be links to others."""
    place = Path(os.path.realpath(file.parent), file.name)
    return Path(os.path.relpath(place, os.path.realpath(folder))).as_posix()


def check(file: str, /, *, set_: Sets = None, seed: Seed = None, as_json: Json = False) -> int:
    """Say what a scenario holds.

    Args:
        file: A scenario file, or the name of a bundled one.
        set_: Change a key, as for run.
        seed: Root seed in place of the scenario's.
        as_json: Print it as JSON and nothing else.
    """
    loaded = scenario.load(file, overrides=set_ or [], seed=seed)
    said = scenario.summary(loaded)
    if as_json:
        print(json.dumps(_held(loaded, said), indent=2, ensure_ascii=False))
    else:
        print(said)
    return 0


def _held(loaded: scenario.Scenario, said: str) -> dict[str, Any]:
    """What `check` says, line by line: what each is about, and what it says of that."""
    lines: list[tuple[str, str]] = []
    for line in said.splitlines()[1:]:
        word, _, more = line.strip().partition(" ")
        goes_on = line.startswith("   ")  # about the same as the line before
        lines.append((lines[-1][0], line.strip()) if goes_on else (word, more.strip()))
    return {
        "name": loaded.name,
        "kind": loaded.kind,
        "duration_s": loaded.duration_s,
        "seed": loaded.seed,
        "holds": [{"what": what, "says": says} for what, says in lines],
    }


def schema(network: Path | None = None, /, *, out: Path | None = None) -> int:
    """Print or write the JSON Schema of scenario files.

    Args:
        network: Folder of a network of your own, whose scenarios it is to be of, too.
        out: File to write it to.
    """
    if network is not None and str(network) not in networks():
        use(network)
    text = json.dumps(scenario.json_schema(), indent=2, ensure_ascii=False) + "\n"
    if out is None:
        print(text, end="")
        return 0
    files.write_text(out, text)
    print(f"Written: {out}. Editors take it with the line `#:schema {out.name}` on top of a "
          "scenario beside it.")  # fmt: skip
    return 0
