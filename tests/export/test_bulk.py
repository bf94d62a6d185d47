"""Bytes made by the thousand are those that `wire` makes one by one."""

from functools import partial

import numpy as np
import pytest

from innervate.dialect import plain
from innervate.kernel import records
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.export import capture as mesh_capture
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio.export import capture as radio_capture
from innervate.networks.radio.protocol import constants as radio_const
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.skin import frames as skin
from innervate.networks.skin.export import capture as skin_capture
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.wire.layout import SPARE

RNG = np.random.default_rng(3)
COUNT = 300


def filled(declaration, layouts, kinds):
    """Records of all kinds, with all that their frames can carry."""
    made = records.zeros(declaration, COUNT)
    for name, length, low, high, *_ in declaration:
        made[name] = RNG.integers(low, high + 1, (COUNT, length) if length else COUNT)
    made["kind"] = RNG.choice(kinds, COUNT)
    for _kind, _name, fields in layouts:
        for name, many, bits, signed in fields:
            if name != SPARE:
                low = -(1 << (bits - 1)) if signed else 0
                shape = (COUNT, many) if many else COUNT
                made[name] = RNG.integers(low, low + (1 << bits), shape)
    return made


def as_object(declaration, row):
    record = plain.make("Frame", declaration)()
    for name, length, *_ in declaration:
        setattr(record, name, row[name].tolist() if length else int(row[name]))
    return record


@pytest.mark.parametrize(
    ("wire", "declaration", "many"),
    [
        (skin, skin_fields.FRAME, partial(skin_capture.frames, None)),
        (radio, radio_fields.FRAME, partial(radio_capture.frames, None)),
    ],
    ids=["skin", "radio"],
)
def test_fixed_frames(wire, declaration, many):
    kinds = [kind for kind, _name, _fields in wire.LAYOUTS]
    if wire is radio:
        kinds.append(radio_const.CRR)
    rows = filled(declaration, wire.LAYOUTS, kinds)
    rows["slots" if wire is radio else "dist"][rows["kind"] == radio_const.CRR] = 1
    found = many(rows)
    assert found == [wire.encode(as_object(declaration, row)) for row in rows]
    assert len({len(data) for data in found}) > 1


def test_mesh_frames_that_many_received_are_the_same_bytes():
    frames = records.zeros(mesh_fields.FRAME, COUNT)
    frames["kind"] = 8
    frames["length"] = RNG.integers(0, 60, COUNT)
    frames["path_len"] = 2
    frames["body"] = RNG.integers(0, 256, frames["body"].shape)
    frames["seq"] = np.arange(COUNT)
    frames["rssi"] = RNG.integers(-90, -10, COUNT)
    rows = np.zeros(COUNT, [("start", np.int64), ("sender", np.int32)])
    twice = np.repeat(np.arange(COUNT), 2)
    found = mesh_capture.frames(rows[twice], frames[twice])
    assert found[::2] == found[1::2]
    assert found[::2] == [mesh.encode(as_object(mesh_fields.FRAME, row)) for row in frames]
