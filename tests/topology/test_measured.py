"""Networks that were measured: the forms they come in, and what is wrong with some."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.scenario.bundled import FOLDER
from innervate.topology import measured
from innervate.topology.errors import TopologyError
from innervate.topology.placement import components, neighbours

CITIES = FOLDER / "freifunk"


@pytest.mark.parametrize(
    ("city", "least", "nodes", "links", "busiest"),
    [("leipzig", 0.3, 86, 186, 13), ("bielefeld", 0.3, 203, 204, 109), ("ulm", 0, 172, 174, 77)],
)
def test_cities(city: str, least: float, nodes: int, links: int, busiest: int) -> None:
    found = measured.read(CITIES / f"{city}.json", ["wifi"]).kept(least).largest()
    assert len(found.names) == len(found.points) == nodes
    assert len(found.links) == links
    near = neighbours(nodes, list(found.links))
    assert max(map(len, near)) == busiest
    assert len(components(near)) == 1
    assert all(least <= share <= 1 for both in found.links.values() for share in both)


def test_types_of_links() -> None:
    every, wifi = (measured.read(CITIES / "leipzig.json", types) for types in ([], ["wifi"]))
    assert len(every.links) == 413
    assert len(wifi.links) < 413
    assert len(measured.read(CITIES / "leipzig.json", ["wifi", "vpn", "other"]).links) == 413


def test_the_target_sees_what_the_source_sends() -> None:
    found = measured.from_json(
        '{"nodes": [{"id": "a"}, {"id": 7}],'
        '"links": [{"source": 7, "target": "a", "source_tq": 0.2, "target_tq": 0.9}]}'
    )
    assert found.names == ["a", "7"]
    assert found.links == {(0, 1): (0.2, 0.9)}  # a to 7 as 7, the source of the link, sees it
    assert found.points == []


def test_degrees_become_metres() -> None:
    nodes = [{"id": 0, "x": 51.0, "y": 12.0}, {"id": 1, "x": 51.01, "y": 12.0},
             {"id": 2, "x": 51.005, "y": 12.01}, {"id": 3}]  # fmt: skip
    links = [{"source": 0, "target": 3}, {"source": 1, "target": 3}, {"source": 2, "target": 0}]
    points = measured.from_json(json.dumps({"nodes": nodes, "links": links})).points
    assert points[1][1] - points[0][1] == pytest.approx(111_194, abs=2)
    assert points[2][0] - points[0][0] == pytest.approx(111_194 * 0.6294, rel=1e-3)
    assert points[3] == ((points[0][0] + points[1][0]) // 2, (points[0][1] + points[1][1]) // 2)


def test_what_a_map_of_a_community_gives() -> None:
    """Node 475 of such a file lies at a longitude of 12986035."""
    places = [{"latitude": 51.0, "longitude": 12.0}, {}, {"latitude": 51.0, "longitude": 12986035},
              {"latitude": 51.01, "longitude": 12.0}]  # fmt: skip
    nodes = [{"node_id": f"c46e1f0e105{i}", "location": at} for i, at in enumerate(places)]
    link = {"source": "c46e1f0e1050", "type": "wifi", "source_tq": 0.9, "target_tq": 1}
    links = [link | {"target": one["node_id"]} for one in nodes[1:]]
    found = measured.from_json(json.dumps({"nodes": nodes, "links": links}), ["wifi"])
    assert found.names == [one["node_id"] for one in nodes]
    assert found.links == {(0, other): (1.0, 0.9) for other in (1, 2, 3)}
    assert found.points[3][1] - found.points[0][1] == pytest.approx(111_194, abs=2)
    assert found.points[1] == found.points[2] == found.points[0]


def test_plain_lines() -> None:
    found = measured.from_lines("# mine\nA B 0.9 0.7\nC A 0.5\n\nB C  # perfect\n")
    assert found.names == ["A", "B", "C"]
    assert found.links == {(0, 1): (0.9, 0.7), (0, 2): (0.5, 0.5), (1, 2): (1.0, 1.0)}


def test_topohub() -> None:
    pytest.importorskip("topohub")
    found = measured.from_topohub("sndlib/germany50")
    assert len(found.names) == len(set(found.names)) == len(found.points) == 50
    assert len(found.links) == 88
    assert set(found.links.values()) == {(1.0, 1.0)}
    berlin, munich = (found.points[found.names.index(n)] for n in ("Berlin", "Muenchen"))
    assert 4.5e7 < berlin[1] - munich[1] < 5.5e7  # Berlin lies 500 km to the north
    with pytest.raises(TopologyError, match='has no network "sndlib/none"'):
        measured.from_topohub("sndlib/none")


def test_names_of_a_package_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = [{"id": 0, "name": "A"}, {"id": 1, "name": "B\u200b"}]
    net = {"nodes": nodes, "links": [{"source": 0, "target": 1}]}
    monkeypatch.setitem(sys.modules, "topohub", SimpleNamespace(get=lambda _: net))
    with pytest.raises(TopologyError, match=r"name of node 1 holds U\+200B \(zero width space\)"):
        measured.from_topohub("any")


def test_an_id_that_is_there_twice_is_one_node() -> None:
    """Published so: of a node with several devices, say. Links tell nodes by their ids."""
    found = measured.from_json(json.dumps({
        "nodes": [{"id": "a"}, {"id": "b", "x": 51.0, "y": 12.0}, {"id": "a", "x": 51.1, "y": 12.0},
                  {"id": "c"}, {"id": "b", "x": 9.0, "y": 9.0}],
        "links": [{"source": "a", "target": "c"}, {"source": "c", "target": "b"}],
    }))  # fmt: skip
    assert found.names == ["a", "b", "c"]
    assert set(found.links) == {(0, 2), (1, 2)}
    (_, north_a), (_, north_b), _ = found.points
    assert 1.0e6 < north_a - north_b < 1.2e6, "the place that is known, and the first of two"


def test_a_number_and_the_same_number_as_text_are_one_id() -> None:
    """Nodes by text and links by number are published; a scenario knows nodes by text."""
    found = measured.from_json(
        '{"nodes": [{"id": "1"}, {"id": 2}, {"id": 1}], "links": [{"source": 1, "target": "2"}]}'
    )
    assert (found.names, set(found.links)) == (["1", "2"], {(0, 1)})


def chain(count: int, weak: int) -> measured.Measured:
    """A row of nodes, good links and from place `weak` on ever worse ones."""
    links = {(i, i + 1): (1.0, 0.9 if i < weak else 0.8 - 0.01 * (i - weak))
             for i in range(count - 1)}  # fmt: skip
    return measured.Measured([str(i) for i in range(count)], links, [])


@pytest.mark.parametrize("most", [2, 5, 6, 9, 19, 20, 40])
def test_the_least_quality_that_leaves_few_enough(most: int) -> None:
    network = chain(20, 5)
    least = network.least_for(most, in_one=True)
    if most < 6:
        assert least is None, "five good links hold six nodes together"
        return
    assert least is not None
    assert len(network.kept(least).largest().names) <= most
    if least > 0:
        assert len(network.kept(least - 0.01).largest().names) > most


@pytest.mark.parametrize("best", [0.28, 0.29, 0.56, 0.57, 0.58, 1.0])
def test_the_best_quality_is_one_of_those_that_are_tried(best: float) -> None:
    links = {(0, 1): (best, 1.0), (1, 2): (round(best - 0.01, 2), 1.0)}
    network = measured.Measured(list("abc"), links, [])
    assert network.least_for(2, in_one=True) == best


def test_no_links_leave_nothing_to_choose() -> None:
    assert measured.Measured(["a"], {}, []).least_for(5, in_one=False) is None


def test_around_a_node_hops_come_first_then_the_better_link() -> None:
    links = {(0, 1): (0.5, 0.9), (0, 2): (0.9, 0.6), (0, 3): (1.0, 0.0), (1, 4): (1.0, 1.0),
             (2, 5): (1.0, 1.0), (3, 4): (1.0, 1.0), (6, 7): (1.0, 1.0)}  # fmt: skip
    network = measured.Measured(list("abcdefgh"), links, [(i, 0) for i in range(8)])
    orders = {most: network.around(0, most).names for most in (2, 3, 4, 9)}
    assert orders[2] == ["a", "c"], "0.6 at worst, before 0.5"
    assert orders[3] == ["a", "b", "c"]
    assert orders[4] == ["a", "b", "c", "e"], "d is no neighbour: nothing arrives from it"
    assert orders[9] == ["a", "b", "c", "d", "e", "f"], "all that hold together, and no more"
    part = network.around(0, 4)
    assert part.links == {(0, 1): (0.5, 0.9), (0, 2): (0.9, 0.6), (1, 3): (1.0, 1.0)}
    assert part.points == [(0, 0), (1, 0), (2, 0), (4, 0)]
    assert network.around(7, 2).names == ["g", "h"]
    assert network.best_connected() == 0


WRONG = (
    ("", "holds no links"),
    ("A B C", "line 1 is no link; write"),
    ("A B 2", "line 1 is no link"),
    ("A B\nA A", "line 2 joins a node with itself"),
    ("A B 0.9\n\nB A 0.2", "line 3 joins B and A, as line 1 does; put both qualities into one"),
    ("{", "not valid JSON"),
    ("{}", 'lacks the lists "nodes" and "links"'),
    ('{"nodes": [{}], "links": []}', 'node 0 has no "id"'),
    ('{"nodes": [{"id": 1, "x": "a", "y": 2}], "links": []}', "x or y of node 0 is no number of"),
    ('{"nodes": [], "links": [1]}', "link 0 is no table"),
    ('{"nodes": [{"id": 1}], "links": [{"source": 1, "target": 2}]}', "link 0 leads to 2, which"),
    (
        '{"nodes": [{"id": 1}, {"id": 2}], "links": [{"source": 1, "target": 2, "source_tq": 3}]}',
        "source_tq of link 0 must be 0 to 1, not 3",
    ),
    ('{"nodes": [{"id": 1}], "links": [{"source": 1, "target": 1}]}', "link 0 joins a node with"),
    ('{"nodes": [{"id": 1}], "links": [{"target": 1}]}', 'link 0 has no "source"; name a node'),
    ('{"nodes": [{"id": true}], "links": []}', 'node 0 has no "id"'),
    ('{"nodes": [{"id": 1}], "links": [{"source": true, "target": 1}]}', "link 0 leads to True"),
    ('{"nodes": [{"id": " "}], "links": []}', 'the "id" of node 0 is empty'),
    ('{"nodes": [{"id": "a\\n"}], "links": []}', 'the "id" of node 0 holds U+000A, which'),
    ('{"nodes": [{"id": "\\ud800"}], "links": []}', 'the "id" of node 0 holds U+D800, which'),
    ("\x1b[31mA B", "a name in line 1 holds U+001B, which nobody sees"),
    ("A\u202e B", "a name in line 1 holds U+202E (right-to-left override), which nobody sees"),
    (f"A B\n{'n' * 201} B", "a name in line 2 is longer than 200 characters"),
)


@pytest.mark.parametrize(("text", "message"), WRONG)
def test_files_that_are_no_network(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "net"
    path.write_text(text)
    with pytest.raises(TopologyError) as found:
        measured.read(path)
    assert message in str(found.value)
    assert str(path) in str(found.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(TopologyError, match="No such file"):
        measured.read(tmp_path / "none")
    (tmp_path / "binary").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TopologyError, match="is not UTF-8"):
        measured.read(tmp_path / "binary")
    with pytest.raises(TopologyError, match=r"no link has a quality of 0\.9 or better"):
        measured.from_lines("A B 0.8").kept(0.9)


@pytest.mark.parametrize(("x", "y", "fits"), [
    (90, 180, True), (-90, -180, True), (90.1, 0, False), (0, 180.1, False), (0, -181, False),
    (True, 0, False), (0, "1", False), (None, 300, True), (1, None, True),
])  # fmt: skip
def test_degrees_are_those_of_the_earth(x: object, y: object, fits: bool) -> None:
    text = json.dumps({"nodes": [{"id": 1}, {"id": 2, "x": x, "y": y}], "links": []})
    if fits:
        assert measured.from_json(text).names == ["1", "2"]
    else:
        with pytest.raises(TopologyError, match="x or y of node 1"):
            measured.from_json(text)


@pytest.mark.parametrize(("share", "fits"), [
    (0, True), (1, True), (1.01, False), (-0.1, False), (True, False), ("1", False),
])  # fmt: skip
def test_a_quality_is_a_share(share: object, fits: bool) -> None:
    link = {"source": 1, "target": 2, "target_tq": share}
    text = json.dumps({"nodes": [{"id": 1}, {"id": 2}], "links": [link]})
    if fits:
        assert measured.from_json(text).links == {(0, 1): (float(str(share)), 1.0)}
    else:
        with pytest.raises(TopologyError, match="target_tq of link 0"):
            measured.from_json(text)


def test_links_of_no_type_count_always_and_missing_types_are_named() -> None:
    nodes = [{"id": i} for i in range(3)]
    links = [{"source": 0, "target": 1, "type": "vpn"}, {"source": 1, "target": 2}]
    text = json.dumps({"nodes": nodes, "links": links})
    assert set(measured.from_json(text, ["wifi"]).links) == {(1, 2)}
    assert set(measured.from_json(text, ["wifi", "vpn"]).links) == {(0, 1), (1, 2)}
    text = json.dumps({"nodes": nodes, "links": links[:1]})
    with pytest.raises(TopologyError, match="no link is of type wifi or fibre; there is vpn"):
        measured.from_json(text, ["wifi", "fibre"])


def test_links_that_are_good_enough_both_ways_are_kept_with_their_nodes() -> None:
    links = {(0, 2): (0.5, 0.9), (1, 2): (0.9, 0.49), (2, 3): (1.0, 0.6)}
    network = measured.Measured(list("abcd"), links, [(i, -i) for i in range(4)])
    kept = network.kept(0.5)
    assert (kept.names, kept.points) == (["a", "c", "d"], [(0, 0), (2, -2), (3, -3)])
    assert kept.links == {(0, 1): (0.5, 0.9), (1, 2): (1.0, 0.6)}
    assert network.kept(0.51).names == ["c", "d"]
    assert network.best_connected() == 2
    apart = measured.Measured(list("abcde"), {(0, 1): (1.0, 0.0), (1, 2): (0.1, 0.1)}, [])
    assert apart.largest().names == ["b", "c"]  # over a link that works one way nothing comes back
    assert apart.best_connected() == 1


def test_who_has_no_place_is_put_amidst_its_neighbours_however_far_they_are() -> None:
    degrees = [(50.0, 10.0), None, None, (50.0, 10.02), None]
    points = measured._metres(degrees, [(0, 1), (1, 2), (2, 3)])
    (west, _), first, second, (east, _), alone = points
    assert west == -east < 0
    assert (first, second, alone) == ((west, 0), (east, 0), (0, 0))
    assert measured._metres([None, None], [(0, 1)]) == []


def test_names_that_are_there_more_than_once_are_told_apart() -> None:
    assert measured._different(["a", "b", "a"]) == ["a-0", "b", "a-2"]


@pytest.mark.parametrize(("line", "both"), [
    ("A B", (1.0, 1.0)), ("A B 0", (0.0, 0.0)), ("A B 1 0.5", (1.0, 0.5)), ("B A 1 0.5", None),
])  # fmt: skip
def test_a_line_has_a_quality_there_and_back(line: str, both: tuple[float, float] | None) -> None:
    found = measured.from_lines(line)
    assert found.links == {(0, 1): both or (1.0, 0.5)}
    assert found.names == line.split()[:2]


@pytest.mark.parametrize("line", ["A", "A B 1 1 1", "A B -0.1", "A B x", "A B 0.5 1.1"])
def test_a_line_that_is_no_link(line: str) -> None:
    with pytest.raises(TopologyError, match="line 2 is no link"):
        measured.from_lines(f"A B\n{line}")


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(measured, "SIZE_MAX", 12)
    (tmp_path / "net").write_text("A B 0.5 0.25")
    assert measured.read(tmp_path / "net").links == {(0, 1): (0.5, 0.25)}
    (tmp_path / "net").write_text("A B 0.5 0.255")
    with pytest.raises(TopologyError, match="is too large"):
        measured.read(tmp_path / "net")
    (tmp_path / "net").write_bytes(b"\xef\xbb\xbf \n{}")
    with pytest.raises(TopologyError, match="lacks the lists"):
        measured.read(tmp_path / "net")
