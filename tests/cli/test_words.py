"""What commands say of running nodes, of sweeps under way and of this machine, line by line."""

import asyncio
import io
import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.cli import doctor, live, live_status, live_table, main
from innervate.cli.capturing import EVENT, Recorder
from innervate.cli.options import SendOptions, SweepOptions
from innervate.export import pcapng
from innervate.export.reading import Capture
from innervate.live import status

PATH = {"port": 0, "name": "udp b:1", "own": "udp a:1", "heard_s": 1.26, "broken": False,
        "up": True, "counters": {"received": 9, "unsent: full": 2, "dropped: framing": 0,
                                 "unplugged": 1}}  # fmt: skip
TOLD = {"name": "s1", "kind": "radio", "role": "station", "up_s": 12.5, "sealed": False,
        "place": 3, "queued": 0, "paths": [], "counters": {"frames": 4, "timers": 5}}  # fmt: skip


def test_a_node_without_trouble_has_few_lines():
    assert live_status.lines(TOLD) == [
        "s1: radio station, up 12.5 s, no key",
        "  place in the round: 3, packets queued 0", "  frames 4, timers 5",
    ]  # fmt: skip
    assert live_status.lines({**TOLD, "sealed": True, "engine": "c"})[0].endswith("sealed, in C")


def test_what_is_the_matter_with_a_node_is_said_in_capitals():
    state = {"trouble": "disk full", "written_s": None, "file": "n.state"}
    told = {**TOLD, "state": state, "keys": {"twins": {"7": "both are heard here"}}}
    assert live_status.lines(told)[1:3] == [
        "  STATE NOT WRITTEN: disk full; last never, to n.state",
        "  TWO NODES HAVE NUMBER 7: both are heard here",
    ]
    state["written_s"] = 0.0
    assert live_status.lines(told)[1].endswith("last 0 s ago, to n.state")
    state["trouble"] = ""
    assert "STATE" not in "".join(live_status.lines(told))


def test_who_is_put_out_is_told_so():
    for revoked, is_out in (([4], True), ([3], False), ([], False)):
        told = {**TOLD, "keys": {"identity": {"serial": 4, "list": 1, "revoked": revoked}}}
        said = "  PUT OUT: its identity is revoked, and nobody answers it; enrol it anew"
        assert (live_status.lines(told)[1] == said) == is_out


@pytest.mark.parametrize(
    ("change", "end"),
    [({}, ""), ({"up": False}, "  CUT HERE"), ({"broken": True, "up": False}, "  BROKEN"),
     ({"heard_s": None, "broken": True}, "  BROKEN")],
)  # fmt: skip
def test_a_path_is_told_with_what_it_lost(change, end):
    told = {**TOLD, "kind": "skin", "role": "sink", "cells": [1], "paths": [PATH | change]}
    heard = "never" if "heard_s" in change else "1.3 s ago"
    line = f"  port 0: udp b:1, heard {heard}, unsent: full 2, unplugged 1{end}"
    assert live_status.lines(told)[2] == line


def test_all_that_is_asked_of_a_sweep_reaches_it():
    asked = SweepOptions(
        vary=["a=1"],
        set_=["b=2"],
        repeat=3,
        seed=4,
        until=["c.ci=5%"],
        batch=6,
        paired=["a"],
        workers=7,
        engine="threads",
        dask="tcp://x:1",
        retry=True,
    )
    assert asked.planned == {"vary": ["a=1"], "overrides": ["b=2"], "repeat": 3, "seed": 4,
                             "until": ["c.ci=5%"], "batch": 6, "paired": ["a"]}  # fmt: skip
    assert asked.how == {"workers": 7, "kind": "threads", "dask": "tcp://x:1", "retry": True}
    nothing = {"vary": [], "overrides": [], "until": [], "paired": []}
    assert SweepOptions().planned == nothing | dict.fromkeys(("repeat", "seed", "batch"))
    assert not SweepOptions().how["retry"]


def test_figures_to_show_are_named_one_by_one_or_with_commas():
    assert SweepOptions(show=["a.b,c", "d, a.b,"]).shown == ("a.b", "c", "d")
    assert SweepOptions().shown == ()


def points(*states):
    return [SimpleNamespace(point=SimpleNamespace(index=i), done=done, finished=finished)
            for i, (done, finished) in enumerate(states)]  # fmt: skip


def shown(*states):
    return [one.point.index for one in live_table._interesting(points(*states))]


def test_of_many_points_those_at_work_and_the_last_that_ended_are_shown():
    most = live_table.ROWS_MAX
    assert shown(*[(0, False)] * most) == list(range(most))
    ended, at_work, waiting = (9, True), (1, False), (0, False)
    some = [ended] * most + [at_work] * 3 + [waiting] * 5
    assert shown(*some) == list(range(3, most + 3))
    assert shown(*[at_work] * (most + 4)) == list(range(most))
    one_more = [*[at_work] * most, ended]
    assert shown(*one_more) == list(range(most)), "who is at work goes first"
    assert shown(*[ended] * 2, *[waiting] * most) == [0, 1]


def test_means_and_how_many_there_will_be():
    assert live_table._mean([]) == "-"
    assert live_table._mean([2.0, 2.0]) == "2 +- 0"
    assert live_table._mean([9.0, 11.0]) == "10 +- 13"
    conducted = SimpleNamespace(plan=SimpleNamespace(until=()), done=3, total=9)
    assert live_table._about(conducted) == "9"
    conducted.plan.until = ("rule",)
    assert live_table._about(conducted) == "about 9"
    conducted.done = 9
    assert live_table._about(conducted) == "9"


@pytest.mark.parametrize(("left_s", "words"), [
    (0.999, ""), (1.0, ", about 1 s left"), (99.0, ", about 99 s left"),
    (100.0, ", about 2 min left"), (99 * 60.0, ", about 99 min left"),
    (100 * 60.0, ", about 2 h left"),
])  # fmt: skip
def test_time_that_is_left(left_s, words):
    assert live_table._left(SimpleNamespace(left_s=left_s)) == words


class Reader:
    """Lines that a node tells."""

    def __init__(self, *lines):
        self.lines = [json.dumps(line).encode() + b"\n" for line in lines] + [b""]

    async def readline(self):
        return self.lines.pop(0)


ABOUT = {"capturing": "n0", "kind": "mesh", "role": "node", "number": 0, "sealed": False,
         "paths": [[0, 0, "a", "b"], [1, 1, "a", "c"]]}  # fmt: skip


def recorded(made):
    """What stands in a recorder's capture: (ns, interface, flags, last byte, comment)."""
    made.file.seek(0)
    path = made.folder / "capture.pcapng"
    path.write_bytes(made.file.read())
    capture = Capture(path)
    return [(one.time_ns, one.interface, one.flags, one.data[-1:], one.comment)
            for one in capture.packets()]  # fmt: skip


@pytest.fixture
def recorder(tmp_path):
    made = Recorder([Path("n0"), Path("n1")], io.BytesIO())
    made.folder = tmp_path
    made.file.write(pcapng.section("comment", "innervate"))
    return made


def test_frames_are_taken_once_all_nodes_are_followed_and_written_in_order(recorder):
    numbers = recorder._announce(ABOUT)
    assert numbers == {0: 0, 1: 1}
    assert recorder._announce(ABOUT) == numbers, "its interfaces are known"
    early = {"frames": [[5, 0, True, "00", ""]], "missed": 2}
    asyncio.run(recorder._take_frames(Reader(early), numbers))
    assert (recorder.waiting, recorder.missed) == ([], 2)
    recorder.silent, recorder.since_ns = 0, 10
    lines = [
        {"frames": [[30, 1, False, "03", "crc"], [9, 0, True, "00", ""]], "missed": 0},
        {"frames": [[10, 0, True, "01", ""], [20, 0, False, "02", ""]], "missed": 1},
    ]
    asyncio.run(recorder._take_frames(Reader(*lines), numbers))
    recorder.waiting.append((15, 0, False, b"", EVENT + "node gone"))
    assert recorder.missed == 3
    recorder._write(20)
    assert [one[0] for one in recorder.waiting] == [30]
    assert recorder.frames == 2
    recorder._write(None)
    assert (recorder.waiting, recorder.frames) == ([], 3)
    assert recorded(recorder) == [
        (10, 0, pcapng.OUTBOUND, b"\x01", ""), (15, 0, pcapng.INBOUND, b"", "event: node gone"),
        (20, 0, pcapng.INBOUND, b"\x02", ""), (30, 1, pcapng.INBOUND, b"\x03", "dropped: crc"),
    ]  # fmt: skip


@pytest.fixture
def answers(monkeypatch):
    """What a node answers; and what it was asked."""
    said, asked = [], []
    monkeypatch.setattr(status, "find", lambda name: Path(name))

    def ask(where, request):
        asked.append(request)
        yield from said

    monkeypatch.setattr(status, "ask", ask)
    monkeypatch.setattr(status, "ask_one", lambda where, request: next(ask(where, request)))
    return said, asked


@pytest.mark.parametrize(
    ("states", "reliable", "to", "code", "lines"),
    [
        (["accepted", "next hop acked", "delivered", "never"], True, 2, 0, 3),
        (["accepted", "expired"], True, 2, 1, 2), (["refused"], True, 2, 1, 1),
        (["accepted", "never"], False, 2, 0, 1), (["accepted", "never"], True, 255, 0, 1),
        ([], True, 2, 1, 0),
    ],
)  # fmt: skip
def test_a_message_is_followed_to_its_end(answers, capsys, states, reliable, to, code, lines):
    said, asked = answers
    said += [{"state": state, "reason": "why" if state == "expired" else ""} for state in states]
    assert live.send("n0", to, "\u00e4", how=SendOptions(reliable=reliable)) == code
    out = capsys.readouterr().out.splitlines()
    assert len(out) == lines
    assert ("expired: why" in out) == ("expired" in states)
    assert asked == [{"do": "send", "to": to, "payload": "c3a4", "priority": False,
                      "reliable": reliable, "wait": reliable and to != 255}]  # fmt: skip


def test_so_many_messages_are_listened_to_and_missed_ones_are_said(answers, capsys):
    said, asked = answers
    said += [{"kind": "mesh", "listening": "n0"}, {"missed": 3}]
    said += [{"from": 1, "payload": b"m%d".decode().encode().hex()} for _ in range(5)]
    assert live.listen("n0", count=2, in_order=True) == 0
    shown = capsys.readouterr()
    assert shown.out.splitlines() == ["1: m%d"] * 2
    assert shown.err == "3 missed here: they were not read in time\n"
    assert asked[1] == {"do": "listen", "alarms": True, "in_order": True}
    live.listen("n0", as_json=True)
    shown = capsys.readouterr()
    assert len(shown.out.splitlines()) == 5
    assert "in_order" not in asked[3]


@pytest.mark.parametrize(
    ("ports", "cell", "words", "code"),
    [(1, None, "command 4 to all cells, by 1 interface port\n", 0),
     (2, 0, "command 4 to cell 0, by 2 interface ports\n", 0), (0, 3, "", 1)],
)  # fmt: skip
def test_a_command_that_is_sent_down(answers, capsys, ports, cell, words, code):
    said, asked = answers
    said.append({"number": 4, "ports": ports})
    assert live.command("pc", 1, 2, cell=cell) == code
    assert capsys.readouterr().out == words
    assert asked == [{"do": "command", "code": 1, "value": 2, "cell": cell}]
    assert live.command("pc", 1, 2, cell=cell, as_json=True) == code


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, ["nothing is compiled"]), ({"compiled": ["skin"]}, ["compiled loops in"]),
        ({"ready": ["skin"]}, ["came with the toolkit"]),
        ({"writable": False, "free_bytes": 1}, ["cannot be written", "nothing is compiled"]),
        ({"free_bytes": doctor.SMALL_BYTES - 1}, ["has little room left", "nothing is compiled"]),
        ({"free_bytes": doctor.SMALL_BYTES, "compiled": ["a"]}, ["compiled loops in"]),
    ],
)  # fmt: skip
def test_whether_runs_start_at_once(capsys, change, words):
    cache = {"folder": "/c", "writable": True, "free_bytes": 10**12, "compiled": [], "ready": []}
    doctor._tell_cache(cache | change)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(words)
    for line, said in zip(lines, words, strict=True):
        assert said in line


def test_the_commands_that_new_names_take_a_file_with_blanks(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "skin", "my skin.toml"]) == 0
    said = capsys.readouterr().out
    assert "`innervate check 'my skin.toml'`, run it with `innervate run 'my skin.toml'`" in said
