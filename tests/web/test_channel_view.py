"""A network of one's own on a channel, on the page."""

import pytest

from innervate import scenario
from innervate.web.errors import Refused
from innervate.web.messages import Cut, Kill, Revive
from innervate.web.simulated import Simulated
from tests.own import alone, made

__all__ = ["alone"]


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_its_nodes_are_shown_switched_off_and_on(alone):
    talk = made(alone / "talk", "channel")
    (talk.folder / "more.py").write_text(
        '"""More."""\n\n\ndef twice(node, params):\n    """Twice the value."""\n'
        '    return 2 * node.value\n\n\nSHOWS = {"twice": ("raw", twice)}\n'
    )
    talk.change("network.py", '    frames="frames",\n',
                '    frames="frames",\n    shows="more:SHOWS",\n')  # fmt: skip
    source = Simulated(scenario.plan(scenario.load(talk.scenario, ["event=[]"])))
    source.prepare()
    scene = source.scene()
    assert [node["label"] for node in scene["nodes"]] == [f"node {i}" for i in range(6)]
    assert scene["fields"][-1] == {"name": "twice", "unit": "raw", "meaning": "Twice the value."}
    source.do(Kill(2))
    with pytest.raises(Refused, match="off already"):
        source.do(Kill(2))
    with pytest.raises(Refused, match="no links"):
        source.do(Cut(0))
    assert source.fields()["node_up"].tolist() == [1, 1, 0, 1, 1, 1]
    source.do(Revive(2))
    source.run_to_end()
    state = source.fields()
    assert state["node_up"].tolist() == [1] * 6
    assert state["fields"]["value"] == [7] * 6
    assert state["fields"]["twice"] == [14.0] * 6
