"""Nothing that carries frames waits in the system: a datagram that was none holds up no node."""

import asyncio

import pytest

from innervate.live.channel import Medium
from innervate.live.channel_radio import MediumRadio
from innervate.live.machine import Machine, on
from innervate.live.multicast import MulticastLink
from innervate.live.udp import UdpLink

HERE = "127.0.0.1"


class Watched(Machine):
    """This machine; it keeps the sockets it was asked for."""

    def __init__(self):
        self.sockets = []

    def socket(self, family, kind):
        self.sockets.append(super().socket(family, kind))
        return self.sockets[-1]


async def medium():
    made = Medium()
    made.open((HERE, 0))
    return made.close


async def radio():
    made = MediumRadio(0, (HERE, 9))
    await made.start(None)
    return made.stop


async def link():
    made = UdpLink((HERE, 0), [(HERE, 9)])
    await made.open(lambda *_: None)
    return made.close


async def group():
    made = MulticastLink(("239.77.12.2", 4711), HERE)
    await made.open(lambda *_: None)
    return made.close


@pytest.mark.parametrize("make", [medium, radio, link, group])
def test_where_nothing_has_come_reading_does_not_wait(make):
    async def main():
        close = await make()
        waiting = [one for one in machine.sockets if one.getblocking()]
        done = close()
        if done is not None:
            await done
        return len(machine.sockets), waiting

    machine = Watched()
    with on(machine):
        opened, waiting = asyncio.run(main())
    assert opened >= 1
    assert waiting == []
