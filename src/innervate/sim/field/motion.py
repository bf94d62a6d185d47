"""Robots move: where they are, what their radio links are worth there, what they are told."""

from innervate.sim.field import medium, powers, queue
from innervate.sim.field.states import ALIVE
from innervate.topology import astray
from innervate.topology.placement import UNHEARD

# What it calls of others' modules, to be compiled with it.
CALLED = (
    powers.chance, powers.loss,
    astray.err, astray.drawn, astray.normal, astray.next_of, astray.centimetres,
)  # fmt: skip
HALF_SPEED = 1_000_000  # cm/us to 2 cm/s, twice


def walk_on(world, index, time):
    """Where the walker is at `time`, as x, y of its node; its speed in 2 cm/s."""
    walk = world.walks[index]
    radio = world.radios[walk.node]
    while walk.point < walk.last and world.points[walk.point + 1].time <= time:
        walk.point += 1
    here = world.points[walk.point]
    x, y, vx, vy = here.x, here.y, 0, 0
    if walk.point < walk.last and here.time <= time:
        there = world.points[walk.point + 1]
        took, since = there.time - here.time, time - here.time
        x += (2 * (there.x - here.x) * since + took) // (2 * took)
        y += (2 * (there.y - here.y) * since + took) // (2 * took)
        vx = (HALF_SPEED * (there.x - here.x) + took) // (2 * took)
        vy = (HALF_SPEED * (there.y - here.y) + took) // (2 * took)
    walk.vx, walk.vy = vx, vy
    if walk.placed and x == radio.x and y == radio.y:
        return
    walk.placed = 1
    radio.x, radio.y = x, y
    if world.run[0].moving:
        renew(world, walk.node)


def believe(world, index):
    """Where the walker believes to be, in units from the run's origin."""
    run, walk = world.run[0], world.walks[index]
    radio = world.radios[walk.node]
    x, y = radio.x - run.origin_x, radio.y - run.origin_y
    if walk.noise > 0:
        astray.err(walk, world.normals)
        x += astray.centimetres(walk.noise, walk.off_x)
        y += astray.centimetres(walk.noise, walk.off_y)
    walk.told_x = (x + run.unit // 2) // run.unit
    walk.told_y = (y + run.unit // 2) // run.unit


def sample(world, do, index, time):
    """A robot is elsewhere, and learns where, if its network wants to know."""
    node = world.walks[index].node
    walk_on(world, index, time)
    do.note_carriers(world, do, time)
    believe(world, index)
    if world.radios[node].state == ALIVE:
        do.tell_place(world, do, index, time)
    at = time + world.run[0].sample
    queue.push(world.heap, queue.key_of(at, queue.SAMPLE, node, index))


def renew(world, node):
    """A node is elsewhere: all its links, both ways."""
    run, radio = world.run[0], world.radios[node]
    for j in range(run.nodes):
        if j != node:
            dx, dy = world.radios[j].x - radio.x, world.radios[j].y - radio.y
            lost = powers.loss(world.losses, dx * dx + dy * dy)
            set_link(world, node, j, lost)
            set_link(world, j, node, lost)
    if run.collisions:
        medium.note_interference(world)


def set_link(world, i, j, lost):
    """The link from i to j loses so much, 0.01 dB."""
    at = i * world.run[0].nodes + j
    if world.base[at] == UNHEARD:
        return
    rssi = world.base[at] - lost
    world.rssi[at] = rssi
    world.prob[at] = powers.chance(world.chances, rssi - world.run[0].rssi50)
    medium.set_power(world, i, j)
