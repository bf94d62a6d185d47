"""A node in one group on two interfaces: each link has what comes by its own."""

import subprocess
import sys

import pytest

from innervate.live.netns import Lab

BOTH = """
import asyncio, sys
from innervate.live.multicast import MulticastLink

async def main():
    links = [MulticastLink(("239.77.12.7", 4700), at, port) for port, at in enumerate(sys.argv[1:])]
    got = []
    for link in links:
        await link.open(lambda path, data: got.append((path.port, data.decode())))
    for link in links:
        link.paths[0].send(b"by %d" % link.paths[0].port)
        await asyncio.sleep(0.2)
    print(sorted(got))

asyncio.run(main())
"""


@pytest.mark.needs_root
@pytest.mark.needs_netns
def test_a_frame_comes_by_the_interface_on_which_it_was_sent():
    lab = Lab("ivtwo", 3, [(0, 1), (1, 2)])
    own = [lab.address(0, 1), lab.address(1, 1)]
    lab.up()
    try:
        command = lab.inside(1, [sys.executable, "-c", BOTH, *own])
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    finally:
        lab.down()
    assert done.stdout == "[(0, 'by 0'), (1, 'by 1')]\n"
