"""What a report says of a radio run in sentences, of figures that are written here."""

import re
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.radio.analysis.summary import summarize
from innervate.networks.radio.plot import report
from innervate.networks.radio.protocol.constants import REPORT_COLLISION
from innervate.networks.radio.sim.simulate import simulate
from innervate.scenario import from_dict, plan


def run_of(*arrivals, ended_us=2_000_000):
    return Of(plan=Of(arrivals=list(arrivals), params={"slot_us": 208}), ended_us=ended_us)


@pytest.mark.parametrize(("index", "split"), [
    (1.0, "shared evenly"), (0.9901, "shared evenly"), (0.99, "shared"), (0.9, "shared"),
    (0.8999, "shared unevenly"), (0.25, "shared unevenly"),
])  # fmt: skip
def test_how_evenly_the_time_was_shared(index, split):
    summary = {"stations": 4, "throughput": 0.038271, "jain": index}
    assert report._saturated(run_of(), summary) == (
        "4 robots always had something to send; delivered packets filled 3.83 % of the time, "
        f"{split} (Jain's index {index:.3f})."
    )


def test_where_nothing_was_delivered_nothing_was_shared():
    summary = {"stations": 4, "throughput": None, "jain": None}
    assert report._saturated(run_of(), summary).endswith("no packet was delivered in 2 s.")


@pytest.mark.parametrize(("arrivals", "delivered", "said"), [
    ([[5], [5]], 2, "2 robots started at once; every packet was delivered 100 slots (20.8 ms) later"
                    "."),
    ([[5], [], [1_005]], 1, "2 robots started within 1 ms; 1 packet was delivered within "
                            "100 slots (20.8 ms), 1 was not by the end of the run."),
    ([[5], [5], [5]], 1, "3 robots started at once; 1 packet was delivered within "
                         "100 slots (20.8 ms), 2 were not by the end of the run."),
    ([[9]], 1, "1 robot started; every packet was delivered 100 slots (20.8 ms) later."),
])  # fmt: skip
def test_how_a_disaster_ended(arrivals, delivered, said):
    offered = sum(map(len, arrivals))
    summary = {"offered": offered, "delivered": delivered, "duration_slots": 100, "duration_s": 3,
               "abandoned": 0}  # fmt: skip
    assert report._disaster(run_of(*arrivals), summary) == said
    off = summary | {"offered": offered + 1, "abandoned": 1}  # of a robot that has left, say
    assert report._disaster(run_of(*arrivals), off) == said
    none = report._disaster(run_of(*arrivals), summary | {"duration_slots": None})
    assert none.endswith("; no packet was delivered in 3 s.")


def test_a_disaster_to_which_nobody_came_in_time():
    summary = {"offered": 0, "delivered": 0, "duration_slots": None, "duration_s": 0.1,
               "abandoned": 0}  # fmt: skip
    assert report._disaster(run_of(), summary) == "No robot started in the 0.1 s of the run."


@pytest.mark.parametrize(("delivered", "median", "end"), [
    (0, None, "none was delivered."), (3, None, "60 % of them were delivered."),
    (5, 10, "100 % of them were delivered, half within 10 slots (2.08 ms)."),
])  # fmt: skip
def test_how_many_that_arrived_were_delivered(delivered, median, end):
    summary = {"stations": 2, "offered": 7, "abandoned": 2, "delivered": delivered,
               "delay_slots": {"p50": median}}  # fmt: skip
    said = report._arrivals(run_of(), summary)
    assert said == f"2 robots had 5 packets to send; {end}"


@pytest.mark.parametrize(("members", "struck", "said"), [
    ([1, 2], [0, 1], "There was one collision, of 2 frames."),
    ([3, 9, 4, 2], [1, 0, 1, 1], "There were 3 collisions, of up to 4 frames at once."),
])  # fmt: skip
def test_how_many_frames_met(monkeypatch, members, struck, said):
    found = Of(members=np.array(members), collision=np.array(struck, bool))
    monkeypatch.setattr(report.air, "groups", lambda _: found)
    monkeypatch.setattr(report.air, "taken_for_collided", lambda _: 0)
    assert report._collisions(None, {"collisions": sum(struck)}) == [said]
    assert report._collisions(None, {"collisions": 0}) == ["No packet collided with another one."]


@pytest.mark.parametrize(("mac", "taken"), [
    ("csma-cd-r", True), ("dcf", True), ("nonpersistent", True), ("polling", False),
])  # fmt: skip
def test_a_robot_alone_takes_its_transmissions_for_collided_and_the_report_says_why(mac, taken):
    """Every such row of the table is one of those that the sentence counts."""
    tables = {"kind": "radio", "duration_s": 0.4, "stations": 1, "packet_slots": 25,
              "protocol": {"mac": mac}}  # fmt: skip
    result = simulate(plan(from_dict(tables)), plain=True)
    rows = int(np.count_nonzero(result.rows["code"] == REPORT_COLLISION))
    said = report._collisions(result, {"collisions": 0})
    assert said[0] == "No packet collided with another one."
    assert bool(rows) == taken
    why = "a sender cannot tell a collision from an answer that is missing."
    sentence = f"{rows} transmissions that met no other robot's were taken for collided: {why}"
    assert said[1:] == ([sentence] if taken else [])


@pytest.mark.parametrize("mac", ["csma-cd-r", "csma-cd-d1", "csma-cd-d2", "tree"])
def test_nobody_takes_for_collided_what_met_nobody_where_all_hear_all(mac):
    tables = {"kind": "radio", "duration_s": 0.3, "stations": 4, "packet_slots": 25,
              "protocol": {"mac": mac}, "traffic": {"kind": "saturated"}}  # fmt: skip
    result = simulate(plan(from_dict(tables)), plain=True)
    assert np.count_nonzero(result.rows["code"] == REPORT_COLLISION)
    (said,) = report._collisions(result, {"collisions": summarize(result)["collisions"]})
    assert "at once" in said or "one collision" in said


@pytest.mark.parametrize(("count", "said"), [
    (0, "No packet was lost silently."),
    (1, "Lost silently: 1 packet that nobody received, taken for delivered by the sender."),
])  # fmt: skip
def test_what_nobody_knows_of(count, said):
    assert report._silence({"lost_silently": count}) == said


@pytest.mark.parametrize(("kind", "delivered", "said"), [
    ("disaster", 2, "3 robots started at once; 2 packets came through in the time."),
    ("disaster", 3, "3 robots started at once; every packet was delivered 123.5 slots later."),
    ("saturated", 3, "3 robots: packets filled 50 % of the time."),
])  # fmt: skip
def test_what_is_said_of_the_slotted_level(monkeypatch, kind, delivered, said):
    model = Of(protocol=Of(mac="tdma"), traffic=Of(kind=kind))
    run = Of(plan=Of(scenario=Of(model=model), params={"packet_slots": 5}))
    monkeypatch.setattr(report, "warnings", lambda _: [])
    summary = {"name": "n", "seed": 1, "headline": {"text": "", "level": "ok"}, "stations": 3,
               "delivered": delivered, "throughput": 0.5, "duration_slots": 123.46, "jain": 1.0,
               "collisions": 0}  # fmt: skip
    assert f"<p>{said}</p>" in report.slotted_top(run, summary)


def summary_of(**changes):
    return {"throughput": 0.5, "delay_slots": {"p50": 8.5, "p99": 131.0}, "jain": 0.25,
            "collisions": 1_200, "wall_s": 0.5, "events": 1_000, **changes}  # fmt: skip


@pytest.mark.parametrize(("changes", "left_out"), [
    ({}, 0), ({"throughput": None}, 1), ({"jain": None}, 1),
    ({"delay_slots": {"p50": None, "p99": None}}, 2),
])  # fmt: skip
def test_figures_are_of_what_is_known(changes, left_out):
    found = report._figures(run_of(), summary_of(**changes))
    assert len(found) == 6 - left_out
    assert found[-1][1].startswith("to simulate 2 s, ")
    assert found[-2] == ("1,200", "collisions")


def test_figures_are_in_their_order():
    found = report._figures(run_of(), summary_of())
    assert [one for one, _ in found[:4]] == ["50 %", "8.5 slots", "131 slots", "0.250"]
    assert found[1][1] == "median delay, 1.77 ms"  # 8.5 slots of 208 us


def test_what_happens_in_a_scene_is_listed_in_order_of_time(monkeypatch):
    """Frames begin and end, and stations report, from the scene's beginning to before its end."""
    monkeypatch.setattr(report.told, "report_words", lambda protocol, *what: f"{protocol} {what}")
    boxes = [
        Of(words=Of(name="data"), collided=True, start_us=1_000, end_us=1_520, station=1),
        Of(words=Of(name="CR-R"), collided=False, start_us=1_104, end_us=1_208, station=0),
    ]
    kinds = [(name, np.int64) for name in ("time", "node", "code", "a", "b")]
    rows = np.array([(999, 0, 9, 9, 9), (1_000, 0, 1, 2, 3), (1_519, 2, 4, 5, 6),
                     (1_520, 0, 9, 9, 9)], kinds)  # fmt: skip
    result = Of(rows=rows, plan=Of(protocol="p"))
    shown = Of(window=(1_000, 1_520, 896), boxes=boxes, slot_us=208)
    found = report._listing(result, shown)
    listed = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in found.split("<tr")[1:]]
    assert [row for row in listed if row] == [
        ["0.104", "0.50", "0", "p (1, 2, 3)"], ["0.104", "0.50", "1", "data (collides) begins"],
        ["0.208", "1.00", "0", "CR-R begins"], ["0.312", "1.50", "0", "CR-R ends"],
        ["0.623", "3.00", "2", "p (4, 5, 6)"], ["0.624", "3.00", "1", "data (collides) ends"],
    ]  # fmt: skip


def test_reports_and_what_became_of_frames_are_counted():
    rows = np.array([(999, 0), (999, 1), (998, 0)], [("code", np.int64), ("b", np.int64)])
    summary = {"frame_errors": 5, "partial": 0, "duplicates": 1}
    found = report._reports(Of(rows=rows), summary)
    assert re.findall(r"<td[^>]*>(.*?)</td>", found) == [
        "frame unreadable at one receiver", "5", "report 999", "2", "report 998", "1",
        "packet received a second time", "1"]  # fmt: skip
    none = dict.fromkeys(summary, 0)
    assert report._reports(Of(rows=rows[:0]), none) == ""
