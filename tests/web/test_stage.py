"""When the stage shows the next state, by the clock alone; what it does of what it is told."""

from types import SimpleNamespace

import pytest

from innervate.web import stage as stages
from innervate.web.errors import Refused
from innervate.web.history import LOG, History
from innervate.web.stage import STATES_PER_S, WAITING_MAX, Stage, next_due

STEP_S = 1 / STATES_PER_S


@pytest.mark.parametrize(("late_s", "after_s"), [
    (0.0, STEP_S), (0.5 * STEP_S, STEP_S), (2.0 * STEP_S, STEP_S), (3.0 * STEP_S, 2.0 * STEP_S),
    (1.0, 1.0 - STEP_S), (-STEP_S, STEP_S),
])  # fmt: skip
def test_who_is_late_once_may_be_early_once(late_s, after_s):
    due = 100.0
    assert next_due(due, due + late_s) == pytest.approx(due + after_s)


def test_over_time_there_are_no_more_than_so_many():
    due = shown = 0.0
    for _ in range(300):
        shown = max(due, shown + 0.001)  # shown as soon as it is due
        due = next_due(due, shown)
    assert due == pytest.approx(300 * STEP_S)


class Told:
    """A source of numbers, which keeps what is done to it."""

    def __init__(self):
        self.history, self.scenes, self.shows = History(), 1, [1]
        self.done, self.closed, self.raises, self.refuses = [], 0, None, False

    def scene(self):
        return {"nodes": self.scenes}

    def fields(self):
        return {"number": self.shows[-1]}

    def work(self):
        if self.raises:
            raise self.raises
        return 0.0

    def carry_out(self, command):
        self.done.append(command)
        if self.refuses:
            raise Refused("not now")
        return {"type": "saved"} if command == "save" else None

    def close(self):
        self.closed += 1


@pytest.fixture
def stage():
    shown, ended = [], []
    made = Stage(Told(), shown.append, ended.append)
    made.shown, made.ended = shown, ended
    return made


def test_commands_are_carried_out_in_their_order_and_answered(stage):
    answers = []
    assert not stage._obey()
    stage.submit("cut", answers.append)
    stage.submit("save", answers.append)
    assert stage._obey()
    assert (stage.source.done, answers) == (["cut", "save"], [{"type": "saved"}])
    stage.source.refuses = True
    stage.submit("heal", answers.append)
    assert stage._obey()
    assert answers[1:] == [{"type": "error", "text": "not now"}]
    assert not stage._obey()


def test_only_so_many_commands_wait(stage):
    for _ in range(WAITING_MAX):
        stage.submit("cut", print)
    with pytest.raises(Refused, match="too many commands wait"):
        stage.submit("cut", print)
    stage._obey()
    assert len(stage.source.done) == WAITING_MAX
    stage.submit("cut", print)


def test_what_is_new_is_shown_once(stage):
    assert stage._show()
    assert not stage._show()
    assert len(stage.shown) == 1
    stage.source.shows.append(2)
    assert stage._show()
    assert stage.shown[1].scene is stage.shown[0].scene
    stage.source.scenes = 2
    assert stage._show()
    assert stage.shown[2].scene is not stage.shown[0].scene
    stage.source.history.add(LOG, 0, {})
    assert stage._show()
    assert stage.newest is stage.shown[-1]
    assert not stage._show()


@pytest.mark.parametrize(
    ("error", "said"),
    [(OSError("it  broke\nin two"), "it broke in two"), (ValueError(), "ValueError")],
)
def test_who_cannot_go_on_is_shown_as_it_is_and_says_why(stage, error, said):
    stage.source.raises = error
    stage._run()
    assert (len(stage.shown), stage.ended) == (1, [said])


def test_what_is_done_is_shown_at_once_and_the_source_is_closed(stage, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(stages, "time", SimpleNamespace(monotonic=lambda: now[0]))
    looks = []

    def work():
        looks.append((len(stage.shown), len(stage.source.done)))
        stage.source.shows.append(len(looks))
        if len(looks) == 3:
            stage.submit("cut", print)
        if len(looks) == 6:
            now[0] += 2.5 / STATES_PER_S
        if len(looks) == 8:
            stage._stopping.set()
        return 0.0

    stage.source.work = work
    stage._run()
    # After the first it is not due; then something was done; then it is due.
    assert looks == [(0, 0), (1, 0), (1, 0), (1, 1), (2, 1), (2, 1), (3, 1), (3, 1)]
    assert stage.ended == []
    stage.stop()
    assert stage.source.closed == 1
