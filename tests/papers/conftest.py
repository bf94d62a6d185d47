from types import SimpleNamespace

import pytest

from innervate.papers import main, mesh, radio, skin
from innervate.papers.book import RESULTS
from innervate.papers.store import Store, stamp

# Quick enough for every run of the tests; fig10 and eq7 are run in small or as `slow`.
CHEAP = ("startup", "fig5", "fig6", "eq3", "delay", "fig8b", "eq9", "fig11", "loop")


def read(folder, quick, names, paper=skin):
    """What a run left: the results, and of each figure its experiment and claims."""
    values = Store(folder / RESULTS, stamp()).values
    experiments = {name: paper.experiment(name) for name in names}
    claims = {name: e.judge(values, quick) for name, e in experiments.items()}
    return SimpleNamespace(
        folder=folder, quick=quick, values=values, experiments=experiments, claims=claims
    )


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """The cheap figures in quick mode."""
    folder = tmp_path_factory.mktemp("papers")
    main("skin", folder, quick=True, only=CHEAP)
    return read(folder, True, CHEAP)


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """Everything with the real numbers of seeds; minutes."""
    folder = tmp_path_factory.mktemp("papers-full")
    main("skin", folder)
    return read(folder, False, skin.FIGURES)


@pytest.fixture(scope="session")
def radio_made(tmp_path_factory):
    """All figures of the radio in quick mode."""
    folder = tmp_path_factory.mktemp("papers-radio")
    main("radio", folder, quick=True)
    return read(folder, True, radio.FIGURES, radio)


@pytest.fixture(scope="session")
def mesh_made(tmp_path_factory):
    """All figures of the mesh in quick mode."""
    folder = tmp_path_factory.mktemp("papers-mesh")
    main("mesh", folder, quick=True)
    return read(folder, True, mesh.FIGURES, mesh)
