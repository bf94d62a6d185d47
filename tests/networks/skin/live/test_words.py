"""What goes in and out at the ends of a live skin, in words and within its ranges."""

import pytest

from innervate import scenario
from innervate.live.build import build
from innervate.live.machine import Machine, on
from innervate.live.nodefile import load
from innervate.networks.skin.live import words
from innervate.networks.skin.live.deployment import SkinDeployment
from innervate.networks.skin.live.items import RANGES, Frame, put
from innervate.networks.skin.live.node import CellNode, SinkNode, refuse_command
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.live.stack import CellStack, SinkStack
from innervate.networks.skin.protocol.constants import EVERYBODY, NONE, ONE
from tests.live import time_by_hand

CELL = {
    "role": "cell", "parent": 3, "dist": 2, "load": 9, "paths": [{"port": 0}, {"port": 1}],
    "ports": [{"port": 0, "path": None, "cabled": False}, {"port": 1, "path": 1, "cabled": True},
              {"port": 2, "path": None, "cabled": False}, {"port": 3, "path": 0, "cabled": True}],
}  # fmt: skip


def test_a_cell_and_the_pc_in_a_line():
    assert words.lines(CELL) == ["  to the PC: by port 0 (down), 2 hops, load 9"]
    assert words.lines({**CELL, "parent": None}) == ["  to the PC: no route, load 9"]
    assert words.lines({"role": "sink", "cells": [3, 1]}) == ["  cells per interface port: [3, 1]"]
    assert words.ports(CELL) == ["0 (down)", "1 (E)"]
    assert words.ports({"paths": [{"port": 0}, {"port": 4}]}) == ["0", "4"]


def test_a_sample_and_a_command_in_words():
    touch = {"cell": 5, "seq": 7, "hops": 2, "port": 1, "proximity": 99, "force": (1, 2, 3),
             "temperature": 9, "time_us": 1_000_001}  # fmt: skip
    said = words.touch_text(touch)
    assert said.endswith(
        ".000001 seq 7, 2 hops, interface 1, proximity 99, force 1 2 3 mN, 24.5 degC"
    )
    command = {"number": 8, "to_all": True, "code": 1, "value": 2, "hops": 3, "time_us": 0}
    assert "command 8 for all cells: code 1, value 2, 3 hops" in words.heard({"command": command})
    assert "for this cell" in words.command_text({**command, "to_all": False})
    assert words.heard({"touch": touch}) == said


@pytest.mark.parametrize("name", ["proximity", "force", "temperature", "accel"])
def test_values_are_within_the_ranges_of_their_fields(name):
    length, low, high = RANGES[name]
    item, count = Frame(), max(1, length)
    for value in (low, high):
        put(item, name, (value,) * count)
        assert getattr(item, name) == ([value] * count if length else value)
    for wrong in ((low - 1,) * count, (high + 1,) * count, (low,) * (count + 1), ()):
        with pytest.raises(ValueError, match=f"^{name} must be .*{low} to {high}$"):
            put(item, name, wrong)
    with pytest.raises(ValueError, match=r"^code must be"):
        put(item, "dist", (-1,), "code")


class Engine:
    """Keeps what is handed down."""

    def __init__(self):
        self.told = []

    def input(self, kind, item):
        self.told.append((kind, item))

    def stop(self):
        pass


class Clock(Machine):
    def time_ns(self):
        return 5_000_000_999


def pc(ports=2):
    made = SinkNode("pc", SinkStack(skin_parameters({}), ports), [])
    made.engine = Engine()
    return made


@pytest.mark.parametrize(("cell", "to"), [(None, EVERYBODY), (0, 0), (EVERYBODY - 1,) * 2])
def test_a_command_goes_to_a_cell_or_to_all_by_the_ports_that_have_some(cell, to):
    one = pc(3)
    one.stack.node.size[:] = [2, 0, 1]
    one.stack.node.own[0].command = 41
    assert one.send_command(255, 65_535, cell) == (41, 2, cell is None)
    ((_, item),) = one.engine.told
    assert (item.dist, item.proximity, item.cell) == (255, 65_535, to)
    assert one.outcomes == {"commands sent": 1}
    with pytest.raises(ValueError, match="leave it out for all"):
        one.send_command(1, 0, EVERYBODY)
    for wrong in ({"code": 1.5}, {"code": 1, "value": "2"}, {"code": 1, "cell": "c3"}):
        with pytest.raises(ValueError, match="are whole numbers"):
            one._asked_for_command(wrong)
    assert one._asked_for_command({"code": 1, "cell": 7}) == {
        "number": 41,
        "ports": 2,
        "checked": False,
    }
    assert one.send_command(3).checked
    assert [item.cell for _, item in one.engine.told] == [to, 7, EVERYBODY]
    assert [item.proximity for _, item in one.engine.told] == [65_535, 0, 0]
    with pytest.raises(ValueError, match="only the PC of a skin sends commands"):
        refuse_command({})


@pytest.mark.parametrize(("more", "most"), [
    ("number = 13\nnodes = 14\n", 12), ("number = 0\nnodes = 14\n", 13), ("number = 13\n", 65_534),
])  # fmt: skip
def test_a_pc_whose_file_says_how_many_there_are_refuses_cells_beyond(tmp_path, more, most):
    path = tmp_path / "pc.toml"
    link = '[[link]]\nkind = "udp"\nbind = "127.0.0.1:4701"\npeers = ["127.0.0.1:4702"]\n'
    path.write_text(f'kind = "skin"\nrole = "sink"\n{more}{link}')
    one = build(load(path))
    one.engine = Engine()
    one.send_command(1, 0, most)
    with pytest.raises(ValueError, match=f"cell must be 0 to {most}, not {most + 1}; leave it out"):
        one.send_command(1, 0, most + 1)
    assert one.outcomes == {"commands sent": 1}


def test_the_pc_of_a_plan_is_told_how_many_cells_there_are():
    plan = scenario.plan(scenario.load("loop-three", []))
    head, _ = SkinDeployment(plan).file(plan.graph.cells, [])
    assert head == {"role": "sink", "nodes": plan.graph.cells + 1}


def test_what_comes_in_is_told_with_the_time_of_who_receives_it():
    frame = Frame()
    frame.cell, frame.seq, frame.hops, frame.proximity, frame.temperature = 5, 6, 7, 8, 9
    frame.sq, frame.dist = 44, 3
    frame.force[:], frame.accel[:] = [1, 2, 3], [-4, 5, -6]
    heard = []
    with on(Clock()):
        one = pc()
        one.stack.port = 1
        one.receive_touch(heard.append)
        one._deliver(0, frame)
        cell = CellNode("c5", CellStack(5, skin_parameters({}), 1, [0, 1]), [])
        cell.receive_commands(heard.append)
        cell._deliver(0, frame)
        frame.cell = EVERYBODY
        cell._deliver(0, frame)
    frame.force[:] = [9, 9, 9]  # the record is used again
    for node in (one, cell):
        node.arrivals.hand_up()
    touch, alone, everybody = heard
    assert touch == (5, 6, 7, 1, 8, (1, 2, 3), 9, (-4, 5, -6), 5_000_000)
    assert alone == (44, 3, 8, False, 7, 5_000_000)
    assert everybody.to_all
    assert cell.command == 44
    assert (one.outcomes, cell.outcomes) == ({"samples received": 1}, {"commands received": 2})


def test_a_cell_says_which_ports_are_broken_and_where_its_way_leads():
    stack = CellStack(5, skin_parameters({}), 1, [3, 1])
    stack.node.parent, stack.node.own_load = 1, 6
    stack.node.dist[1], stack.node.pf[3], stack.node.pf[1] = 4, ONE, ONE - 1
    stack.node.child[3] = 1
    told = stack.status(0)
    assert (told["parent"], told["dist"], told["load"]) == (1, 5, 6)
    assert [(one["path"], one["cabled"], one["broken"]) for one in told["ports"]] == [
        (None, False, False), (1, True, False), (None, False, False), (0, True, True),
    ]  # fmt: skip
    assert [one["child"] for one in told["ports"]] == [False, False, False, True]
    stack.node.parent = NONE
    assert (stack.status(0)["parent"], stack.status(0)["dist"]) == (None, None)
    assert [stack.ports_of(port, None, 0) for port in range(4)] == [[], [1], [], [0]]


@pytest.mark.parametrize("rate_hz", [0.0, 4.0])
def test_a_cell_samples_at_its_rate_without_a_burst_when_it_was_late(rate_hz):
    async def main():
        cell = CellNode("c5", CellStack(5, skin_parameters({}), 1, []), [])
        cell.rate_hz = rate_hz
        times, loop = [], time_by_hand.asyncio.get_running_loop()
        async with cell:
            cell.sample = lambda **force: times.append(loop.time() - 1000)
            await time_by_hand.asyncio.sleep(1.1)
            passing = loop._passing
            passing.passed += 2.0  # the machine was busy
            await time_by_hand.asyncio.sleep(0.6)
        await time_by_hand.asyncio.sleep(5.0)
        return [round(one, 3) for one in times]

    found = time_by_hand.run(main())
    assert found == ([] if not rate_hz else [0.25, 0.5, 0.75, 1.0, 3.1, 3.1, 3.35, 3.6])
