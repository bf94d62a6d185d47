"""Makes the folder that a maker copies to a board.

`python -m boards [NETWORK] [FOLDER] [name=value ...]`: a cell of the skin if no network is named,
into build/board if no folder is; names are parameters of the protocol (of the skin see
docs/skin.md), which all nodes must share. Made again, a main.py that was changed stays as it is.
"""

from __future__ import annotations

import sys
from pathlib import Path

from boards import join, records
from boards.compile import mpy
from boards.errors import BoardMissing
from boards.parity.record import part, plan_of
from boards.roles import kind_of, roles_or_told
from innervate.folders import not_for_boards
from innervate.live.board import Program, Role
from innervate.live.errors import LiveError
from innervate.live.parameters import check_parameters, settings_of
from innervate.network import networks

HERE = Path(__file__).resolve().parent / "micropython"
MAIN = "main.py"  # the maker's, once he has changed it
ROOM = Path(__file__).resolve().parent.parent / "src"


def program_of(role: Role) -> Program:
    """What a maker's board runs.

    Raises:
        LiveError: there is no driver for it.
    """
    if role.program is None:
        if networks()[kind_of(role)].medium == "channel":
            what = "a board's UARTs do not tell when others send"
            raise LiveError(f"{role.name} is on a channel: {what}; there is no driver for it")
        known = "the skin and networks of your own over cables or a field have one"
        raise LiveError(f"{role.name}: there is no driver for boards; {known}")
    return role.program


def files_of(role: Role, params: dict[str, int]) -> dict[str, bytes]:
    """Path and content of everything that a node needs; main.py stays readable.

    Raises:
        LiveError: there is no driver for it.
    """
    program = program_of(role)
    if why := not_for_boards(networks()[kind_of(role)]):
        raise LiveError(why)
    sources = {
        "node": join.fixed(join.joined(role.entry, noted=role.noted), params),
        "records": records.module_source(
            params, State=role.state, Params=role.params, Frame=role.frame
        ),
        **{name: (HERE / f"{name}.py").read_text() for name in program.drivers},
        **{f"innervate/{n}": (ROOM / f"innervate/{n}.py").read_text() for n in program.sources},
    }
    if program.node:
        file, _, kind = program.node.partition(":")
        sources["carrier"] = f"from {file} import {kind} as Node\n"
    network = networks()[kind_of(role)]
    if network.has("frames") and network.has("protocol"):
        frames, timers = network.frames, network.protocol.TIMERS
        sources["layouts"] = (
            f"LAYOUTS = {frames.LAYOUTS!r}\nKIND_BITS = {frames.KIND_BITS}\n"
            f"TIMERS = {timers}\nROOM = {role.room}\n"
        )
    made = {f"{name}.mpy": mpy(text, name.rpartition("/")[2]) for name, text in sources.items()}
    return {**made, MAIN: (HERE / f"{program.main}.py").read_bytes()}


def numbers_of(role: Role, arguments: list[str]) -> dict[str, int]:
    """`name=value` as parameters.

    Raises:
        LiveError: not of this form, no such parameter, or out of its range.
    """
    changes = settings_of(arguments, role.params)
    program_of(role)
    if role.parameters:
        made: dict[str, int] = part(role.parameters)(changes, "boards")
        return made
    check_parameters(changes, role.params, "boards")
    return {**plan_of(role).params, **changes}


def main(arguments: list[str]) -> int:
    """The command; its exit code."""
    if (known := roles_or_told()) is None:
        return 2
    words = [argument for argument in arguments if "=" not in argument]
    if words == ["--help"]:
        print(__doc__)
        return 0
    if options := [word for word in words if word.startswith("-")]:
        print(f"{options[0]}: no such option; see --help", file=sys.stderr)
        return 2
    named = words.pop(0) if words and words[0] in known else next(iter(known))
    if len(words) > 1:
        text = f"{words[0]} {words[1]}: a network ({', '.join(known)}), then one folder is enough"
        print(text, file=sys.stderr)
        return 2
    folder, role = Path(words[0] if words else "build/board"), known[named]
    try:
        files = files_of(role, numbers_of(role, [a for a in arguments if "=" in a]))
    except (LiveError, BoardMissing) as error:
        print(error, file=sys.stderr)
        return 2
    if (
        folder.exists()
        and not (folder / "node.mpy").exists()
        and (not folder.is_dir() or any(folder.iterdir()))
    ):
        print(f"{folder}: not empty and not made by this command; name another", file=sys.stderr)
        return 2
    try:
        _write(folder, files)
    except OSError as error:
        print(f"{error.filename}: cannot be written: {error.strerror}", file=sys.stderr)
        return 2
    print(f"{folder}: {len(files)} files, {sum(map(len, files.values()))} bytes")
    print(f"copy it: mpremote cp -r {folder}/. : + reset")
    return 0


def _write(folder: Path, files: dict[str, bytes]) -> None:
    """Write all but a main.py that its maker has changed, and leave alone what else is his."""
    own, ours = folder / MAIN, [path.read_bytes() for path in HERE.glob("*main.py")]
    is_his = own.exists() and own.read_bytes() not in ours
    for name, content in files.items():
        if name == MAIN and is_his:
            print(f"{own} is yours, and stays as it is")
            continue
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
