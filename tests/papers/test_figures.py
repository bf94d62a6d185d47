"""What holds of every figure of every paper, in quick mode."""

import re
from typing import NamedTuple

import pytest

from innervate.networks.mesh import papers as mesh
from innervate.networks.radio import papers as radio
from innervate.networks.skin import papers as skin
from innervate.papers.experiment import FAILS
from tests.fixtures.papers import CHEAP
from tests.plot.ink import measured
from tests.plot.labels import covered


class Paper(NamedTuple):
    """A paper, the fixture that made figures of it, which, and the letters of its readings."""

    module: object
    fixture: str
    figures: tuple[str, ...]
    readings: str


PAPERS = {
    "skin": Paper(skin, "made", CHEAP, "EF"),
    "radio": Paper(radio, "radio_made", radio.FIGURES, "QF"),
    "mesh": Paper(mesh, "mesh_made", mesh.FIGURES, "A"),
}
DRAWN = [(name, figure) for name, paper in PAPERS.items() for figure in paper.figures]
ALL = [(name, figure) for name, paper in PAPERS.items() for figure in paper.module.FIGURES]


@pytest.fixture
def made_of(request, paper):
    """What was made of a paper."""
    return request.getfixturevalue(PAPERS[paper].fixture)


@pytest.mark.parametrize(("paper", "name"), DRAWN)
def test_a_figure_is_drawn(made_of, name):
    (width, height), ink = measured(made_of.folder / f"{name}.png")
    assert width >= 1000
    assert 0.3 < height / width < 1.5
    assert 0.01 < ink < 0.6
    assert (made_of.folder / f"{name}.svg").read_text().startswith("<?xml")


@pytest.mark.parametrize(("paper", "name"), DRAWN)
def test_no_labels_overlap(made_of, name):
    assert covered(made_of.folder, name) == []


@pytest.mark.parametrize(("paper", "name"), DRAWN)
def test_every_claim_is_whole(made_of, paper, name):
    reading = rf"[{PAPERS[paper].readings}]\d+"
    verdict = re.compile(rf"holds|does not hold|holds with reading {reading}(, {reading})*")
    assert made_of.claims[name]
    for claim in made_of.claims[name]:
        assert verdict.fullmatch(claim.verdict), claim.verdict
        assert claim.figure
        assert claim.claim
        assert re.search(r"\d", claim.measurement), claim
        assert not re.search(r"\bnan|nan\b|None|\binf\b", claim.measurement), claim
        assert claim.verdict != FAILS or claim.reason, claim
        assert not claim.claim.startswith("..."), "it stands alone on a phone and among failures"


@pytest.mark.parametrize(("paper", "name"), ALL)
def test_points_are_told_apart(paper, name):
    made = PAPERS[paper].module.experiment(name)
    assert made.name == name
    for quick in (True, False):
        points = made.points(quick)
        keys = [point.key for point in points]
        assert 0 < len(keys) == len(set(keys))
        assert all(point.cost_s > 0 for point in points)
