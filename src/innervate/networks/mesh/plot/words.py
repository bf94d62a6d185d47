"""Packets, reports and events of a mesh in plain words."""

from collections.abc import Mapping
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.network import takeovers
from innervate.networks.mesh.protocol import constants as c
from innervate.plot.words import figure_words, interrupted, ms_words, share_words
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE

PACKETS = {
    c.REQUEST: "a discovery request",
    c.RESPONSE: "a discovery response",
    c.TABLE: "a part of a table",
    c.TABLE_ACK: "an ack of a table",
    c.ACTIVATE: "an activation",
    c.DATA: "a message",
    c.E2E_ACK: "an end-to-end ack",
    c.ALARM: "an alarm",
    c.POSITION: "a robot's beacon",
    c.GRAPH: "a part of the graph",
    c.ACK: "an ack of a hop",
}
TIMERS = {
    c.TX: "a frame is due",
    c.ACK_WAIT: "a hop did not acknowledge",
    c.ROUND: "next step of its discovery round",
    c.TICK: "tick",
    c.RETRY: "an end-to-end timeout",
    c.JOBS: "a table was not acknowledged",
}
HANDED = {
    c.MESSAGE: "was offered a message",
    c.SENT: "its frame has left",
    c.SAMPLE: "learned where it is",
}
REPORTS = {
    c.REPORT_ACCEPTED: "message accepted",
    c.REPORT_HOP: "message taken by its first hop",
    c.REPORT_ARRIVED: "message acknowledged end to end",
    c.REPORT_EXPIRED: "message given up",
    c.REPORT_FULL: "message refused",
    c.REPORT_DROPPED: "packet dropped on its way",
    c.REPORT_SUSPECT: "neighbour does not answer",
    c.REPORT_ROUND: "discovery round begun",
    c.REPORT_GRAPH: "graph made of a round",
    c.REPORT_TABLE: "table in force",
    c.REPORT_TABLES: "all tables of a version acknowledged",
    c.REPORT_GATEWAY: "gateway followed",
    c.REPORT_ALARM: "alarm raised",
    c.REPORT_MARGIN: "margin of an alarm",
    c.REPORT_UNKEYED: "message of an unknown type",
    c.REPORT_SILENCED: "alarm flooded again",
}
ALARMS = {c.PREDICT: "about to cross", c.CROSS: "crossed", c.LOST: "lost", c.CLEAR: "inside again"}


def fault_words(plan: Any, fault: Any) -> str:
    """An event of the scenario: "node n3 switched off"."""
    name = plan.names[fault.node]
    if fault.action in (CUT, RESTORE):
        verb = "cut" if fault.action == CUT else "restored"
        return f"link {name} - {plan.names[fault.other]} {verb}"
    return {
        KILL: f"node {name} switched off",
        REVIVE: f"node {name} switched on",
        RESTART: f"node {name} restarted",
        JAM: f"noise of {fault.value / 100:g} dBm at node {name}",
        QUIET: f"no noise at node {name} any more",
    }[fault.action]


def opening(summary: Mapping[str, Any]) -> str:
    """What ran: "name: 30 nodes, 118 good links"; of several clusters, which one."""
    part = ""
    if "cluster" in summary:
        of = summary["cluster"]
        part = f"cluster {of['number']} of {of['of']}, {of['nodes']:,} nodes in all; here "
    nodes, links = number_of(summary["nodes"], "node"), number_of(summary["links"], "good link")
    return f"{summary['name']}: {part}{nodes}, {links}"


def sentences(result: Any, summary: Mapping[str, Any]) -> list[str]:
    """What happened, for somebody who knows nothing of it; alarms first, they matter most."""
    return [
        *_alarms(summary["alarms"]),
        *_false(summary["alarms"]),
        *_undecided(sum(crossing.open for crossing in all_crossings(result))),
        *_messages(summary),
        *_uncounted(summary["messages"]),
        *_discovery(summary["discovery"], summary["nodes"], result.plan.params["mode"]),
        *_gateways(result.plan, summary),
        _trouble(summary),
        *interrupted(summary),
    ]


def _alarms(alarms: Mapping[str, Any]) -> list[str]:
    sent, came = alarms["sent"], alarms["delivered"]
    if not sent:
        return []
    crossings = number_of(sent, "crossing")
    if not came:
        return [f"{crossings} of the fence, and the monitor learned of none."]
    latency, overrun = ms_words(alarms["latency_ms"]["max"]), alarms["overrun_m"]["max"]
    slowest = "the alarm took" if came == 1 else "the slowest alarm took"
    if came < sent:
        return [
            f"{crossings} of the fence, and the monitor learned of {came:,}; {slowest} {latency}, "
            f"a robot got {figure_words(overrun, 2)} m out."
        ]
    many = "of it" if sent == 1 else "of all"
    return [
        f"{crossings} of the fence, and the monitor learned {many}: {slowest} {latency}, "
        f"no robot got farther out than {figure_words(overrun, 2)} m by then."
    ]


def _false(alarms: Mapping[str, Any]) -> list[str]:
    """Alarms of robots that were inside; folders of older versions do not say."""
    false = alarms.get("false", 0)
    if not false:
        return []
    were = "was false, of a robot that was" if false == 1 else "were false, of robots that were"
    rate = figure_words(alarms["false_per_hour"], 2)
    return [f"{number_of(false, 'alarm')} {were} inside: {rate} per robot and hour."]


def _undecided(count: int) -> list[str]:
    """Crossings that no figure and no headline has in it: a robot may well be outside."""
    if not count:
        return []
    them = "it" if count == 1 else "them"
    return [f"Not counted: {number_of(count, 'crossing')} too shortly before the end to say that "
            f"the monitor never learned of {them}."]  # fmt: skip


def _messages(summary: Mapping[str, Any]) -> list[str]:
    decided, latency = summary["messages"]["counted"], summary["latency_ms"]
    ratio = summary["delivery_ratio"]
    if ratio is None:
        return []
    came = round(ratio * decided)
    missing = decided - came
    begin = f"{number_of(decided, 'message')}: "
    if not missing:
        begin += "every one was delivered"
    else:
        begin += f"{came:,} delivered ({share_words(ratio)})"
    if latency["p50"] is not None:
        begin += f", half within {ms_words(latency['p50'])}, 99 % within {ms_words(latency['p99'])}"
    return [begin + ".", *_apart(decided, came, summary["connected"])]


def _apart(decided: int, came: int, joined: Mapping[str, Any]) -> list[str]:
    """How many of the messages that did not come had no good links to come by, or nobody there.

    Some come all the same, over links that are not good.
    """
    apart = decided - joined["sent"]
    lost = apart - (came - joined["delivered"])
    if not lost:
        return []
    if lost < apart:
        said = (f"{lost:,} of the {apart:,} whose sender and recipient no good links joined, or "
                "of which one was off, did not come")  # fmt: skip
    elif joined["sent"]:
        said = f"Of those, {apart:,} had no chance: sender and recipient were not connected, or off"
    else:
        return ["None had a chance: sender and recipient were not connected, or off."]
    if joined["sent"]:
        ratio = joined["delivery_ratio"] or 0.0
        said += f"; of the others {share_words(ratio)} were delivered"
    return [f"{said}."]


def _uncounted(messages: Mapping[str, Any]) -> list[str]:
    """Messages that no ratio and no headline has in it."""
    off = messages["sender_off"]
    young = messages["offered"] - off - messages["counted"]
    said = []
    if off:
        said.append(f"{number_of(off, 'message')} of nodes that were off")
    if young:
        said.append(f"{number_of(young, 'message')} offered too shortly before the end")
    return [f"Not counted: {', '.join(said)}."] if said else []


def _discovery(found: Mapping[str, Any], nodes: int, mode: int = c.TABLES) -> list[str]:
    if found["recall"] is None:
        return ["No discovery round was completed."]
    line = (
        f"The first round found {share_words(found['recall'])} of the good links "
        f"within {figure_words(found['complete_s'])} s"
    )
    its, one = ("the graph", "the graph") if mode == c.WHOLE_GRAPH else ("its table", "a table")
    all_, count = found["with_tables"] == nodes, found["with_tables"]
    if found["tables_s"] is not None:
        who = f"every node had {its}" if all_ else f"{count:,} of {nodes:,} nodes had {one}"
        line += f"; {who} {figure_words(found['tables_s'])} s after the first request"
    elif count is not None:
        line += f"; {count:,} of {nodes:,} nodes got {one}"
    return [line + "."]


def _gateways(plan: Any, summary: Mapping[str, Any]) -> list[str]:
    led = summary["gateways"]
    if len(led) < 2:
        return []
    took, back = takeovers(plan.faults, led).get(len(led) - 1), led[-1]["node"] == led[-2]["node"]
    line = f"Node {plan.names[led[-1]['node']]} became gateway{' again' if back else ''} at "
    line += f"{led[-1]['at_s']:.3f} s"
    died = "it had died" if back else "the old one died"
    after = f"; its tables were everywhere {figure_words(took)} s after {died}" if took else ""
    return [f"{line}{after}."]


def _trouble(summary: Mapping[str, Any]) -> str:
    doubled, looped = summary["duplicates"], summary["looped"]
    first = f"{number_of(doubled, 'message')} came twice" if doubled else "No message came twice"
    second = number_of(looped, "packet") if looped else "none"
    return f"{first}; {second} met a node twice on the way."
