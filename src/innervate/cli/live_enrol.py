"""`innervate live enrol` and `revoke`: who is a node of a network, and who is one no more."""

import json
from pathlib import Path

from innervate.cli import errors
from innervate.cli.options import Json
from innervate.live import status
from innervate.live.errors import LiveError


def enrol(folder: Path, /, *numbers: int, nodes: int = 0) -> int:
    """Make identities: a file for each number, besides those below `nodes`.

    Args:
        folder: Of the network's authority; made if it is not there. Its authority.key stays with
            you.
        numbers: Of the nodes.
        nodes: Those with numbers 0 to nodes - 1, besides.
    """
    from innervate.live.enrolment import Authority

    wanted = list(dict.fromkeys([*range(nodes), *numbers]))
    if not wanted:
        raise errors.UserError("which nodes? name their numbers, or how many with --nodes")
    authority = Authority(folder)
    for number in wanted:
        authority.check(number)  # all of them, before the first is made
    if not authority.issued:
        errors.say(f"{folder} has a new authority; nodes that another one enrolled do not know "
                   "its nodes")  # fmt: skip
    for number in wanted:
        print(authority.enrol(number))
    return 0


def revoke(where: Path, /, *numbers: int, as_json: Json = False) -> int:
    """Put nodes out, and tell running nodes; 0 if one of them was told.

    Args:
        where: The authority's folder; or a revoked.list from it, to tell nodes on this machine.
        numbers: Of the nodes; none tells of the list as it is.
        as_json: Print JSON.
    """
    from innervate.live.enrolment import LIST, Authority, read_list

    if where.is_dir():
        authority = Authority(where)
        if not numbers and not authority.version:
            raise errors.UserError(f"{where}: nobody is put out; name the numbers of nodes")
        data = authority.revoke(list(numbers)).data if numbers else read_list(where / LIST)
    elif numbers:
        raise errors.UserError(f"{where}: no folder of an authority; only it can put nodes out")
    else:
        data = read_list(where)
    told, silent = [], []
    sockets = status.sockets()
    answers = status.ask_all(sockets, {"do": "revoke", "list": data.hex()})
    for socket, answer in zip(sockets, answers, strict=True):
        if isinstance(answer, LiveError):
            silent.append(str(answer))
        else:
            told.append({"node": socket.stem, **answer})
    if as_json:
        print(json.dumps({"told": told, "not": silent}))
    else:
        for line in silent:
            print(line)
        names = ", ".join(str(one["node"]) for one in told)
        file = where / LIST if where.is_dir() else where
        print(f"told {names}; nodes hand it on to each other" if told else
              f"told nobody: no node runs here that takes it; copy {file} to a machine where one "
              f"runs, and there: innervate live revoke {file.name}")  # fmt: skip
    return 0 if told else 1
