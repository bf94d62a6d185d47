"""What running nodes say of themselves, as `innervate live status` prints it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from innervate.cli.errors import UserError
from innervate.live import status
from innervate.live.addresses import without_interface
from innervate.network import known

LOSSES = ("unsent", "dropped", "unplugged")  # a path's counters that somebody should see


def sockets(nodes: Sequence[str]) -> list[Path]:
    """The sockets of nodes by their names, or of all nodes of this user if none is named.

    Raises:
        UserError: no node runs here.
        LiveError: none of this name.
    """
    found = [status.find(name) for name in nodes] if nodes else status.sockets()
    if not found:
        where = f"no node runs here (folder {status.where()})"
        raise UserError(f"{where}; start one with: innervate live node FILE")
    return found


def headline(told: list[dict[str, Any]], silent: list[Path]) -> str:
    """Is all well with these nodes and those that do not answer, by their sockets, as pages say."""
    from innervate.analysis.headline import silent as nobody
    from innervate.web import live_known

    kinds = {one["kind"] for one in told}
    if len(kinds) > 1:
        return f"{' and '.join(sorted(kinds))} nodes: name those of one network to have it judged"
    found = nobody(len(silent), "node")
    if told:
        view = known(min(kinds)).live_view()
        stand_in = live_known.silent(view, told, silent).values()
        where = view.map(dict(enumerate([*told, *stand_in])))
        found = view.state(where, dict(enumerate(told))).headline()
    return f"{found.level}: {found.text}"


def broken(told: list[dict[str, Any]]) -> list[str]:
    """A line for each broken cable; of a cable between two of these nodes, one line for both."""
    found: dict[frozenset[str], list[str]] = {}
    for one in told:
        for path in one["paths"]:
            if path["broken"]:
                far = path.get("far", path["name"])
                ends = frozenset((path["own"] or f"{one['name']} {path['name']}", far))
                found.setdefault(ends, []).append(f"{one['name']} port {path['port']}")
    return [f"broken: {' - '.join(ends)}" for ends in found.values()]


def twins(told: list[dict[str, Any]]) -> list[str]:
    """A line for each number that several of these nodes have."""
    names: dict[tuple[str, int], list[str]] = {}
    for one in told:
        if "number" in one:
            names.setdefault((one["kind"], one["number"]), []).append(one["name"])
    return [f"number {number}: {' and '.join(both)} have it; in one network others take them for "
            "the same node" for (_, number), both in names.items() if len(both) > 1]  # fmt: skip


def lines(told: dict[str, Any]) -> list[str]:
    """A node's status, line by line."""
    from innervate.web.live_map import is_put_out

    words = known(told["kind"]).live_words
    key = ("sealed" if told["sealed"] else "no key") + ", in C" * (told.get("engine") == "c")
    found = [f"{told['name']}: {told['kind']} {told['role']}, up {told['up_s']:g} s, {key}"]
    state = told.get("state")
    if state is not None and state["trouble"]:
        since = "never" if state["written_s"] is None else f"{state['written_s']:g} s ago"
        found.append(f"  STATE NOT WRITTEN: {state['trouble']}; last {since}, to {state['file']}")
    for number, where in ((told.get("keys") or {}).get("twins") or {}).items():
        found.append(f"  TWO NODES HAVE NUMBER {number}: {where}")
    if is_put_out(told):
        found.append("  PUT OUT: its identity is revoked, and nobody answers it; enrol it anew")
    found += words.lines(told)
    for name, path in zip(words.ports(told), told["paths"], strict=False):
        heard = "never" if path["heard_s"] is None else f"{path['heard_s']:.1f} s ago"
        lost = "".join(f", {what} {count}" for what, count in path["counters"].items()
                       if count and what.startswith(LOSSES))  # fmt: skip
        is_up = "  BROKEN" if path["broken"] else "" if path["up"] else "  CUT HERE"
        far = path.get("far", "")  # where a name leads
        leads = f" ({far.removeprefix('udp ')})"
        if far in ("", without_interface(path["name"])):
            leads = ""
        found.append(f"  port {name}: {path['name']}{leads}, heard {heard}{lost}{is_up}")
    counts = ", ".join(f"{what} {count}" for what, count in told["counters"].items())
    return [*found, f"  {counts}"]
