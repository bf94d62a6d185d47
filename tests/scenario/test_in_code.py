"""Scenarios that are built in code: `innervate.Skin`, `Radio`, `Mesh` and models of others."""

import tomllib

import pytest
from msgspec import structs

import innervate
from innervate import scenario as scenarios
from innervate.scenario.keys import Table
from innervate.sweeping import make_plan

SKIN = innervate.Skin(
    name="palm",
    duration_s=0.5,
    patch=[innervate.Skin.Patch(columns=4, rows=3)],
    interface=[innervate.Skin.Interface(row=0, column=0)],
    protocol=innervate.Skin.Protocol(k=3),
    event=[innervate.Skin.Event(at_s=0.2, action="cut", interface=0)],
)
SAME = """\
kind = "skin"
schema = 1
name = "palm"
duration_s = 0.5
seed = 1

[[patch]]
columns = 4
rows = 3

[[interface]]
row = 0
column = 0

[protocol]
k = 3

[[event]]
at_s = 0.2
action = "cut"
interface = 0
"""


@pytest.mark.parametrize("name", sorted(scenarios.bundled()))
def test_every_bundled_scenario_is_the_same_built_in_code(name):
    loaded = scenarios.load(name)
    assert innervate.load(loaded.model).model == loaded.model


def test_what_is_left_out_is_not_given():
    assert innervate.dump(SKIN) == SAME
    assert innervate.load(SKIN).model == scenarios.loads(SAME).model
    assert ("protocol", "balancing") not in innervate.load(SKIN).source.given


def test_keys_with_a_word_of_python_are_those_of_the_file():
    flow = innervate.Mesh.Flow(from_="all", to="gateway", every_s=1.0)
    text = innervate.dump(innervate.Mesh(nodes=9, flow=[flow]))
    assert 'from = "all"' in text
    assert scenarios.loads(text).model.flow == [flow]


def test_seed_and_overrides_go_before_what_was_built():
    made = innervate.load(SKIN, seed=9, overrides={"protocol.k": 7})
    assert (made.seed, made.model.protocol.k) == (9, 7)


def test_what_cannot_be_is_said_as_of_a_file():
    with pytest.raises(innervate.ScenarioError, match=r"patch\.0\.columns must be a whole number"):
        innervate.load(innervate.Skin(patch=[innervate.Skin.Patch(columns=-1, rows=2)]))
    with pytest.raises(TypeError, match="colums"):
        innervate.Skin.Patch(colums=1, rows=2)
    with pytest.raises(innervate.ScenarioError, match="the scenario has no kind"):
        innervate.load(innervate.Skin.Patch(columns=1, rows=2))


@pytest.mark.parametrize("model", [innervate.Skin, innervate.Radio, innervate.Mesh])
def test_every_table_of_a_model_can_be_built(model):
    """By a name beside it; tables within tables, too."""
    there = {value for value in vars(model).values()
             if isinstance(value, type) and issubclass(value, Table)}  # fmt: skip
    wanted, left = set(), [model]
    while left:
        named = [part for field in structs.fields(left.pop()) for part in parts(field.type)]
        left += [table for table in named if table not in wanted]
        wanted.update(named)
    assert there == wanted


def parts(hint):
    """The tables that a type speaks of."""
    if isinstance(hint, type) and issubclass(hint, Table):
        return {hint}
    return {table for inner in getattr(hint, "__args__", ()) for table in parts(inner)}


def test_a_sweep_of_it_has_its_name():
    given = scenarios.from_dict(tomllib.loads(SAME))
    assert {make_plan(one).name for one in (SKIN, tomllib.loads(SAME), given)} == {"palm"}
    assert make_plan("line").name == "line"


def test_a_sweep_takes_it_too():
    found = innervate.sweep(SKIN, vary={"protocol.k": [3, 4]}, workers=1)
    assert found.results["status"].to_list() == ["done", "done"]
    assert found.pandas()["protocol.k"].tolist() == [3, 4]
    assert found.numpy()["protocol.k"].tolist() == [3, 4]
    assert "protocol.k" in found._repr_html_()


def test_one_text_is_one_change_and_not_its_letters():
    assert innervate.load("line", overrides="protocol.k=9").model.protocol.k == 9
