import xml.etree.ElementTree as ET

import pytest

from innervate import run

NAME = '<Arm> & "hand" \x07'
SMALL = {"columns": 5, "rows": 6}
CABLES = [{"row": 0, "column": 1}, {"row": 5, "column": 3}]


def make_tables(**changes):
    """A skin of 30 cells whose second cable to the PC is cut at 0.3 s."""
    return {
        "kind": "skin",
        "name": NAME,
        "duration_s": 0.5,
        "patch": [SMALL],
        "interface": CABLES,
        "protocol": {"k": 3},
        "data": {"rate_hz": 100},
        "touch": {"path": [(0.0, 30.0, 60.0)]},
        "event": [{"at_s": 0.3, "action": "cut", "interface": 1}],
    } | changes


MANY_EVENTS = [
    {"at_s": 0.2, "action": "cut", "interface": 1},
    {"at_s": 0.25, "action": "kill", "cell": {"row": 2, "column": 2}},
    {"at_s": 0.3, "action": "cut", "random": "link"},
    {"at_s": 0.35, "action": "restore", "interface": 1},
    {"at_s": 0.4, "action": "revive", "cell": {"row": 2, "column": 2}},
    {"at_s": 0.45, "action": "restart", "cell": {"row": 3, "column": 1}},
    {"at_s": 0.5, "action": "loose", "random": "link", "loss": 0.4},
    {"at_s": 0.55, "action": "restart", "pc": True},
    {"at_s": 0.6, "action": "lose", "interface": 0, "frames": 2},
    {"at_s": 0.65, "action": "kill", "random": "cell"},
]


@pytest.fixture(scope="session")
def tables():
    return make_tables


@pytest.fixture(scope="session")
def cut():
    return run(make_tables())


@pytest.fixture(scope="session")
def many():
    return run(make_tables(duration_s=0.8, event=MANY_EVENTS))


def parse_drawing(drawing):
    """The drawing as a tree; fails if it is not well-formed XML."""
    text = drawing if isinstance(drawing, str) else drawing.render()
    assert "nan" not in text.lower().replace("nano", "")
    return ET.fromstring(text)


@pytest.fixture(scope="session")
def parse():
    return parse_drawing


@pytest.fixture(scope="session")
def texts():
    """All words of a drawing."""
    return lambda drawing: [
        node.text for node in parse_drawing(drawing).iter() if node.tag.endswith("text")
    ]
