"""Who is switched on again knows nothing of its former life but what its protocol keeps."""

import pytest

from innervate.dialect import plain
from innervate.networks.babel.protocol import fields as babel
from innervate.networks.babel.protocol import node as babel_node
from innervate.networks.rpl.protocol import fields as rpl
from innervate.networks.rpl.protocol import node as rpl_node
from innervate.networks.skin.protocol import cell
from innervate.networks.skin.protocol import fields as skin
from tests.networks.skin.bench import params_of

DRIVERS = {"number": 5, "rng": 77, "choice": -1, "asked": 0}  # fields that their drivers set


OUTBOX = 64


def usual(fields):
    """A protocol's usual parameters."""
    params = plain.make("Params", fields.PARAMS)()
    for name, value in fields.DEFAULTS.items():
        setattr(params, name, value)
    return params


def left_of(protocol, declared, frame, params):
    """Fields that two former lives leave different, all as low and all as high as they may be."""
    lives = []
    for end in (0, 1):
        node = plain.make("Node", declared)()
        for name, length, *bounds, _unit, _meaning in declared:
            value = DRIVERS.get(name, bounds[end])
            setattr(node, name, [value] * length if length else value)
        out = plain.Outbox(plain.make("Frame", frame), OUTBOX)
        protocol.on_start(node, params, 1_000, 1, out)
        lives.append(node)
    return {name for name, *_ in declared if getattr(lives[0], name) != getattr(lives[1], name)}


# What stays: what nobody reads before it is written, as another field says that there is nothing.
BABEL = """fd_at fd_metric fd_seq hello_at hello_next hello_us ihu_at look_at route_at route_us seq
wanted_at wanted_seq wanted_us"""
RPL = """counter dao_life dao_path dao_target life nbr_dsn nbr_dtsn nbr_fails nbr_version path phase
rest tries q_back q_body q_dest q_down q_error q_first q_from q_hops q_info q_kind q_length q_made
q_next q_origin q_path q_route"""
KEPT = {"seqno", "lived"}  # as in stable storage; in which of its ticks a node says things again


@pytest.mark.parametrize(("protocol", "declared", "frame", "params", "unread"), [
    (babel_node, babel.STATE, babel.FRAME, usual(babel), BABEL),
    (rpl_node, rpl.STATE, rpl.FRAME, usual(rpl), RPL),
    (cell, skin.CELL, skin.FRAME, params_of(), ""),
], ids=["babel", "rpl", "skin"])  # fmt: skip
def test_a_node_begins_with_nothing_known(protocol, declared, frame, params, unread):
    assert left_of(protocol, declared, frame, params) - KEPT == set(unread.split())
