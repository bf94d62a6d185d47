"""Robots move: where they are, what their radio links are worth there, what they are told."""

from innervate.sim.field import medium, powers
from innervate.sim.field.states import ALIVE
from innervate.topology import astray
from innervate.topology.placement import UNHEARD

SPEED_MAX = 127
PLACE_MAX = 32767
HALF_SPEED = 1_000_000  # cm/us to 2 cm/s, twice


def walk_on(world, index, time):
    """Where the walker is at `time`, as x, y of its node and speed in the item."""
    walk, item = world.walks[index], world.item[0]
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
    item.vx = min(max(vx, -SPEED_MAX), SPEED_MAX)
    item.vy = min(max(vy, -SPEED_MAX), SPEED_MAX)
    if walk.placed and x == radio.x and y == radio.y:
        return
    walk.placed = 1
    radio.x, radio.y = x, y
    if world.run[0].moving:
        renew(world, walk.node)


def tell_place(world, index):
    """Where the walker believes to be as the item's position, in units from the fence's corner."""
    run, walk, item = world.run[0], world.walks[index], world.item[0]
    radio = world.radios[walk.node]
    x, y = radio.x - run.origin_x, radio.y - run.origin_y
    if walk.noise > 0:
        astray.err(walk, world.normals)
        x += astray.centimetres(walk.noise, walk.off_x)
        y += astray.centimetres(walk.noise, walk.off_y)
    item.x = min(max((x + run.unit // 2) // run.unit, -PLACE_MAX), PLACE_MAX)
    item.y = min(max((y + run.unit // 2) // run.unit, -PLACE_MAX), PLACE_MAX)
    return radio.state == ALIVE


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
