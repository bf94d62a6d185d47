"""Time that passes when nothing is left to do, and processes that share it."""

import asyncio
import heapq
import random
from collections import deque
from contextvars import Context
from itertools import count

from innervate.live.machine import Machine, on

SECOND = 1_000_000_000
TURN_NS = 1_000  # what a turn of a process's loop takes, so that time passes whatever it does
TURNS_MOST = 200_000  # of one process within a second: more is a loop that does not end


class Broken(AssertionError):
    """Something that must not happen has happened."""


class PowerCut(BaseException):
    """The machine goes off in the middle of what it does; nothing of ours may catch that."""


class World:
    """One clock and one order of events for everything; chance comes from one seed."""

    def __init__(self, seed):
        self.seed = seed
        self.now = 0
        self.broken = []
        self.events = 0
        self.lives = []
        self._heap = []
        self._order = count()

    def chance(self, name):
        """A stream of random numbers of its own."""
        return random.Random(f"{self.seed} {name}")

    def at(self, when, what, *args):
        """Call something at a time, ns."""
        heapq.heappush(self._heap, (max(when, self.now), next(self._order), what, args))

    def after(self, wait_s, what, *args):
        """Call something after so many seconds."""
        self.at(self.now + int(wait_s * SECOND), what, *args)

    def run(self, seconds):
        """Let so much time pass, or less: until something is broken."""
        until = self.now + int(seconds * SECOND)
        heap = self._heap
        while heap and heap[0][0] <= until and not self.broken:
            self.now, _, what, args = heapq.heappop(heap)
            self.events += 1
            what(*args)
        self.check()
        self.now = max(self.now, until)

    def check(self):
        """Go no further where something is broken."""
        if self.broken:
            raise Broken(self.broken[0])

    def end(self):
        """Whoever still runs is gone, and leaves nothing behind."""
        for life in self.lives:
            life.alive = False
            life.loop.bury()
        self.lives, self._heap = [], []

    def fail(self, text):
        """Something is broken: the run ends here."""
        self.broken.append(f"{self.now / SECOND:.6f} s: {text}")


class Loop(asyncio.AbstractEventLoop):
    """asyncio's loop of one process: its turns come when the world says so.

    Args:
        world: whose time it is.
        life: whose loop it is: with `clock()` (ns) and `alive`.
    """

    def __init__(self, world, life):
        self.world = world
        self.life = life
        self.tasks = []
        self.readers = {}
        self.writers = {}
        self.signals = {}
        self.stalled_until = 0
        self.crash_after = None  # so many more steps, then the process is killed
        self._ready = deque()
        self._turn_due = False
        self._turns = 0
        self._second = 0

    def time(self):
        return self.life.clock() / 1e9

    def call_soon(self, callback, *args, context=None):
        handle = asyncio.Handle(callback, args, self, context)
        self._push(handle)
        return handle

    call_soon_threadsafe = call_soon

    def call_later(self, delay, callback, *args, context=None):
        return self.call_at(self.time() + delay, callback, *args, context=context)

    def call_at(self, when, callback, *args, context=None):
        handle = asyncio.TimerHandle(when, callback, args, self, context)
        self.world.at(self.life.world_time(when), self._due, handle)
        return handle

    def _timer_handle_cancelled(self, handle):
        """Nothing to do: a cancelled timer is left out when its time comes."""

    def _due(self, handle):
        if not handle._cancelled:
            self._push(handle)

    def _push(self, handle):
        self._ready.append(handle)
        if not self._turn_due:
            self._turn_due = True
            world = self.world
            world.at(max(world.now, self.stalled_until), self._turn)

    def _turn(self):
        """Run what was ready when the turn began; a process may end at every step."""
        self._turn_due = False
        if not self.life.alive:
            return
        if self.world.now < self.stalled_until:
            self._turn_due = True
            self.world.at(self.stalled_until, self._turn)
            return
        self._count()
        asyncio._set_running_loop(self)
        try:
            for _ in range(len(self._ready)):
                handle = self._ready.popleft()
                if not handle._cancelled:
                    handle._run()
                if self._dies():
                    return
        except PowerCut:
            return
        finally:
            asyncio._set_running_loop(None)
        if self._ready and not self._turn_due:
            self._turn_due = True
            self.world.at(self.world.now + TURN_NS, self._turn)

    def _dies(self):
        if self.crash_after is not None and self.life.alive:
            self.crash_after -= 1
            if self.crash_after <= 0:
                self.crash_after = None
                self.life.die()
        return not self.life.alive

    def _count(self):
        second = self.world.now // SECOND
        if second != self._second:
            self._second, self._turns = second, 0
        self._turns += 1
        if self._turns > TURNS_MOST:
            self.world.fail(f"{self.life.name}: its loop turns without end")

    def create_future(self):
        return asyncio.Future(loop=self)

    def create_task(self, coroutine, *, name=None, context=None):
        task = asyncio.Task(coroutine, loop=self, name=name, context=context)
        self.tasks = [one for one in self.tasks if not one.done()]
        self.tasks.append(task)
        return task

    def get_debug(self):
        return False

    def is_running(self):
        return self.life.alive

    def is_closed(self):
        return not self.life.alive

    def call_exception_handler(self, context):
        if self.life.alive:
            error = context.get("exception")
            self.world.fail(f"{self.life.name}: {context.get('message')}: {error!r}")

    def add_reader(self, fd, callback, *args):
        self.readers[fd] = asyncio.Handle(callback, args, self, None)
        self.life.look(fd)

    def remove_reader(self, fd):
        return self.readers.pop(fd, None) is not None

    def add_writer(self, fd, callback, *args):
        self.writers[fd] = asyncio.Handle(callback, args, self, None)
        self.life.look(fd)

    def remove_writer(self, fd):
        return self.writers.pop(fd, None) is not None

    def ready(self, waiting, fd, still):
        """What waits at a file is to be called while it has a reason to."""
        handle = waiting.get(fd)
        if handle is not None and self.life.alive:
            self._push(asyncio.Handle(self._call, (waiting, fd, handle, still), self, None))

    def _call(self, waiting, fd, handle, still):
        if waiting.get(fd) is handle and still():
            handle._run()
            if still():
                self.ready(waiting, fd, still)

    def add_signal_handler(self, number, callback, *args):
        self.signals[number] = asyncio.Handle(callback, args, self, None)

    def bury(self):
        """Close what was left of a dead process: nothing of that reaches anybody."""
        asyncio._set_running_loop(self)
        try:
            with on(Machine_off()):
                for task in self.tasks:
                    task._log_destroy_pending = False
                    try:
                        task.get_coro().close()
                    except (RuntimeError, PowerCut, OSError, ValueError):
                        continue
        finally:
            asyncio._set_running_loop(None)
        self.tasks = []
        self._ready.clear()


class Machine_off(Machine):
    """A machine without power: whoever asks it for something hears nothing."""

    def say(self, text):
        pass

    def exists(self, path):
        return False

    def _off(self, *_):
        raise PowerCut

    socket = open_serial = listen_at = read_text = create = _off
    sync = replace = remove = keep_awake = _off


def inside(life, what, *args):
    """Call something in a process from outside, as its own user would."""
    context: Context = life.context
    before = asyncio._get_running_loop()
    asyncio._set_running_loop(life.loop)
    try:
        return context.run(what, *args)
    finally:
        asyncio._set_running_loop(before)
