"""Which packets count, how much time they fill, and what running stations say, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.radio.analysis import airtime, live, packets
from innervate.networks.radio.analysis.headline import timeout_us
from innervate.networks.radio.scenario.plan import parameters
from innervate.scenario.actions.channel import JOIN, KILL

SLOT_US = 208
PACKET = np.dtype([(name, np.int64) for name in ("node", "offered", "end", "slots", "receivers")])
ROWS = np.zeros(0, [("code", np.int64), ("time", np.int64), ("node", np.int64)])


def result(*rows, saturated=False, faults=(), ended_us=100_000, **plan):
    """A run of three stations whose packets are (node, offered, end, slots, receivers)."""
    given = {"arrivals": [[1_000], [2_000], []], "wanted": 0, "absent": [0, 0, 0],
             "scenario": None} | plan  # fmt: skip
    made = SimpleNamespace(
        plan=SimpleNamespace(saturated=saturated, faults=list(faults), stations=3,
                             params=parameters(25), **given),
        packets=np.array(list(rows), PACKET), rows=ROWS, ended_us=ended_us,
        counts={"completed": len(rows)},
        world=SimpleNamespace(radios=[SimpleNamespace(backlog=0, alive=1) for _ in range(3)]),
    )  # fmt: skip
    return made


def fault(action, at_us, node):
    return SimpleNamespace(action=action, at_us=at_us, node=node)


def test_successes_are_what_somebody_received_by_the_end_of_their_frame():
    made = result((0, 0, 30, 1, 1), (1, 0, 10, 1, 0), (2, 0, 20, 1, 2), (1, 0, 20, 1, 1))
    assert packets.successes(made)["node"].tolist() == [2, 1, 0]


@pytest.mark.parametrize(("count", "left_out"), [(9, 0), (10, 1), (19, 1), (20, 2), (0, 0)])
def test_in_saturation_a_tenth_is_left_out(count, left_out):
    rows = [(0, 0, i, 1, 1) for i in range(count)]
    assert len(packets.settled(result(*rows, saturated=True))) == count - left_out
    assert len(packets.settled(result(*rows))) == count


@pytest.mark.parametrize(("offered", "end", "counts"), [
    (100, 500, True), (100, 501, False), (799, 900, False), (800, 900, True), (500, 800, False),
])  # fmt: skip
def test_what_a_robot_that_was_off_kept_has_no_delay(offered, end, counts):
    off = [fault(KILL, 500, 1), fault(JOIN, 800, 1)]
    made = result((1, offered, end, 1, 1), (0, offered, end, 1, 1), faults=off)
    assert packets.timed(made)["node"].tolist() == ([1, 0] if counts else [0])


def test_traffic_is_told_from_what_was_offered():
    def kind(saturated, arrivals):
        return packets.traffic_of(
            SimpleNamespace(saturated=saturated, arrivals=arrivals, scenario=None)
        )

    assert kind(True, [[]]) == "saturated"
    assert kind(False, [[1], [2], []]) == kind(False, []) == "disaster"
    assert kind(False, [[1], [2, 3]]) == "poisson"


@pytest.mark.parametrize("kind", ["poisson", "disaster"])
def test_few_packets_are_no_disaster_where_the_scenario_says_otherwise(kind):
    few = {"kind": "radio", "stations": 3, "duration_s": 1.0,
           "traffic": {"kind": kind, **({"load": 1e-4} if kind == "poisson" else {})}}  # fmt: skip
    plan = scenario.plan(scenario.from_dict(few))
    assert max(map(len, plan.arrivals)) <= 1
    assert packets.traffic_of(plan) == kind


def test_the_first_offer_is_the_earliest():
    assert packets.first_offer_us(result()) == 1_000
    assert packets.first_offer_us(result(arrivals=[[], []])) == 0


def test_throughput_is_airtime_over_the_time_from_the_first_offer_to_the_last_success():
    rows = [(0, 0, 1_000 + 10 * SLOT_US, 5, 1), (1, 0, 1_000 + 20 * SLOT_US, 5, 1)]
    assert airtime.throughput(result(*rows)) == pytest.approx(10 / 20)
    # Somebody still waits: then up to the end of the run.
    waiting = result(*rows, ended_us=1_000 + 40 * SLOT_US)
    waiting.world.radios[2].backlog = 1
    assert airtime.throughput(waiting) == pytest.approx(10 / 40)
    waiting.world.radios[2].alive = 0
    assert airtime.throughput(waiting) == pytest.approx(10 / 20)
    assert airtime.throughput(result()) is None
    busy = result(*rows, saturated=True, wanted=2, arrivals=[[], [], []])
    assert airtime.observed_until_us(busy) == 1_000 + 20 * SLOT_US
    busy.plan.wanted = 3
    assert airtime.observed_until_us(busy) == 100_000


def test_time_is_filled_where_packets_were_on_the_air():
    rows = [(0, 0, 4_000, 5, 1), (1, 0, 9_000, 5, 1), (1, 0, 9_000, 10, 1)]
    made = result(*rows, arrivals=[[0], [0], [0]])
    made.plan.params["slot_us"] = 200  # packets of 1, 1 and 2 ms; two in one frame
    steps = airtime.airtime_steps(made, 9, 0, 9_000)
    assert steps.time_us.tolist() == [1_000 * i for i in range(9)]
    assert steps.values == pytest.approx([0, 0, 0, 1, 0, 0, 1, 1, 1])
    assert airtime.airtime_steps(made, 3).values == pytest.approx([0, 1 / 3, 1])
    assert airtime.airtime_steps(result(), 2, 0, 10).values.tolist() == [0, 0]


def says(queued=0, accepted=0, delivered=0):
    return {"queued": queued,
            "counters": {"packets accepted": accepted, "packets delivered": delivered}}  # fmt: skip


def test_a_team_is_still_from_when_somebody_waits_and_nothing_comes():
    still = live.Still()
    assert still.note(1_000_000, [says(), says(1)]) == 0
    assert still.note(1_500_000, [says(), says(1)]) == 500
    assert still.note(1_700_000, [says(delivered=1), says(1)]) == 0
    assert still.note(1_900_000, [says(delivered=1), says(1)]) == 200
    assert still.note(2_000_000, [says(delivered=1), says(0)]) == 0
    assert still.note(2_100_000, [says(delivered=1), says(1)]) == 0  # only now does one wait again
    assert still.note(2_300_000, [says(delivered=1), says(1)]) == 200
    assert still.note(2_400_000, [{"counters": {}}]) == 0


def test_the_facts_of_running_stations_are_sums_of_what_they_say():
    params = parameters(25)
    told = {0: says(2, 10, 8), 1: says(0, 5, 5), 3: says(4, 6, 1)}
    found = live.of_stations(told, 4, (2, 3), 7.5, params)
    assert (found.stations, found.off, found.answering) == (4, (2, 3), True)
    assert (found.offered, found.delivered, found.abandoned) == (21, 14, 4)
    assert found.pending == 21 - 14 - 4
    assert found.still_ms == 7.5
    limit_ms = found.timeout_ms
    assert limit_ms == timeout_us(params, 4) / 1000 > 7.5
    assert found.waiting == ()
    assert live.of_stations(told, 4, (2, 3), limit_ms, params).waiting == ()
    assert live.of_stations(told, 4, (2, 3), limit_ms + 0.001, params).waiting == (0,)
    assert live.of_stations(told, 4, (), limit_ms + 1, params).waiting == (0, 3)
    nobody = live.of_stations({}, 2, (0, 1), 0.0, params)
    assert (nobody.answering, nobody.offered, nobody.pending) == (False, 0, 0)
