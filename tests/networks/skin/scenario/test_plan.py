"""The plan: whole numbers, the same from the same seed."""

from __future__ import annotations

import pytest

from innervate.networks.skin.protocol import constants as skin_const
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.scenario import plan as skin_plan
from innervate.networks.skin.scenario.model import K_MAX
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.scenario.script import DELIVER, DETECT, DRAW, STEP_LOSE, TICK
from innervate.scenario import ScenarioError, load, loads, plan
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, LOSE, RESTART, RESTORE, REVIVE


def test_parameters_are_those_of_the_protocol(small: str) -> None:
    made = plan(loads(small))
    declared = {name: (low, high) for name, _, low, high, *_ in skin_fields.PARAMS}
    assert set(made.params) == set(declared)
    for name, value in made.params.items():
        assert isinstance(value, int)
        assert declared[name][0] <= value <= declared[name][1]


def params(text: str, *sets: str) -> dict[str, int]:
    return plan(loads(text, sets)).params


def test_parameters(small: str) -> None:
    made = params(small)
    assert made["beacon_us"] == 4000
    assert made["r_f"] == made["r_r"] == 280
    assert made["k"] == made["seq_every"] == 3
    assert made["skip_us"] == 2400
    assert made["hold_periods"] == 3 + 4 * 32
    assert made["balance_periods"] == 8 * 3
    assert made["gap_us"] == 500
    assert made["restart_us"] == 2_000_000
    assert (made["forward_min_us"], made["forward_max_us"]) == (0, 2000)
    assert params(small, "protocol.balancing=false")["balance_periods"] == 0
    assert params(small, "protocol.balance_periods=7")["balance_periods"] == 7
    assert params(small)["balance_rule"] == skin_const.BALANCE_EVEN
    assert params(small, "protocol.balance_rule=paper")["balance_rule"] == skin_const.BALANCE_PAPER
    for rule, number in (
        ("paper", skin_const.RULE_PAPER),
        ("paper-lax", skin_const.RULE_PAPER_LAX),
    ):
        assert params(small, f"protocol.rule={rule}")["rule"] == number
    assert params(small, "protocol.k=94")["seq_every"] == 5
    assert params(small, "protocol.m=1")["seq_every"] == 1
    assert params(small, "protocol.beacon_hz=30")["beacon_us"] == 33333


def test_no_skin_is_so_deep_that_a_turn_of_balancing_leaves_its_range(small: str) -> None:
    table = loads(small).model.protocol
    made = [skin_plan.parameters(table, depth)["balance_periods"] for depth in (8_191, 8_192)]
    assert made == [65_528, 65_535]


@pytest.mark.parametrize(
    ("r_f", "r_r", "whole"),
    [("0.55", "0.55", (462, 462, 2)), ("1e-9", "2", (1, 1680, 840)), ("2", "1e-9", (1680, 1, 1))],
)
def test_fractions_are_exact(small: str, r_f: str, r_r: str, whole: tuple[int, ...]) -> None:
    made = params(small.replace("k = 3", f"r_f = {r_f}\nr_r = {r_r}"))
    assert (made["r_f"], made["r_r"], made["k"]) == whole


def test_as_many_cells_as_data_frames_can_number_send_data(small: str, monkeypatch) -> None:
    cells = plan(loads(small)).graph.cells
    monkeypatch.setattr(skin_plan, "DATA_CELLS_MAX", cells)
    assert plan(loads(small, ["data.rate_hz=10"])).data_period_us == 100_000
    monkeypatch.setattr(skin_plan, "DATA_CELLS_MAX", cells - 1)
    with pytest.raises(ScenarioError, match=f"{cells} cells cannot send data"):
        plan(loads(small, ["data.rate_hz=10"]))


KEPT = [*range(1, 31), 32, 33, 34, 35, 37, 39, 40, 42, 45, 47, 50, 53, 56, 60, 65, 70, 77, 84, 94]


def test_a_port_is_broken_after_k_misses_or_k_is_refused() -> None:
    for k in range(1, K_MAX + 1):
        text = f'kind = "skin"\nprotocol.k = {k}\n[[link]]\na = "n"\nb = "pc"\n'
        if k in KEPT:
            made = params(text)
            assert made["k"] == k
            assert (k - 1) * made["r_f"] < 840 <= k * made["r_f"], k
        else:
            with pytest.raises(ScenarioError, match=f"protocol.k = {k} cannot be kept"):
                params(text)


def test_the_greatest_k_that_is_named_works_and_none_beyond_it_is_taken() -> None:
    assert max(KEPT) == K_MAX
    text = f'kind = "skin"\nprotocol.k = {K_MAX + 1}\n[[link]]\na = "n"\nb = "pc"\n'
    with pytest.raises(ScenarioError, match=f"protocol.k must be at most {K_MAX}, not {K_MAX + 1}"):
        params(text)


@pytest.mark.parametrize(("rate_hz", "period_us"), [
    ("0.01", 100_000_000), ("0.3", 3_333_333), ("1", 1_000_000), ("7", 142_857), ("250", 4_000),
])  # fmt: skip
def test_a_period_is_a_second_by_the_rate_to_the_microsecond(small, rate_hz, period_us):
    assert plan(loads(small, [f"data.rate_hz={rate_hz}"])).data_period_us == period_us


def test_timing_and_data(small: str) -> None:
    sets = ["timing.latency=per_frame", "data.rate_hz=30", "data.queue=3", "timing.drift_ppm=7"]
    made = plan(loads(small, sets))
    assert made.duration_us == 4_000_000
    assert (made.drift_ppm, made.latency_us, made.latency_per_frame) == (7, (80, 160), True)
    assert (made.data_period_us, made.queue_frames, made.wire_us) == (33333, 3, 60)
    assert not made.lock_step
    locked = plan(loads(small, ["timing.lock_step=true"]))
    assert locked.lock_step
    assert locked.drift_ppm == 0


def test_setup_1() -> None:
    made = plan(load("setup-1"))
    (fault,) = made.faults
    assert (fault.at_us, fault.action, fault.index) == (2_000_000, CUT, 0)
    assert made.graph.label_end(fault.end) == "pc.1"
    assert made.graph.label_end(made.graph.peer[fault.end]) == "p0 r10 c5 down"
    assert made.depth_max == 10


EVENTS = """
[[event]]
at_s = 3.0
action = "restore"
link = [{ row = 0, column = 0 }, "p0 r0 c1"]
[[event]]
at_s = 1.0
action = "cut"
cell = { row = 0, column = 0 }
port = "E"
[[event]]
at_s = 1.0
action = "kill"
cell = { patch = 0, row = 2, column = 3 }
[[event]]
at_s = 1.5
action = "revive"
node = "p0r2c3"
[[event]]
at_s = 1.5
action = "loose"
node = "pc.0"
loss = 0.35
[[event]]
at_s = 1.5
action = "lose"
node = "p0 r0 c0 down"
frames = 4
[[event]]
at_s = 1.6
action = "restart"
pc = true
[[event]]
at_s = 1.7
action = "restart"
cell = { row = 1, column = 1 }
"""


def test_events_in_order_of_time(small: str) -> None:
    made = plan(loads(small + EVENTS))
    got = [(f.at_us, f.action, f.end, f.node, f.loss_q15, f.frames, f.index) for f in made.faults]
    assert got == [
        (1_000_000, CUT, 1, -1, 0, 0, 2),
        (1_000_000, KILL, -1, 11, 0, 0, 3),
        (1_500_000, REVIVE, -1, 11, 0, 0, 4),
        (1_500_000, LOOSE, 48, -1, 11469, 0, 5),
        (1_500_000, LOSE, 3, -1, 0, 4, 6),
        (1_600_000, RESTART, -1, 12, 0, 0, 7),
        (1_700_000, RESTART, -1, 5, 0, 0, 8),
        (2_000_000, CUT, 49, -1, 0, 0, 0),
        (3_000_000, RESTORE, 1, -1, 0, 0, 1),
    ]


def random_events(*actions: tuple[float, str, str]) -> str:
    return "".join(
        f'[[event]]\nat_s = {at}\naction = "{action}"\nrandom = "{what}"\n'
        for at, action, what in actions
    )


def test_random_targets_come_from_the_seed(small: str) -> None:
    text = small + random_events((1.0, "cut", "link"), (1.5, "kill", "cell"))
    assert plan(loads(text, seed=5)).faults == plan(loads(text, seed=5)).faults
    cables = {plan(loads(text, seed=s)).faults[0].end for s in range(40)}
    assert len(cables) > 8
    graph = plan(loads(text)).graph
    assert all(end < graph.peer[end] < 4 * graph.cells for end in cables)
    more = random_events((0.5, "cut", "interface"))
    with_more = plan(loads(text + more, seed=5)).faults
    assert [f for f in with_more if f.index < 3] == plan(loads(text, seed=5)).faults


def test_random_repairs_mend_what_is_broken(small: str) -> None:
    cuts = [(0.1 * i, "cut", "link") for i in range(1, 6)]
    mends = [(2.5 + 0.1 * i, "restore", "link") for i in range(1, 6)]
    text = small + random_events(*cuts, *mends)
    for seed in range(10):
        faults = [f for f in plan(loads(text, seed=seed)).faults if f.index > 0]
        cut = {f.end for f in faults if f.action == CUT}
        assert len(cut) == 5
        assert {f.end for f in faults if f.action == RESTORE} == cut


def test_a_random_moment(small: str) -> None:
    text = small.replace("2.0", "[1.0, 1.004]")
    times = {plan(loads(text, seed=s)).faults[0].at_us for s in range(30)}
    assert len(times) > 25
    assert min(times) >= 1_000_000
    assert max(times) <= 1_004_000


def test_touch(small: str) -> None:
    sets = ["touch.path=[[1, 0, 10], [3, 20, 10]]", "touch.radius_mm=12.5", "touch.force_n=0.25"]
    touch = plan(loads(small, sets)).touch
    assert touch is not None
    assert (touch.radius_um, touch.force_mn) == (12500, 250)
    assert len(touch.x_um) == len(touch.y_um) == 4_000_000 // touch.step_us + 1
    at = [touch.x_um[t * 1_000_000 // touch.step_us] for t in range(5)]
    assert at == [0, 0, 10_000, 20_000, 20_000]
    assert set(touch.y_um) == {10_000}
    across = plan(loads(small + "[touch]\n")).touch
    assert across is not None
    assert across.x_um[0] == 0
    assert across.x_um[-1] == 49_000
    assert plan(loads(small)).touch is None


SCRIPT = """
kind = "skin"
[[link]]
a = "n1.2"
b = "pc.0"
[[link]]
a = "n1"
b = "n2"
[script]
steps = ["tick n1", "deliver n1->n2", "lose n2.0 -> n1", "detect n1.2", "draw 3", "tick pc",
    "deliver pc->n1"]
"""


def test_script() -> None:
    made = plan(loads(SCRIPT))
    got = [(step.action, step.node, step.end, step.value) for step in made.script]
    assert got == [
        (TICK, 0, -1, 0),
        (DELIVER, 1, 0, 0),
        (STEP_LOSE, 0, 4, 0),
        (DETECT, 0, 2, 0),
        (DRAW, -1, -1, 3),
        (TICK, 2, -1, 0),
        (DELIVER, 0, 8, 0),
    ]


def test_copies_of_a_patch() -> None:
    text = 'kind = "skin"\n[[patch]]\ncolumns = 6\nrows = 10\ncount = 5\ninterfaces_every = 2\n'
    made: Plan = plan(loads(text))
    assert made.graph.cells == 300
    assert made.graph.interfaces == 3
    assert [made.graph.patch_of(made.graph.peer[4 * 300 + i] // 4) for i in range(3)] == [0, 2, 4]
    cables = sum(1 for _ in made.graph.links())
    assert cables == 5 * (10 * 5 + 6 * 9) + 4 + 3


def test_cables_between_patches() -> None:
    made = plan(load("joined"))
    ends = {made.graph.label_end(a): made.graph.label_end(b) for a, b in made.graph.links()}
    assert ends["p0 r9 c1 down"] == "p1 r0 c1 up"
    assert len(made.faults) == 3
