"""An alarm's bytes are laid out in one way, whoever writes and whoever reads them."""

from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.networks.mesh.live.alarms import read_alarm
from innervate.networks.mesh.payloads import FIELDS, SIZES
from innervate.networks.mesh.protocol import alarm
from innervate.networks.mesh.protocol.constants import ALARM, CROSS
from innervate.wire import layout
from tests.networks.mesh.bench import Frame, Node, Params

BYTE, PLACE, SPEED = st.integers(0, 253), st.integers(-32_768, 32_767), st.integers(-127, 127)


def told(body):
    found = []
    assert layout.read(FIELDS[ALARM], bytes(body), 0, 8 * len(body), found) == 8 * len(body)
    return dict(found)


@given(BYTE, BYTE, BYTE, PLACE, PLACE, SPEED, SPEED, PLACE, st.integers(0, 90_000))
def test_the_monitor_that_saw_it_itself_is_told_what_others_would_send(
    robot, fence, number, x, y, vx, vy, gap, ticks
):
    node, params = Node(), Params()
    node.number, node.alarm, node.ticks, node.tick_at = 3, number, ticks, 100
    params.fence, params.tick_us = fence, 10_000
    sighting = (CROSS, robot, x, y, vx, vy, gap)
    sent = [0] * 20
    alarm.write_alarm(sent, 2, node, params, 7_100, *sighting)
    out = plain.Outbox(Frame, 4)
    alarm.tell_monitor(node, params, 7_100, *sighting, out)
    body = list(out.frame[0].body[: alarm.ALARM_BYTES])
    assert body == sent[2:18]
    assert told(body) == {
        "robot": robot, "fence": fence, "number": number, "alarm": CROSS, "x": x, "y": y,
        "vx": vx, "vy": vy, "time": 10 * ticks + 7, "margin": gap,
    }  # fmt: skip
    assert SIZES[ALARM] == alarm.ALARM_BYTES
    heard = read_alarm(9, bytes(body), 2)
    assert heard[1:] == (robot, 9, fence, number, 2 * x, 2 * y, 2 * gap)
    assert read_alarm(9, bytes(body[:-1]), 2) is None
