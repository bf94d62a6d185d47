"""Mistakes that are planted stand in what is proved: one that does not can never be refuted."""

from functools import cache
from importlib.resources import files

import pytest

from innervate.network import networks
from innervate.prove.faults import faults_of

PROVED = [one for one in networks().values() if getattr(one, "prove", None)]
FAULTS = [pytest.param(net, one, id=f"{net.name}: {one.name}") for net in PROVED
          for one in faults_of(net)]  # fmt: skip


@cache
def protocol_of(network):
    """All of a protocol's source, with the arithmetic that it reckons by."""
    folder = files(network.package) / "protocol"
    sources = [one for one in folder.iterdir() if one.name.endswith(".py")]
    arith = files("innervate.dialect") / "arith.py"
    return "".join(one.read_text() for one in [*sources, arith])


@pytest.mark.parametrize(("network", "fault"), FAULTS)
def test_a_mistake_changes_one_place_of_the_protocol(network, fault):
    assert protocol_of(network).count(fault.old) == 1
