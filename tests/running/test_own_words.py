"""A network's own words of [[event]]s are told wherever what happens to it is told."""

import pytest

import innervate
from innervate import scenario
from innervate.export import recording
from innervate.live import play
from innervate.live.deployment import Deployment
from innervate.network import use
from innervate.plot import page
from innervate.sim.cables.declared import simulation
from innervate.web.declared_view import DeclaredView
from innervate.web.engine import Engine
from innervate.web.history import History
from tests.own import alone, own

__all__ = ["alone", "own"]
POKE = 'HAPPENINGS = {"poke": lambda node, value: (1, {"value": value})}\n'
POKED = '[[event]]\nat_s = 0.1\naction = "poke"\nnode = 3\nvalue = 4\n'
SAID = "poke n3, value 4"


@pytest.fixture
def poked(own):
    """A network that can be poked, and is, before a cable of it is cut."""
    (own.folder / "more.py").write_text(POKE)
    own.change("network.py", '    fields="fields"',
               '    happenings="more:HAPPENINGS",\n    fields="fields"')  # fmt: skip
    with own.scenario.open("a") as file:
        file.write(POKED)
    use(own.folder)
    return own


def test_reports_and_recordings_tell_them_in_order_of_time(poked):
    run = innervate.run(poked.scenario, plain=True)
    assert [told["message"] for _, told in recording.events(run.plan)] == [
        SAID, "cut n0 E - n1 W"]  # fmt: skip
    section = page.events(run.result, lambda fault: "cut")
    assert section.index(SAID) < section.index("cut")


def test_live_nodes_are_poked_and_that_is_told(poked):
    deployment = Deployment(scenario.plan(scenario.load(poked.scenario)))
    events = play.events(deployment)
    assert [(event.at_s, event.text) for event in events] == [(0.1, SAID), (0.2, "cut n0 - n1")]
    assert all(map(play.is_played, events))
    assert (0.1, "n3") in [(at_s, name) for at_s, name, _ in deployment.inputs()]


def test_pages_tell_them_once(poked):
    plan = scenario.plan(scenario.load(poked.scenario))
    history = History()
    engine = Engine(simulation(plan, plain=True))
    view = DeclaredView(engine, history)
    for until_us in (50_000, 150_000, 160_000):
        engine.advance(until_us, 10_000)
        view.note({})
    told = [item.what["text"] for item in history.after("log", 0, history.newest, 99)]
    assert told.count(SAID) == 1
