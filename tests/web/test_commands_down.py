"""Commands that a page has the PC send down to the cells of a skin."""

import tomllib

import pytest

from innervate import run
from innervate.web import messages
from innervate.web.errors import Refused
from innervate.web.history import LOG
from tests.web.runs import SKIN, go_to, simulated

LAST = 29


def texts(made):
    history = made.history
    return [item.what["text"] for item in history.after(LOG, 0, history.newest, 1000)]


def test_a_command_is_seen_on_its_way_and_comes_to_its_cell_or_to_all():
    made = simulated(SKIN, speed=0.01)
    assert "command" in made.scene()["can"]
    go_to(made, 0.3)
    made.carry_out(messages.parse('{"do": "command", "node": 29, "code": 3, "value": 500}'))
    assert [one["kind"] for one in made.fields()["flights"]].count("command") == 2
    go_to(made, 0.31)
    first = int(made.fields()["told"][LAST])
    assert first > 0
    assert (made.fields()["told"][:LAST] == -1).all()
    made.carry_out(messages.Give(code=4))
    go_to(made, 0.33)
    assert (made.fields()["told"][: LAST + 1] == first + 1).all()
    said = "\n".join(texts(made))
    assert f"command {first} for p0 r4 c5" in said
    assert f"command {first} came to p0 r4 c5 after" in said
    assert f"command {first + 1} came to all 30 cells after" in said
    # Back before it, nothing of it has happened; on again, it happens again.
    go_to(made, 0.2)
    assert (made.fields()["told"] == -1).all()
    go_to(made, 0.33)
    assert (made.fields()["told"][: LAST + 1] == first + 1).all()


def test_what_was_sent_by_hand_is_saved_and_replayed():
    made = simulated(SKIN, command=[{"at_s": 0.1, "code": 9}])
    go_to(made, 0.25)
    made.carry_out(messages.Give(code=3, value=77, node=LAST))
    go_to(made, 0.4)
    made.carry_out(messages.Cut(0))
    made.carry_out(messages.Give(code=4))
    made.run_to_end()
    toml = made.carry_out(messages.Save())["toml"]
    told = tomllib.loads(toml)["command"]
    assert [(one["at_s"], one["code"]) for one in told] == [
        (0.1, 9), (pytest.approx(0.25, abs=1e-5), 3), (pytest.approx(0.4, abs=1e-5), 4),
    ]  # fmt: skip
    assert told[1]["cell"] == {"patch": 0, "row": 4, "column": 5}
    done = run(tomllib.loads(toml))
    assert done.summary["commands"]["sent"] == 3
    assert done.summary["fingerprint"] == made.engine.running.fingerprint


def test_wrong_commands_are_refused():
    made = simulated(SKIN)
    with pytest.raises(Refused, match="port of the PC"):
        made.carry_out(messages.Give(code=1, node=LAST + 1))
    for text in ('{"do": "command"}', '{"do": "command", "code": 256}',
                 '{"do": "command", "code": 1, "value": -1}'):  # fmt: skip
        with pytest.raises(Refused, match="not a command"):
            messages.parse(text)
