"""The lines on a run of a skin that stand in its report and on the terminal."""

import pytest

from innervate.networks.skin import show

QUIET = {"data": {"loss_ratio": None}, "commands": None,
         "loops": {"longest_ms": None, "episodes": 0}}  # fmt: skip


@pytest.mark.parametrize(
    ("loads", "factor", "line"),
    [
        ([3], 1.0, None),
        ([3, 4], None, None),
        ([3, 1004], 0.5, "3, 1,004 (balance factor 0.500)"),
        (range(8), 0.25, "0, 1, 2, 3, 4, 5, 6, 7 (balance factor 0.250)"),
        (range(9), 0.25, "0, 1, 2, 3, 4, 5, 6, 7, ... (balance factor 0.250)"),
    ],
)
def test_loads_of_ports_are_shown_where_there_are_several(loads, factor, line, monkeypatch):
    monkeypatch.setattr(show, "command_lines", lambda commands: [])
    found = show.state_lines(QUIET | {"port_loads": list(loads), "balance_factor": factor})
    said = [f"Cells behind each interface port: {line}."] if line else []
    assert found == [*said, "No forwarding loop."]
