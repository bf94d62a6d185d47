"""A simulated machine and the lives of the process on it: clocks, disk, sockets, crashes."""

import contextvars
import errno
import signal
import socket
from itertools import count
from pathlib import Path

from innervate.live.errors import LiveError
from innervate.live.machine import Machine, on
from innervate.live.main import Process
from innervate.live.nodefile import load
from tests.livesim.disk import Disk
from tests.livesim.net import Datagrams
from tests.livesim.world import SECOND, Loop, PowerCut, inside

EPOCH_NS = 1_800_000_000 * SECOND


class Host:
    """A machine that stays: its disk, its idea of the time, its addresses.

    Attributes:
        life: the process that runs on it, None = none does.
        lives: how many have begun.
        wall_ns: how far its wall clock is off.
        ppm: how much its clocks run fast.
    """

    def __init__(self, world, net, name, addresses, file):
        self.world, self.net, self.name, self.addresses = world, net, name, addresses
        self.chance = world.chance(f"host {name}")
        self.disk = Disk(self.chance)
        self.disk.on_cut = self._power_cut
        self.path = Path(f"/{name}/{name}.toml")
        self.disk.put(self.path, file)
        self.wall_ns = self.chance.randrange(-SECOND, SECOND)
        self.ppm = self.chance.uniform(-100, 100)
        self.life = None
        self.lives = 0
        self.said = []
        self.how = ""
        self.boots = 1
        self.boot_ns = self.chance.randrange(SECOND, 10**15)  # its clock that never jumps, at 0
        self.main = None  # what runs on it in place of a node
        self.serial = {}  # device: the end of a line
        self.on_begin = lambda life: None
        self.on_end = lambda life, how: None

    def begin(self):
        """Start the process; it goes on by itself."""
        if self.life is None:
            self.lives += 1
            self.life = Life(self, self.lives)
            self.life.begin()

    def kill(self):
        """SIGKILL: at once, and the disk is as processes see it."""
        if self.life is not None:
            self.life.die("killed")

    def cut_power(self):
        """The machine goes off; what was not safe is lost."""
        if self.life is not None:
            self._power_cut()

    def _power_cut(self):
        life = self.life
        if life is not None:
            life.die("power")
        self.disk.power_cut()
        self.boots += 1

    def signal(self, number):
        """A signal to the process."""
        life = self.life
        if life is not None and number in life.loop.signals:
            life.loop._push(life.loop.signals[number])

    def stall(self, seconds):
        """The process gets no processor for a while."""
        if self.life is not None:
            self.life.loop.stalled_until = self.world.now + int(seconds * SECOND)

    def state_path(self):
        """Where its node keeps what it keeps."""
        return self.path.with_suffix(".state")


class Life(Machine):
    """A process from its start to its end, and the machine as it sees it."""

    def __init__(self, host, number):
        self.host, self.number = host, number
        self.name = f"{host.name} (life {number})"
        self.world = host.world
        self.alive = True
        self.chance = host.chance
        self.began = host.world.now
        self.files = {}
        self.process = None
        self.node = None
        self.how = ""
        self._fds = count(3)
        self.loop = Loop(host.world, self)
        self.context = contextvars.copy_context()
        self.world.lives = [one for one in self.world.lives if one.alive] + [self]

    def begin(self):
        """Load the node's file, and run it."""
        inside(self, self._begin)

    def _begin(self):
        with on(self):
            self.context = contextvars.copy_context()
        inside(self, self._run)

    def _run(self):
        try:
            task = self._main()
        except LiveError as error:
            self._ended(error)
            return
        except PowerCut:
            return
        task = self.loop.create_task(task, context=self.context)
        task.add_done_callback(self._done, context=self.context)

    def _main(self):
        if self.host.main is not None:
            return self.host.main()
        self.process = Process(load(self.host.path))
        self.node = self.process.node
        self.host.on_begin(self)
        return self.process.run()

    def _done(self, task):
        if self.alive:
            self._ended(None if task.cancelled() else task.exception())

    def _ended(self, error):
        """The process has ended by itself."""
        self.how = "ended" if error is None else f"{error!r}"
        if error is not None and not isinstance(error, LiveError):
            self.world.fail(f"{self.name}: {error!r}")
        self.die(self.how)

    def die(self, how="killed"):
        """Nothing of this process happens any more."""
        if not self.alive:
            return
        self.alive = False
        self.how = how
        self.host.life = None
        self.host.how = how
        for file in list(self.files.values()):
            file.close()
        self.host.on_end(self, how)
        self.world.at(self.world.now, self.loop.bury)

    def clock(self):
        """The clock that never jumps, ns; it runs a little fast or slow."""
        passed = self.world.now
        return self.host.boot_ns + int(passed * (1 + self.host.ppm / 1e6))

    def world_time(self, when_s):
        """When that clock shows so many seconds, ns of the world, rounded up."""
        passed = int(when_s * 1e9) - self.host.boot_ns
        return int(passed / (1 + self.host.ppm / 1e6)) + 400

    def look(self, fd):
        """A loop begins to wait for a file: something may be there already."""
        self.files[fd].look()

    def monotonic_ns(self):
        return self.clock()

    def boot(self):
        return f"{self.host.name} {self.host.boots}"

    def time_ns(self):
        return EPOCH_NS + self.world.now + self.host.wall_ns

    def log(self, text):
        self.host.said.append((self.world.now, text))
        if self.host.disk.full:
            raise OSError(errno.ENOSPC, "No space left on device")

    def socket(self, family, kind):
        self._check()
        assert (family, kind) == (socket.AF_INET, socket.SOCK_DGRAM)
        return self._open(Datagrams(self, self.host.net, next(self._fds)))

    def open_serial(self, device, baud):
        self._check()
        if device not in self.host.serial:
            raise FileNotFoundError(errno.ENOENT, "No such file or directory", device)
        return self._open(self.host.serial[device].plug_in(self, next(self._fds)))

    def listen_at(self, path):
        self._check()
        return self._open(Door(self, next(self._fds)))

    def exists(self, path):
        self._check()
        return str(path) in self.host.disk.names

    def inode(self, path):
        self._check()
        return 1

    def read_text(self, path):
        self._check()
        return self.host.disk.read_text(path)

    def create(self, path):
        self._check()
        return self.host.disk.create(path)

    def sync(self, file):
        self._check()
        self.host.disk.sync(file)

    def replace(self, old, new):
        self._check()
        self.host.disk.replace(old, new)
        self.host.disk.sync_names()

    def remove(self, path):
        self._check()
        if path.suffix != ".sock":
            self.host.disk.remove(path)

    def _open(self, file):
        self.files[file.fd] = file
        return file

    def _check(self):
        if not self.alive:
            raise PowerCut


class Door:
    """A Unix socket at which nobody calls."""

    def __init__(self, life, fd):
        self.life, self.fd = life, fd

    def fileno(self):
        return self.fd

    def setblocking(self, _flag):
        pass

    def listen(self, _backlog):
        pass

    def look(self):
        pass

    def close(self):
        self.fd = -1


TERM, HUP = signal.SIGTERM, signal.SIGHUP
