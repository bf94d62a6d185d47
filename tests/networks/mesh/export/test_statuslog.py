"""A mesh out of what its nodes say, with answers that are known beforehand."""

import json

import pytest

from innervate.export.errors import ExportError
from innervate.networks.mesh.export import statuslog


def said(number, *near, **more):
    neighbours = [{"node": node, "quality": quality} for node, quality in near]
    return {"kind": "mesh", "number": number, "gateway": None, "neighbours": neighbours} | more


def measured(tmp_path, told):
    path = tmp_path / "status.json"
    path.write_text(json.dumps(told))
    return statuslog.measure(path)


def counts(found):
    return {key: (way.got, way.lost) for key, way in sorted(found.ways.items())}


@pytest.mark.parametrize(("there", "back", "got"), [
    (0.81, 0.81, 9_000), (0.64, 1.0, 9_055), (0.0, 0.0, 0), (None, 0.25, 5_000),
    (1.5, 1.5, 10_000), (-2, -2, 0), (None, None, 10_000), (0.0, None, 0),
])  # fmt: skip
def test_each_way_of_a_link_has_the_root_of_what_both_ends_say(tmp_path, there, back, got):
    found = measured(tmp_path, [said(3, (4, there)), said(4, (3, back))])
    assert counts(found) == {way: (got, 10_000 - got) for way in ((3, 4), (4, 3))}


def test_one_end_alone_may_speak_of_a_link(tmp_path):
    found = measured(tmp_path, said(3, (4, 0.25), (9, 1.0), gateway=3))
    assert counts(found) == {
        (3, 4): (5_000, 5_000), (3, 9): (10_000, 0), (4, 3): (5_000, 5_000), (9, 3): (10_000, 0),
    }  # fmt: skip
    assert (found.gateway, found.longest) == (3, 0)


@pytest.mark.parametrize(("quality", "notes"), [(1.0, 1), (0.0, 1), (None, 2)])
def test_links_that_carried_nothing_are_told(tmp_path, quality, notes):
    found = measured(tmp_path, [said(3, (4, quality)), said(4, (5, 0.5))])
    assert found.gateway == -1
    assert len(found.notes) == notes
    assert found.notes[-1].startswith("a status says nothing of delays")
    if notes == 2:
        assert found.notes[0].startswith("1 link carried nothing")


@pytest.mark.parametrize("more", [
    {"kind": "skin"}, {"number": "x"}, {"gateway": "x"}, {"neighbours": None},
    {"neighbours": [{"node": 4}]},
])  # fmt: skip
def test_what_other_nodes_say_is_refused(tmp_path, more):
    with pytest.raises(ExportError, match="no status of mesh nodes"):
        measured(tmp_path, [said(3, (4, 1.0)), said(4, (3, 1.0)) | more])


@pytest.mark.parametrize("text", ["", "[", "7", "[" * 100_000])
def test_what_is_no_answer_at_all_is_refused(tmp_path, text):
    (tmp_path / "status.json").write_text(text)
    with pytest.raises(ExportError, match="no status of mesh nodes"):
        statuslog.measure(tmp_path / "status.json")


def test_without_neighbours_there_is_no_network(tmp_path):
    with pytest.raises(ExportError, match="ask again a little later"):
        measured(tmp_path, [said(3), said(4)])
