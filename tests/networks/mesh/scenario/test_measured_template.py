"""`new mesh --network`: the scenario that it writes is tuned, and delivers."""

import numpy as np
import pytest

import innervate
from innervate import scenario
from innervate.networks.mesh.analysis.messages import DELIVERED, counted, messages
from innervate.networks.mesh.scenario.measured_template import CROWD_TUNED, TUNED, measured
from innervate.networks.mesh.sim.simulate import simulate

LEAVES = 40


@pytest.fixture
def star(tmp_path):
    """A hub whose leaves do not hear each other, over links that lose a third."""
    lines = "".join(f"hub n{i} 0.7 0.65\n" for i in range(LEAVES)) + "n0 n1 0.9\n"
    (tmp_path / "star.txt").write_text(lines)
    return tmp_path


def protocol_of(text, folder=""):
    return scenario.loads(text, folder=str(folder)).model.protocol


def test_the_bundled_leipzig_is_tuned_as_the_template_is() -> None:
    text, taken = measured("mine", "freifunk/leipzig", {}, "")
    assert taken == "Taken: 86 of 210 nodes; links of 0.3 and better hold them together."
    assert protocol_of(text) == scenario.load("mesh-leipzig").model.protocol
    assert protocol_of(text).copies == TUNED["copies"]


def test_hubs_and_many_nodes_take_their_time_and_no_tables(star) -> None:
    crowd, small = (
        protocol_of(measured("mine", "star.txt", chosen, str(star))[0], star)
        for chosen in ({}, {"around": "hub", "nodes": 33})
    )
    assert not crowd.tables
    assert crowd.jitter_s == CROWD_TUNED["jitter_s"]
    assert (small.tables, small.jitter_s) == (True, TUNED["jitter_s"]), "the hub has 32 neighbours"
    many = protocol_of(measured("mine", "freifunk/bielefeld", {}, "")[0])
    assert not many.tables
    assert many.period_s > many.collect_s


def test_a_template_of_a_hub_with_hidden_leaves_delivers(star) -> None:
    """More neighbours than a node of a small network remembers: each has a place all the same."""
    text, _ = measured("mine", "star.txt", {}, str(star))
    loaded = scenario.loads(
        text.replace("duration_s = 60.0", "duration_s = 45.0"), folder=str(star)
    )
    plan = scenario.plan(loaded)
    assert plan.params["places"] > LEAVES
    found = counted(messages(simulate(plan, plain=True)))
    assert len(found.state) > 2 * LEAVES
    assert np.mean(found.state == DELIVERED) >= 0.99


@pytest.mark.parametrize(("leaves", "places"), [(31, 32), (32, 32), (33, 254)])
def test_a_hub_has_a_place_for_each_of_its_neighbours(leaves, places):
    text = "".join(f"[[link]]\na = 'hub'\nb = 'n{i}'\n" for i in range(leaves))
    assert scenario.plan(scenario.loads(f'kind = "mesh"\n{text}')).params["places"] == places


@pytest.mark.slow
@pytest.mark.parametrize(
    ("every_s", "to", "least"), [(10, "gateway", 0.99), (10, "random", 0.99), (30, "random", 0.998)]
)
@pytest.mark.parametrize("network", ["leipzig", "bielefeld"])
def test_templates_of_community_meshes_deliver(network, every_s, to, least, tmp_path) -> None:
    """A message from everybody every so often, for 70 s; then nothing new for another 70."""
    text, _ = measured("mine", f"freifunk/{network}", {}, "")
    (tmp_path / "mine.toml").write_text(text)
    flow = {"to": to, "every_s": every_s, "jitter_s": min(every_s, 20), "stop_s": 90}
    changes = {"duration_s": 160, **{f"flow.0.{key}": value for key, value in flow.items()}}
    sent = delivered = 0
    for seed in range(1, 21):
        summary = innervate.run(tmp_path / "mine.toml", seed=seed, overrides=changes).summary
        assert summary["duplicates"] == 0, seed
        sent += summary["connected"]["sent"]
        delivered += summary["connected"]["delivered"]
    assert delivered >= least * sent
