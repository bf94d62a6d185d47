"""A node of a file that [import] leaves out: the error says why, and which value keeps it."""

from typing import Any

import pytest

from innervate.scenario import ScenarioError, from_dict, plan

NET = "A B 0.9\nB C 0.9\nC D 0.217 0.5\nE F 0.8\nF G 0.7\nF A 0.1 0.2\nH B 0.9 0\n"
FAINT = 'no link of "D" has a quality of 0.3 or better both ways, the best has 0.217; '


@pytest.fixture
def named(tmp_path):
    """Plans a mesh of the file whose gateway, or middle, is named; keys of [import]."""
    (tmp_path / "net.txt").write_text(NET)

    def planned(gateway: str | None = None, **keys: Any) -> Any:
        tables = {"kind": "mesh", "import": {"file": str(tmp_path / "net.txt"), **keys}}
        return plan(from_dict(tables | ({"gateway": gateway} if gateway else {})))

    return planned


@pytest.mark.parametrize(("node", "keys", "said"), [
    ("D", {}, f"gateway: {FAINT}import.min_tq = 0.21 keeps it"),
    (None, {"around": "D"}, f"import.around: {FAINT}import.min_tq = 0.21 keeps it"),
    ("D", {"around": "A", "nodes": 3}, f"{FAINT}import.min_tq = 0.21 and import.nodes = 4 keep it"),
    ("C", {"around": "A", "nodes": 2}, "nearest 2 nodes; import.nodes = 3 keeps it"),
    ("E", {}, '"E" is left out: no links of 0.3 or better join it with most; import.min_tq = 0.1'),
    ("H", {}, '"H" is left out: its links work one way only; name another'),
    ("Z", {}, 'gateway: there is no node "Z"; there are A, B, C'),
])  # fmt: skip
def test_who_is_left_out_is_told_with_what_would_keep_it(named, node, keys, said) -> None:
    with pytest.raises(ScenarioError) as found:
        named(node, **keys)
    assert said in str(found.value)


@pytest.mark.parametrize(("node", "keys"), [
    ("D", {"min_tq": 0.21}), ("E", {"min_tq": 0.1}), ("C", {"around": "A", "nodes": 3}),
    ("D", {"around": "A", "min_tq": 0.21, "nodes": 4}), (None, {"around": "D", "min_tq": 0.21}),
])  # fmt: skip
def test_the_values_that_are_named_do_keep_it(named, node, keys) -> None:
    assert (node or keys["around"]) in named(node, **keys).names


def test_a_node_whose_links_are_of_other_types_is_told_so(tmp_path) -> None:
    links = ({"source": "a", "target": "b", "type": "wifi"},
             {"source": "b", "target": "c", "type": "vpn"})  # fmt: skip
    nodes = ", ".join(f'{{"id": "{name}"}}' for name in "abc")
    rows = ", ".join(str(link).replace("'", '"') for link in links)
    (tmp_path / "net.json").write_text(f'{{"nodes": [{nodes}], "links": [{rows}]}}')
    tables = {"kind": "mesh", "gateway": "c", "import": {"file": str(tmp_path / "net.json")}}
    with pytest.raises(ScenarioError, match='"c" is left out: it has no link of type wifi'):
        plan(from_dict(tables))
