"""Frames of up to 1200 bytes where links are IP: planned, simulated, captured, run live."""

from types import SimpleNamespace

import pytest

from innervate.cli import main
from innervate.networks.mesh.live.deployment import MeshDeployment
from innervate.networks.mesh.protocol.constants import PARTS_MAX, WHOLE_GRAPH
from innervate.networks.mesh.protocol.table import part_count
from innervate.networks.mesh.scenario.distribution import graph_nodes_max
from innervate.networks.mesh.sim.simulate import loop_name, simulate
from innervate.scenario import ScenarioError, loads, plan

CHAIN = """
kind = "mesh"
nodes = 4
duration_s = 3
radio.profile = "ip"
protocol.mtu = {mtu}
link = [{{ a = 0, b = 1 }}, {{ a = 1, b = 2 }}, {{ a = 2, b = 3 }}]
flow = [{{ from = 3, to = "gateway", every_s = 0.2, bytes = {bytes} }}]
"""


def chain(mtu=1200, bytes=1163):
    return CHAIN.format(mtu=mtu, bytes=bytes)


@pytest.mark.parametrize(("mtu", "most"), [(64, 27), (127, 90), (500, 463), (1200, 1163)])
def test_a_message_is_as_long_as_frames_have_room_and_no_longer(mtu, most):
    made = plan(loads(chain(mtu, most)))
    ran = simulate(made, plain=True)
    assert len(made.offers) == len(ran.delivered) == 10
    assert ran.sent["bytes"].max() == mtu - 24 + 3  # of a path of 24 nodes it has 3
    with pytest.raises(ScenarioError, match=r"flow\.0\.bytes.*(at most|to) " + str(most)):
        plan(loads(chain(mtu, most + 1)))


@pytest.mark.parametrize("profile", ["250k", "38k4", "ideal"])
def test_radios_have_frames_of_64_or_127_bytes(profile):
    def with_mtu(mtu):
        return plan(loads(f'kind="mesh"\nnodes=9\nradio.profile="{profile}"\nprotocol.mtu={mtu}'))

    assert [with_mtu(mtu).params["mtu"] for mtu in (64, 127)] == [64, 127]
    for mtu in (65, 126, 128, 1200):
        with pytest.raises(ScenarioError, match=rf"protocol\.mtu = {mtu}, but a frame"):
            with_mtu(mtu)


def test_a_mesh_of_longer_frames_has_a_loop_of_its_own():
    names = [loop_name(plan(loads(chain(mtu, 9)))) for mtu in (64, 127, 128, 1200)]
    assert names == ["mesh-32", "mesh-32", "mesh-32-128", "mesh-32-1200"]


@pytest.mark.parametrize(("mtu", "nodes"), [(64, 85), (127, 145), (200, 201), (1200, 254)])
def test_the_flooded_graph_has_an_end(mtu, nodes):
    assert graph_nodes_max(mtu) == nodes
    by_room = nodes in (201, 254)
    fits, more = (
        part_count(SimpleNamespace(mtu=mtu, nodes=nodes + n, mode=WHOLE_GRAPH)) for n in (0, 1)
    )
    assert fits <= PARTS_MAX
    assert (more > PARTS_MAX) == (by_room and nodes < 254)


def test_files_of_live_nodes_have_it():
    deployment = MeshDeployment(plan(loads(chain())))
    _, tables = deployment.file(0, [])
    assert tables["protocol"]["mtu"] == 1200


@pytest.mark.slow
def test_compiled_as_plain():
    made = plan(loads(chain()))
    assert simulate(made).fingerprint == simulate(made, plain=True).fingerprint


@pytest.mark.slow
def test_a_capture_of_long_frames_is_fitted_by_a_scenario_of_long_frames(tmp_path):
    scenario, capture, like = (tmp_path / name for name in ("a.toml", "a.pcapng", "like.toml"))
    scenario.write_text(chain())
    assert main(["export", str(scenario), "--pcapng", str(capture)]) == 0
    assert main(["fit", str(capture), "--out", str(like)]) == 0
    made = plan(loads(like.read_text()))
    assert (made.params["mtu"], made.offers[0].length) == (1200, 1163)
