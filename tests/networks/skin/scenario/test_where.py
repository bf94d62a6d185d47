"""An error in a list of cables is told at the cable, and at its end where that is known."""

import pytest

from innervate.networks.skin.scenario.plan import plan
from innervate.scenario import loads
from innervate.scenario.errors import ScenarioError

GOOD = [("n", "pc"), ("m", "n"), ("n", "o"), ("n", "p")]


@pytest.mark.parametrize(("links", "key", "line", "said"), [
    ([("n", "pc"), ("n..", "n")], "link.1.a", 8, "names no cell"),
    ([("n", "pc"), ("m", "pc.x")], "link.1.b", 9, "is no interface port"),
    ([*GOOD, ("q", "n")], "link.4.b", 21, "n has no port left"),
    ([*GOOD, ("n", "q")], "link.4.a", 20, "n has no port left"),
    ([("n", "pc"), ("m.1", "n.1"), ("o", "n.1")], "link.2", 11, "already cabled"),
    ([("n", "pc.2"), ("m", "n")], "link", 3, "nothing is on pc.0"),
    ([("n", "pc"), ("m", "o")], "", 0, "not connected to the PC; add a"),
])  # fmt: skip
def test_a_wrong_cable_is_told_where_it_stands(links, key, line, said):
    text = 'kind = "skin"\n\n'
    text += "".join(f'[[link]]\na = "{a}"\nb = "{b}"\n\n' for a, b in links)
    with pytest.raises(ScenarioError, match=said) as told:
        plan(loads(text))
    assert (told.value.key, told.value.line) == (key, line)
