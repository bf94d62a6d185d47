import sys
from types import ModuleType

import pytest


def tables(**changes):
    """A line of four cells with a cable cut at 0.3 s."""
    return {
        "kind": "skin",
        "name": "four",
        "duration_s": 0.5,
        "patch": [{"columns": 4, "rows": 1}],
        "interface": [{"row": 0, "column": 0, "port": "W"}, {"row": 0, "column": 3, "port": "E"}],
        "data": {"rate_hz": 100},
        "event": [{"at_s": 0.3, "action": "cut", "interface": 1}],
    } | changes


@pytest.fixture
def four():
    return tables


@pytest.fixture
def page(monkeypatch):
    """A report that is quick to write, whatever the room `plot` draws."""
    module = ModuleType("innervate.plot.report")
    module.render = lambda run: f"<html>{run.summary['name']}</html>"
    monkeypatch.setitem(sys.modules, "innervate.plot.report", module)
    return module
