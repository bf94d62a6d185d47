"""What a member of a group says of its key, at the ends of what its numbers hold."""

import asyncio
import random

import pytest

from innervate.live.contact import ALIVE, ANSWER
from innervate.live.group import GREETING, GroupContact
from innervate.live.keyring import KEY_BYTES
from innervate.live.machine import Machine, on
from innervate.wire import seal
from tests.live.pair import Wire, network_sealer


class Extreme(random.Random):
    """Draws the least or the greatest."""

    def __init__(self, greatest):
        super().__init__(1)
        self.greatest = greatest

    def getrandbits(self, count):
        return self.greatest * ((1 << count) - 1)

    def randbytes(self, count):
        return bytes([7]) * count


class Drawing(Machine):
    def __init__(self, greatest):
        self.own = Extreme(greatest)

    @property
    def chance(self):
        return self.own


@pytest.mark.parametrize(("greatest", "epoch"), [(0, 0), (1, 65_535)])
@pytest.mark.parametrize("kind", [ALIVE, ANSWER, 0])
def test_a_key_is_told_with_its_number_and_how_far_it_is(greatest, epoch, kind):
    async def main():
        sealer, path = network_sealer(65_534), Wire(is_group=True)
        contact = GroupContact(sealer, path)
        told = contact.greeting(kind)
        if kind not in (ALIVE, ANSWER):
            assert told == b""
            return
        assert GREETING.unpack(told) == (epoch, 0, bytes([7]) * KEY_BYTES)
        contact.sessions = {1: [object()]}
        for counter in range(2):
            data = contact.close(b"frame")
            form, place, found = seal.fields(data)[:3]
            assert (form, place, found) == (seal.GROUP, 65_534 << 16 | epoch, counter)
        assert GREETING.unpack(contact.greeting(kind))[1] == 2

    with on(Drawing(greatest)):
        asyncio.run(main())
