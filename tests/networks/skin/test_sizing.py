"""How many interface ports a robot's skin needs: the iCub, and one arm of another maker."""

import json
from dataclasses import replace
from pathlib import Path

import polars
import pytest

from innervate import scenario
from innervate.cli import main
from innervate.networks.skin.plot.answer import ALONE, answer_lines, answer_record
from innervate.networks.skin.sizing import Question, judged, parse_ports, size
from innervate.sweeping import SweepError

pytest.importorskip("icub_models")
ICUB = "package:icub-models/iCubGenova02"
UR5 = "package:example-robot-data/ur5_robot"


def test_the_icubs_forearm_needs_more_ports_at_higher_rates():
    asked = Question(ICUB, "r_forearm_skin_*", (100.0, 1000.0), (1, 2, 3))
    answer = size(asked, repeat=4)
    assert (answer.cells, answer.frames) == (24, True)
    assert answer.carries[100.0] == 1
    assert answer.carries[1000.0] in (2, 3)
    fast = answer.table.filter(answer.table["rate_hz"] == 1000)
    # 24 cells send 24,000 samples a second, a cable carries 16,667 frames.
    assert fast["loss_cell_mean"][0] == pytest.approx(1 - 16_667 / 24_000, abs=0.05)
    assert fast["loss_cell_mean"].to_list() == sorted(fast["loss_cell_mean"], reverse=True)
    assert all(set(cells) <= {f"r_forearm_skin_{i}" for i in range(100)}
               for cells in answer.where.values())  # fmt: skip
    assert [len(cells) for cells in answer.where.values()] == [1, 2, 3]
    two = answer.table.filter(answer.table["ports"] == 2)
    assert all(0 < ms < 50 for ms in two["recovery_ms_pc_mean"])


def test_a_number_of_ports_is_enough_only_if_every_single_failure_heals():
    asked = Question("package:example-robot-data/go2", "*calf*", ports=(2, 3), pitch_mm=35.0)
    answer = size(asked, repeat=6)
    two, three = answer.table.iter_rows(named=True)
    assert (two["within"], two["enough"], two["isolated_max"]) == (True, False, 8)
    assert (three["within"], three["enough"], three["isolated_max"]) == (True, True, 0)
    assert answer.needed == {250.0: 3}
    lines = answer_lines(answer)
    assert "250 Hz: 3 ports are enough for 1 % lost" in lines[-3]
    once = replace(answer, sweep=replace(answer.sweep, plan=replace(answer.sweep.plan, repeat=1)))
    assert "250 Hz: 3 ports are enough in the one run made for 1 % lost" in answer_lines(once)[-4]
    assert (answer_lines(once)[-1], lines.count(ALONE)) == (ALONE, 0)
    assert answer_record(answer)["intervals"] is True
    assert "every single failure of a cable or cell heals" in lines[-3]
    assert lines[-2].startswith("With 2 ports 3 single failures cut off cells for good: cable ")
    assert "(8 cells)" in lines[-2]


def test_if_no_number_of_ports_heals_the_answer_says_who_isolates_whom():
    answer = size(Question(ICUB, "r_forearm_skin_*", (100.0,), (2,)), repeat=6)
    assert answer.needed == {100.0: None}
    lines = answer_lines(answer)
    begin = "100 Hz: none of the numbers of ports that were tried (2) is enough: 2 ports are enough"
    assert lines[-3].startswith(f"{begin} for 1 % lost")
    assert "cell r_forearm_skin_24 (3 cells)" in lines[-2]


def test_ports_of_the_variants_are_compared_on_the_same_seeds():
    answer = size(Question(ICUB, "r_forearm_skin_*", (100.0,), (1, 2)), repeat=2)
    pairs = answer.sweep.compare("body.interfaces", 1, 2, "data.sent")
    assert pairs["difference"].to_list() == [0, 0]


def test_an_arm_without_skin_gets_cells_on_its_surface(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    tokens = ("--links", "*arm_link", "--pitch", "60", "--rate", "250", "--ports", "1,3",
              "--repeat", "2", "--recovery", "500", "--workers", "1", "--out", "out")  # fmt: skip
    assert main(["size", UR5, *tokens]) == 0
    out = capsys.readouterr().out
    assert "cells 60 mm apart" in out
    assert "250 Hz: " in out
    assert Path("out/size.png").stat().st_size > 10_000
    assert main(["size", UR5, *tokens]) == 0  # nothing is run twice
    assert capsys.readouterr().out == out
    assert main(["size", UR5, *tokens, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (rate,) = found["rates"]
    assert f"250 Hz: {rate['ports']} port" in out
    assert len(rate["on"]) == rate["ports"]
    assert found["enough"] is True
    assert found["picture"] == "out/size.png"
    tables = scenario.loads(Path("out/scenario.toml").read_text()).model
    assert tables.body.pitch_mm == 60


def test_what_cannot_be_sized():
    with pytest.raises(SweepError, match=r'no link of .* matches "nono"'):
        size(Question(ICUB, "nono"))
    with pytest.raises(SweepError, match="install it with"):
        size(Question("package:no-such-robots/x", "a"))
    with pytest.raises(SweepError, match="whole numbers from 1"):
        parse_ports("0..2")
    assert parse_ports("4,1..2") == (1, 2, 4)


ROD = """<robot name="r"><link name="arm"><visual><geometry>{}</geometry></visual></link>
  <link name="hand"/>
  <joint name="j" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="{} 0 0"/>
  </joint></robot>"""


def rod(folder, shape='<box size="2.0 0.005 0.005"/>', hand_m=1):
    path = folder / "rod.urdf"
    path.write_text(ROD.format(shape, hand_m))
    return str(path)


def test_runs_that_fail_and_cells_that_stay_without_a_way_are_named(tmp_path, capsys):
    """A rod of 74 cells in a row: one port is too far away, and of two each without the other."""
    tokens = ("--links", "arm", "--pitch", "20", "--ports", "1,2", "--repeat", "1",
              "--workers", "1", "--out", str(tmp_path / "out"))  # fmt: skip
    assert main(["size", rod(tmp_path), *tokens]) == 1  # for a script: none of them is enough
    lines = capsys.readouterr().out.splitlines()
    assert "250 Hz: none of up to 2 ports is enough for 1 % lost, ways back in 50 ms." in lines
    assert ALONE in lines
    (wayless,) = (line for line in lines if line.startswith("250 Hz, 2 ports: in 1 run cells"))
    assert "protocol.max_depth" in wayless
    assert lines[lines.index("2 of 4 runs failed:") + 1].startswith("  2 x scenario.toml: arm_")
    assert main(["size", rod(tmp_path), *tokens, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert (found["enough"], found["cells"], list(found["failed"].values())) == (False, 74, [2])
    assert (found["repeat"], found["intervals"]) == (1, False)
    assert found["rates"] == [{"rate_hz": 250.0, "ports": None, "on": [],
                               "ports_but_for_single_failures": None}]  # fmt: skip
    assert [(row["ports"], row["failed"], row["unhealed"]) for row in found["tried"]] == [
        (1, 2, 0), (2, 0, 1)]  # fmt: skip


def test_what_fails_in_some_runs_is_not_enough(tmp_path):
    """A rod that is fine but for runs that failed, as when their workers died."""
    asked = Question(rod(tmp_path, '<box size="0.1 0.1 0.1"/>'), "arm", (100.0,), (2,), 50.0)
    answer = size(replace(asked, loss_max=1.0, recovery_ms_max=1e6), repeat=3)
    assert answer.carries == {100.0: 2}
    done = answer.sweep
    first = polars.Series("status", ["failed", *["done"] * (done.results.height - 1)])
    judged_ = judged(answer.question, replace(done, results=done.results.with_columns(first)),
                     answer.weak)  # fmt: skip
    assert judged_.select("failed", "within", "enough").rows() == [(1, False, False)]


@pytest.mark.parametrize(("question", "said"), [
    ({"reach_mm": 10.0}, r"--reach: cables of 10 mm leave out .*; --reach 1000 would join them"),
    ({"ports": (9, 7)}, "--ports: only 2 cells have a free port for 7 interfaces; ask for fewer"),
    ({"hand_m": 200}, r"rod\.urdf: cables of 200,200 mm would be needed to join the cells"),
    ({"hand_m": "1e308"}, 'the joint of link hand has xyz = "1e308 0 0"; it takes three numbers, '
                          r"from -1e\+06 to 1e\+06"),
    ({"links": "*nd.?"}, r'no link of rod\.urdf matches "\*nd\.\?"; it has 2: arm, hand'),
])  # fmt: skip
def test_mistakes_are_told_by_the_options(tmp_path, question, said):
    frames = ROD.replace("<visual><geometry>{}</geometry></visual>", "")
    path = tmp_path / "rod.urdf"
    path.write_text(frames.format(question.pop("hand_m", 1)))
    with pytest.raises(SweepError, match=said):
        size(Question(str(path), **{"links": "*", **question}), repeat=1)


def test_nothing_is_enough():
    asked = Question(ICUB, "r_forearm_skin_*", (1000.0,), (1,))
    lines = answer_lines(size(asked, repeat=2))
    assert "1000 Hz: none of up to 1 port is enough for 1 % lost, ways back in 50 ms." in lines
