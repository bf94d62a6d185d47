"""What soak.py does to its nodes: cables, keys, kills, jumps of their clocks, a full disk."""

import asyncio
import mmap
import secrets
import signal
import struct
import subprocess
from pathlib import Path

CUT_S = (0.2, 1.5)  # a cable is cut, then whole, for a time between these
ROTATE_S = 20.0
GRACE_S = 2.0
KILL_S = (10.0, 20.0)
AWAY_S = (0.1, 4.0)
JUMP_S = (5.0, 15.0)
JUMPS_S = (-86_400, -60, -1, 1, 60, 86_400, 10_000_000)
FULL_S = (30.0, 60.0)
STAYS_FULL_S = 10.0
DISK_MIB = 16


class Clocks:
    """The time of day of each node, by a library between it and the system (clock.c)."""

    def __init__(self, folder, names):
        self.library = folder / "clock.so"
        source = Path(__file__).with_name("clock.c")
        subprocess.run(
            ["gcc", "-shared", "-fPIC", "-O2", "-o", self.library, source, "-ldl"], check=True
        )
        self.pages = {}
        for name in names:
            path = folder / f"{name}.clock"
            path.write_bytes(bytes(8))
            with path.open("r+b") as file:
                self.pages[name] = mmap.mmap(file.fileno(), 8)

    def set(self, name, ahead_s):
        self.pages[name][:] = struct.pack("q", ahead_s * 1_000_000_000)


class Disk:
    """A small file system for all files of the nodes, as root."""

    def __init__(self, folder):
        self.folder = folder
        mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_MIB}m,mode=700", "tmpfs", str(folder)]
        subprocess.run(mount, check=True)

    def fill(self):
        with (self.folder / "ballast").open("wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(4096))
            except OSError:
                pass

    def free(self):
        (self.folder / "ballast").unlink(missing_ok=True)

    def close(self):
        subprocess.run(["umount", "--lazy", str(self.folder)], check=True)


class Hurts:
    """Everything that happens to a network, until cancelled.

    Args:
        network: its processes.
        chance: where and when.
        events: counts what was done.
        clocks: of the nodes; None = theirs stay.
        disk: that of their files; None = it never fills.
    """

    def __init__(self, network, chance, events, clocks=None, disk=None):
        self.network, self.chance, self.events = network, chance, events
        self.clocks, self.disk = clocks, disk
        self.killed = {name: [] for name in network.names}  # when
        self._standing = asyncio.Lock()  # a node that is away answers to nobody
        self._writing = asyncio.Lock()  # files of nodes cannot be written while the disk is full

    async def cut_cables(self):
        while True:
            cable = self.chance.randrange(len(self.network.links))
            await self._change(cable, "cut")
            self.events["cuts"] += 1
            await asyncio.sleep(self.chance.uniform(*CUT_S))
            await self._change(cable, "restore")
            await asyncio.sleep(self.chance.uniform(*CUT_S))

    async def _change(self, cable, what):
        async with self._standing:
            await self.network.change(cable, what)

    async def change_keys(self):
        use = 1
        while True:
            await asyncio.sleep(ROTATE_S)
            use = 3 - use
            async with self._writing:
                self.network.keys = key_table(use)
                for name in self.network.names:
                    self.network.write_file(name)
                    self.network.processes[name].send_signal(signal.SIGHUP)
                    await asyncio.sleep(self.chance.uniform(0, GRACE_S / 10))
            self.events["changes of keys"] += 1

    async def kill_nodes(self):
        while True:
            await asyncio.sleep(self.chance.uniform(*KILL_S))
            name = self.chance.choice(self.network.names)
            async with self._standing:
                self.killed[name].append(asyncio.get_running_loop().time())
                await self.network.end_node(name, gently=self.chance.random() < 0.2)
                await asyncio.sleep(self.chance.uniform(*AWAY_S))
                await self.network.begin_node(name)
            self.events["restarts"] += 1

    async def turn_clocks(self):
        while True:
            await asyncio.sleep(self.chance.uniform(*JUMP_S))
            self.clocks.set(self.chance.choice(self.network.names), self.chance.choice(JUMPS_S))
            self.events["jumps of clocks"] += 1

    async def fill_disk(self):
        while True:
            await asyncio.sleep(self.chance.uniform(*FULL_S))
            async with self._writing:
                self.disk.fill()
                try:
                    await asyncio.sleep(STAYS_FULL_S)
                finally:
                    self.disk.free()
            self.events["full disks"] += 1

    async def stop(self, tasks):
        """End them, and leave every node up, every cable whole."""
        async with self._standing, self._writing:
            for task in tasks:
                task.cancel()
        for cable in range(len(self.network.links)):
            await self.network.change(cable, "cut")
            await self.network.change(cable, "restore")

    def all(self, restarts):
        yield self.cut_cables()
        yield self.change_keys()
        if restarts:
            yield self.kill_nodes()
        if self.clocks is not None:
            yield self.turn_clocks()
        if self.disk is not None:
            yield self.fill_disk()


def key_table(use):
    return {"use": use, f"secret.{use}": secrets.token_hex(32), "grace_s": GRACE_S}
