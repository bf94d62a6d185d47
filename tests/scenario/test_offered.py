"""What `innervate new` prints of a network of one's own: what is commented there can be had."""

import pytest

from innervate import scenario
from innervate.network import use
from tests.own import alone, made

__all__ = ["alone"]
PLACED = '    ("x", 0, 0, 1000, "dm", "east"),\n    ("y", 0, 0, 1000, "dm", "north"),\n'
TABLES = {"cables": 2, "channel": 2, "field": 3}
POKE = 'HAPPENINGS = {"poke": lambda node, value: (1, {"value": value})}\n'


def uncommented(text):
    """The template with all of its tables; comments behind a line stay."""
    return "".join(line.removeprefix("# ") for line in text.splitlines(keepends=True)[1:])


@pytest.mark.parametrize("medium", TABLES)
def test_all_that_a_template_offers_is_taken(alone, medium):
    own = made(alone / "mine", medium)
    (own.folder / "more.py").write_text(POKE)
    own.change(
        "network.py",
        '    fields="fields"',
        '    happenings="more:HAPPENINGS",\n    fields="fields"',
    )
    if medium == "field":
        own.change("fields.py", '    ("value", 0, 0, 255, "raw", "the news"),\n',
                   '    ("value", 0, 0, 255, "raw", "the news"),\n' + PLACED)  # fmt: skip
        own.change("fields.py", "GIVEN = (", 'PLACED = 2\nGIVEN = ((2, {"x": 1, "y": 2}), ')
    use(own.folder)
    text = scenario.template("mine")
    plan = scenario.plan(scenario.loads(uncommented(text)))
    assert text.count("# [[") == TABLES[medium]
    assert [one.kind for one in plan.inputs] == [1] * 5  # a place is nothing that users hand in
    assert len(plan.faults) == 1
    assert "poke of a node, with value" in text
    assert ("it is told where it is: on_input, kind 2" in text) == (medium == "field")
    if medium == "field":
        assert [walk.node for walk in plan.walks] == [1]
    poked = uncommented(text).replace('"kill"', '"poke"').replace('"cut"', '"poke"')
    poked = poked.replace('link = "n0-n1"', "node = 1")
    assert len(scenario.plan(scenario.loads(poked)).inputs) == 6
