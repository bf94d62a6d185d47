"""A node that keeps its machine's processors awake does so from its start to its end, no longer."""

import asyncio
import os
import sys

import pytest

from innervate.live.build import build
from innervate.live.errors import LiveError
from innervate.live.machine import IDLE_STATES, Machine, on
from innervate.live.nodefile import load
from tests.fixtures.node_files import LINK, of_mesh
from tests.live.test_udp import free_port

AWAKE = of_mesh(0, 3, 'role = "gateway"\nawake = {}', LINK.replace("127.0.0.1:0", "{}"))


def node_of(folder, awake="true", bind=None):
    path = folder / "n0.toml"
    path.write_text(AWAKE.format(awake, bind or f"127.0.0.1:{free_port()}"))
    return build(load(path))


def wake_up_most_us():
    """The longest that a wake-up may take, as the kernel has it now."""
    with open(IDLE_STATES, "rb", buffering=0) as file:
        return int.from_bytes(file.read(4), sys.byteorder, signed=True)


@pytest.mark.skipif(not os.access(IDLE_STATES, os.R_OK | os.W_OK), reason=f"no {IDLE_STATES} here")
def test_processors_stay_awake_while_the_node_runs(tmp_path):
    before = wake_up_most_us()
    assert before > 0, "something else on this machine keeps it awake"

    async def main():
        async with node_of(tmp_path):
            assert wake_up_most_us() == 0
        assert wake_up_most_us() == before
        async with node_of(tmp_path, "false"):
            assert wake_up_most_us() == before
        with pytest.raises(LiveError, match="cannot use UDP address"):
            await node_of(tmp_path, bind="203.0.113.1:4700").start()
        assert wake_up_most_us() == before

    asyncio.run(main())


class Refuses(Machine):
    """A machine whose user may not."""

    def keep_awake(self):
        raise PermissionError(13, "Permission denied", str(IDLE_STATES))


def test_a_user_who_may_not_is_told_before_anything_is_open(tmp_path):
    async def main():
        node = node_of(tmp_path)
        with pytest.raises(LiveError) as told:
            await node.start()
        assert str(told.value) == (
            "awake = true: /dev/cpu_dma_latency: Permission denied; let this user write to it, "
            "or take the line out"
        )
        assert not (tmp_path / "n0.state").exists()

    with on(Refuses()):
        asyncio.run(main())
