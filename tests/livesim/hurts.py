"""What is done to a network: each of these begins now, and ends by itself after a while."""

from tests.livesim.host import TERM
from tests.livesim.world import SECOND


def cable(stage):
    """One cable's ways."""
    return stage.cables[stage.chance.choice(sorted(stage.cables))]


def lossy(stage):
    """Frames are lost on a cable, one way or both."""
    share = stage.chance.choice((0.02, 0.1, 0.3, 0.6))
    _for_a_while(stage, cable(stage), "loss", share)


def doubled(stage):
    """Frames come twice."""
    _for_a_while(stage, cable(stage), "double", 0.3)


def changing(stage):
    """Frames are damaged on their way."""
    _for_a_while(stage, cable(stage), "change", 0.1)


def late(stage):
    """A cable becomes slow, and frames overtake each other."""
    _for_a_while(stage, cable(stage), "delay_us", (100, 6000))


def sluggish(stage):
    """A cable holds frames up for seconds, as a full buffer does."""
    _for_a_while(stage, cable(stage), "delay_us", (200_000, 5_000_000))


def cut(stage):
    """A cable carries nothing."""
    _for_a_while(stage, cable(stage), "cut", True)


def flapping(stage):
    """A cable comes and goes, again and again."""
    ways = cable(stage)
    wait_s = stage.chance.uniform(0.05, 1.0)
    for k in range(stage.chance.randint(5, 40)):
        stage.world.after(k * wait_s, _set, stage, ways, "cut", k % 2 == 0, stage.storm)
    stage.world.after(41 * wait_s, _set, stage, ways, "cut", False, stage.storm)


def partition(stage):
    """Two halves that do not hear each other."""
    half = {host.number for host in stage.hosts if stage.chance.random() < 0.5}
    for (a, b), ways in stage.cables.items():
        if (a in half) != (b in half):
            _for_a_while(stage, ways, "cut", True, both=True)


def crash(stage):
    """A process is killed at whatever it does next, and started again."""
    host = stage.chance.choice(stage.hosts)
    if host.life is not None:
        host.life.loop.crash_after = stage.chance.randint(1, 40)
        _back(stage, host)


def power(stage):
    """A machine's power goes off, perhaps in the middle of writing a file."""
    host = stage.chance.choice(stage.hosts)
    if stage.chance.random() < 0.5:
        host.cut_power()
    elif host.life is not None:
        host.disk.cut_after = stage.chance.randint(1, 6)
    _back(stage, host)


def ended(stage):
    """A process is told to end, and started again."""
    host = stage.chance.choice(stage.hosts)
    host.signal(TERM)
    _back(stage, host, 3.0)


def restarts(stage):
    """One process is killed again and again."""
    host = stage.chance.choice(stage.hosts)
    at_s = 0.0
    for _ in range(stage.chance.randint(3, 8)):
        at_s += stage.chance.uniform(0.3, 8.0)
        stage.world.after(at_s, _again, stage, host, stage.storm)


def stall(stage):
    """A process gets no processor for a while."""
    host, some_s = stage.chance.choice(stage.hosts), stage.chance.choice((0.02, 0.1, 0.5, STALL_S))
    if host.life is None or host.life.loop.stalled_until <= stage.world.now + STALL_S * SECOND:
        host.stall(some_s)


def held_up(stage):
    """A process is stopped for long, as by SIGSTOP, and then finds what came meanwhile."""
    now, shortest_s = stage.world.now, stage.chance.choice((5, 60))
    some_s = stage.chance.uniform(shortest_s, 150) * (10 if stage.plan.slow > 1 else 1)
    if all(host.life is None or host.life.loop.stalled_until <= now for host in stage.hosts):
        left_s = (stage.storm_ends - now) / SECOND
        stage.chance.choice(stage.hosts).stall(min(some_s, left_s))


def clock(stage):
    """A machine's idea of the time jumps."""
    host = stage.chance.choice(stage.hosts)
    host.wall_ns += stage.chance.choice((-3600, -30, -1, 1, 30, 86_400)) * SECOND


def full(stage):
    """A disk has no room for a while."""
    host = stage.chance.choice(stage.hosts)
    host.disk.full = True
    stage.world.after(_while(stage), lambda: setattr(host.disk, "full", False))


def rotation(stage):
    """Everybody has another key."""
    if stage.rotated_at is None or stage.world.now - stage.rotated_at > 6 * SECOND:
        stage.rotated_at = stage.world.now
        stage.rotate()


def replays(stage):
    """Somebody sends what he recorded, changed it, or made up."""
    for k in range(stage.chance.randint(5, 60)):
        stage.world.after(0.05 * k, stage.replay)


# What anybody must stand, how often it happens; and who has no seal stands no forger.
USUAL = {lossy: 4, doubled: 2, changing: 2, late: 2, sluggish: 1, cut: 4, flapping: 2,
         partition: 1, crash: 3, power: 2, ended: 1, restarts: 1, stall: 3, clock: 2, full: 1,
         rotation: 1, replays: 2}  # fmt: skip
SEALED = (rotation, replays)
OPEN_ONLY = (full,)  # see test_known.py
EVERY_S = (0.3, 1.0, 4.0)
NAMED = {held_up: 4}  # where a plan says so
STALL_S = 3.0
RARELY = 60  # so much more time passes between them where a mesh is slow


def storm(stage, seconds):
    """Hurt a network for so long."""
    stage.storm += 1
    stage.quiet_since = None
    stage.storm_ends = stage.world.now + int(seconds * SECOND)
    named = stage.plan.hurts
    usual = {one: weight for one, weight in {**USUAL, **NAMED}.items()
             if (one.__name__ in named if named is not None
                 else one not in (OPEN_ONLY if stage.plan.sealed else SEALED)
                 and (one in USUAL or stage.plan.held_up))}  # fmt: skip
    at_s, every_s = 0.0, stage.chance.choice(EVERY_S) * (RARELY if stage.plan.slow > 1 else 1)
    while usual and at_s < seconds:
        hurt = stage.chance.choices(list(usual), list(usual.values()))[0]
        stage.world.after(at_s, hurt, stage)
        at_s += stage.chance.expovariate(1 / every_s)


def over(stage):
    """What still goes on ends with the storm."""
    stage.storm += 1
    stage.heal()


def _while(stage):
    some_s = stage.chance.choice((0.05, 0.5, 2.0, 10.0)) * stage.chance.uniform(0.5, 1.5)
    slow = stage.plan.slow
    return some_s * slow if slow > 1 and stage.chance.random() < 0.5 else some_s


def _for_a_while(stage, ways, name, value, both=False):
    some = ways if both or stage.chance.random() < 0.7 else (stage.chance.choice(ways),)
    for way in some:
        before = way.usual_us if name == "delay_us" else type(value)()
        setattr(way, name, value)
        stage.world.after(_while(stage), _set, stage, (way,), name, before, stage.storm)


def _set(stage, ways, name, value, storm_):
    if stage.storm == storm_:
        for way in ways:
            setattr(way, name, value)


def _back(stage, host, least_s=0.0):
    stage.world.after(least_s + _while(stage), _begin, stage, host, stage.storm)


def _begin(stage, host, storm_):
    if stage.storm == storm_:
        host.begin()


def _again(stage, host, storm_):
    if stage.storm == storm_:
        host.kill()
        host.begin()
