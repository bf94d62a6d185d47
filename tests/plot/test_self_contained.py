"""A run's report is one file: readable without the internet, and it says how to get it again."""

import re
import tomllib

import pytest

from innervate import run, scenario
from innervate.plot import page as pages
from innervate.plot import report
from tests.export.test_captures import MESH, RADIO, SKIN
from tests.plot.self_contained import TAGS, loads_nothing, plain

SLOTTED = {"kind": "radio", "stations": 5, "seed": 3, "duration_s": 60,
           "traffic": {"kind": "disaster"}, "channel": {"level": "slotted"},
           "protocol": {"mac": "csma-cd-r"}}  # fmt: skip
KINDS = {"skin": SKIN, "mesh": MESH, "radio": RADIO, "slotted": SLOTTED}


@pytest.mark.parametrize("kind", KINDS)
def test_a_report_needs_nothing_else_and_can_be_had_again(kind):
    done = run(KINDS[kind])
    page = report.render(done)
    found = loads_nothing(page)
    assert {"svg", "table", "pre"} <= set(found.tags)
    assert not TAGS & set(found.tags)
    assert found.loads == []
    assert "innervate run scenario.toml" in plain(page)
    blocks = [plain(block) for block in re.findall(r"<pre[^>]*>(.*?)</pre>", page, re.DOTALL)]
    told = next(block for block in blocks if "kind =" in block)
    assert tomllib.loads(told) == tomllib.loads(scenario.dump(done.scenario))
    assert done.summary["fingerprint"] in page


@pytest.mark.parametrize("head", [("", "at"), ("what", "")])
def test_a_table_is_not_made_with_a_column_that_has_no_head(head):
    with pytest.raises(AssertionError):
        pages.table(head, [("1", "2 s")])


@pytest.mark.parametrize(("cell", "shown"), [
    ("0.5 %", "0.5\u00a0%"), ("-1,204 ms", "-1,204\u00a0ms"), ("3, flooded", "3, flooded"),
    ("12 nodes went", "12 nodes went"), ("", ""),
])  # fmt: skip
def test_a_number_in_a_table_stays_with_its_unit(cell, shown):
    assert f"<td>{shown}</td>" in pages.table(("what",), [(cell,)])
