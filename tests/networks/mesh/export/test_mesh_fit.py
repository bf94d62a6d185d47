"""A mesh's tables out of made-up measurements whose answers are known beforehand."""

from types import SimpleNamespace as Of

import pytest

from innervate.export.measure import Way
from innervate.networks.mesh.export import fit
from innervate.networks.mesh.export.fit import Flow, Mesh
from innervate.networks.mesh.protocol.constants import ALL, REQUEST

# Bytes on the air before a frame's own, and us a byte, as the data sheets have it.
RADIOS = {"250k": (6, 32.0), "38k4": (8, 8 / 0.0384)}


def mesh(ways, **more):
    return Mesh(ways={key: Way(*counts) for key, counts in ways.items()}, **more)


def test_links_have_a_quality_each_way_and_none_where_nothing_was_heard():
    tables = fit.tables_of(mesh({(7, 3): (90, 10), (3, 7): (2, 1), (3, 12): (5, 0)}))
    assert tables["node"] == [{"name": "n3"}, {"name": "n7"}, {"name": "n12"}]
    assert tables["link"] == [
        {"a": "n3", "b": "n7", "quality": [0.6667, 0.9]},
        {"a": "n3", "b": "n12", "quality": [1.0, 0.0]},
    ]


@pytest.mark.parametrize(("gateway", "told"), [(3, "n3"), (-1, None), (5, None)])
def test_the_gateway_is_one_of_the_nodes_or_nobody(gateway, told):
    assert fit.tables_of(mesh({(3, 7): (1, 0)}, gateway=gateway)).get("gateway") == told


@pytest.mark.parametrize(("named", "seen"), [(4, 4), (ALL, -1)])
def test_the_gateway_is_whom_a_request_names_and_not_who_says_it_again_or_asks(named, seen):
    reader = fit.Reader.__new__(fit.Reader)
    reader.found = Mesh()
    reader.frame = Of(kind=REQUEST, link_src=2, origin=2, body=[named])
    reader._look(None)
    assert reader.found.gateway == seen


def test_flows_are_those_between_nodes_that_were_seen():
    flows = [
        Flow(3, 7, 20, 0.5, 1.25, 12),
        Flow(7, 255, 1, 0.0, 0.0, 90),
        Flow(7, 254, 2, 3.0, 2.0, 91),
        Flow(7, 9, 5, 1.0, 0.0, 8),
    ]
    found = fit.tables_of(mesh({(3, 7): (1, 0)}, flows=flows))["flow"]
    common = ("from", "to", "bytes", "count", "every_s", "start_s")
    assert [tuple(one[name] for name in common) for one in found] == [
        ("n3", "n7", 12, 20, 0.5, 1.25),
        ("n7", "all", 90, 1, 0.0001, 0.0),
        ("n7", "monitor", 90, 2, 3.0, 2.0),
    ]


@pytest.mark.parametrize("name", RADIOS)
def test_the_radio_is_the_one_whose_frames_take_as_long(name):
    ahead, byte_us = RADIOS[name]
    found = mesh({(0, 1): (3, 0)})
    for size in (9, 40, 110):
        found.ways[0, 1].sizes.append(size)
        found.ways[0, 1].delays_us.append((ahead + size) * byte_us + 15)
    assert fit.profile_of(found) == name


def test_frames_that_take_next_to_no_time_went_over_ip_and_so_did_those_of_unknown_delay():
    found = mesh({(0, 1): (3, 0)})
    assert fit.profile_of(found) == "ip"
    found.ways[0, 1].sizes.append(40)
    found.ways[0, 1].delays_us.append(80.0)
    assert fit.profile_of(found) == "ip"
