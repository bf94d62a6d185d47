"""What all views of simulated networks keep and tell of what is done to them."""

from types import SimpleNamespace

import pytest

from innervate.analysis.headline import OK, Headline
from innervate.scenario.actions import channel
from innervate.web import messages
from innervate.web.errors import Refused
from innervate.web.history import LOG, History
from innervate.web.view import Memory, View


def fault(at_us, takes=True, name="", **more):
    return SimpleNamespace(at_us=at_us, takes=takes, name=name or f"fault of {at_us}", **more)


class MadeUp(View):
    """A view of nothing."""

    def __init__(self, *faults):
        plan = SimpleNamespace(faults=faults)
        engine = SimpleNamespace(plan=plan, now_us=0, given=[], earliest_us=1, next_index=9)
        engine.add = engine.given.append
        super().__init__(engine, History())
        self.memory = Memory()

    def scene(self):
        return {}

    def note(self, rows):
        self.tell_faults()

    def points(self):
        return {"a": 1.0}

    def arrays(self, flights):
        return {"flights": flights}

    def headline(self):
        return Headline(OK, "All is well.")

    def words(self, fault):
        return fault.name

    def takes(self, fault):
        return fault.takes

    def cut(self, link, heal):
        return {"link": link, "heal": heal}

    def kill(self, node, revive):
        return {"node": node, "revive": revive}

    def make(self, at_us, index, fields):
        return SimpleNamespace(at_us=at_us, index=index, **fields)

    def event(self, fault):
        return {}


def told(view):
    return [(line.what["text"], line.what.get("mark"))
            for line in view.history.after(LOG, 0, 10_000, 100)]  # fmt: skip


def test_every_fault_is_told_once_when_its_moment_is_over_in_order_of_time():
    view = MadeUp(fault(0), fault(100), fault(300, takes=False))
    view.engine.given = [fault(50)]
    view.note({})
    assert told(view) == []  # nothing has happened at this moment
    view.engine.now_us = 100
    assert [one.at_us for one in view.tell_faults()] == [0, 50]
    view.engine.now_us = 101
    assert [one.at_us for one in view.tell_faults()] == [100]
    assert view.tell_faults() == []
    view.engine.given.append(fault(200))
    view.engine.now_us = 400
    assert [one.at_us for one in view.tell_faults()] == [200, 300]
    assert told(view) == [("fault of 0", "loss"), ("fault of 50", "loss"), ("fault of 100", "loss"),
                          ("fault of 200", "loss"), ("fault of 300", "return")]  # fmt: skip


def test_the_newest_that_took_something_away_is_what_is_recovered_from():
    view = MadeUp()
    assert not view.is_open
    view.begin_fault(fault(5, takes=False))
    assert (view.memory.recovery, view.memory.fault, view.memory.event_us) == (None, None, 5)
    view.begin_fault(fault(1_000_000))
    assert view.is_open
    view.begin_fault(fault(2_000_000, takes=False))
    assert not view.memory.recovery.closed  # it is not over
    view.memory.recovery.recovered_ms = 3.0
    assert not view.is_open
    assert not view.memory.recovery.closed
    view.begin_fault(fault(3_000_000, takes=False))
    assert view.memory.recovery.closed
    assert (view.memory.event_us, view.memory.fault.at_us) == (3_000_000, 1_000_000)
    view.engine.now_us = 4_500_000
    fields = view.fields(flights=True)
    assert (fields["since_cut_s"], fields["flights"]) == (3.5, True)
    assert fields["recovery"] == {"cause": "fault of 1000000", "at_s": 1.0, "detected_ms": None,
                                  "recovered_ms": 3.0, "apart": 0, "nobody": False}  # fmt: skip
    assert fields["headline"]["text"] == "All is well."
    view.begin_fault(fault(4_000_000))
    assert view.is_open
    assert view.fields(False)["since_cut_s"] == 0.5


def test_who_leaves_by_plan_is_no_failure():
    """A page said "since the last failure" of a robot's orderly leaving, and marked it in plots."""
    view = MadeUp()
    view.actions = channel.TABLE
    assert view.begin_fault(fault(5, action=channel.KILL, node=1))
    assert view.begin_fault(fault(9, action=channel.LEAVE, node=2))
    assert view.memory.fault.at_us == 5
    assert told(view) == [("fault of 5", "loss"), ("fault of 9", None)]


def test_of_what_goes_at_one_moment_the_first_is_named_and_the_others_counted():
    view = MadeUp(*(fault(5, name=f"node {i} switched off") for i in range(8)), fault(6))
    view.engine.now_us = 6
    view.tell_faults()
    assert view.fields(False)["recovery"]["cause"] == "node 0 switched off, and 7 more"
    view.engine.now_us = 7
    view.tell_faults()
    assert view.fields(False)["recovery"]["cause"] == "fault of 6"


def test_without_faults_nothing_is_recovered_from():
    fields = MadeUp().fields(False)
    assert (fields["recovery"], fields["since_cut_s"]) == (None, None)


def test_what_is_done_and_going_back_end_a_flood_of_lines():
    view = MadeUp()
    for calm in (lambda: view.begin_fault(fault(7)), lambda: view.forget(Memory())):
        for _ in range(20):
            view.log.often("lost", 1, "lost")
        assert told(view)[-1] == ("... and more of that", None)
        calm()
        view.log.often("lost", 1, "lost")
        assert told(view)[-1] == ("lost", None)
        view.log.calm()


def test_a_memory_can_be_gone_back_to_more_than_once():
    view = MadeUp(fault(10))
    view.engine.now_us = 20
    view.tell_faults()
    kept = view.remember()
    for _ in range(2):
        view.memory.recovery.recovered_ms = 5.0
        view.memory.told_us = 99
        view.forget(kept)
        assert (view.memory.recovery.recovered_ms, view.memory.told_us) == (None, 20)
    assert view.memory is not kept


@pytest.mark.parametrize(
    ("command", "fields"),
    [
        (messages.Cut(3), {"link": 3, "heal": False}),
        (messages.Heal(3), {"link": 3, "heal": True}),
        (messages.Kill(4), {"node": 4, "revive": False}),
        (messages.Revive(4), {"node": 4, "revive": True}),
    ],
)
def test_commands_are_faults_at_the_earliest_moment(command, fields):
    view = MadeUp()
    view.apply(command)
    assert [vars(one) for one in view.engine.given] == [{"at_us": 1, "index": 9, **fields}]


def test_what_is_no_fault_is_refused():
    view = MadeUp()
    with pytest.raises(Refused, match="not possible here"):
        view.apply(messages.Touch(0, 1))
    assert view.engine.given == []
