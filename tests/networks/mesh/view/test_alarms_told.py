"""Alarms of robots in the log of a simulated mesh's page."""

from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.view.view import MeshView
from innervate.web.engine import engine_of
from innervate.web.history import History, Logbook
from tests.networks.mesh.view.test_mesh_view import CHAIN, noted, report
from tests.web.runs import plan_of


def test_a_robot_whose_position_errs_does_not_flood_the_log_nor_hide_another():
    view = MeshView(engine_of(plan_of(CHAIN)), History())
    raised, came = [], []
    for at in range(1000, 51_000, 1000):
        raised.append(report(c.REPORT_ALARM, 4, c.CROSS, 4, at=at))
        came.append({"time": at + 500, "kind": c.ALARM, "body0": 4, "body3": c.CROSS})
    raised.append(report(c.REPORT_ALARM, 3, c.CROSS, 3, at=60_000))
    came.append({"time": 61_000, "kind": c.ALARM, "body0": 3, "body3": c.CROSS})
    texts = [text for _, text, _ in noted(view, raised, delivered=came)]
    assert len(texts) == 2 * (Logbook.FLOOD + 1) + 2
    assert texts[-2:] == ["robot n3 has crossed the fence",
                          "alarm of robot n3 at the monitor after 1.0 ms"]  # fmt: skip
