"""The simulation loop of a mesh: one function, compiled on arrays or plain on lists."""

from collections.abc import Callable
from typing import Any, NamedTuple

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.kernel.bits import mix
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol.constants import MESSAGE, REPORT_GRAPH, SAMPLE, SENT
from innervate.networks.mesh.sim import recorder
from innervate.networks.mesh.sim.timers import set_timer
from innervate.networks.mesh.sim.world import TIMERS
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim import rows
from innervate.sim.field import medium, motion, powers, queue
from innervate.sim.field.queue import RANK_SHIFT, STATION_SHIFT, STATIONS_MAX, TIME_SHIFT, WHAT_MASK
from innervate.sim.field.states import ALIVE, OFF
from innervate.sim.status import (
    BROKEN,
    BUDGET,
    DONE,
    ON_FRAME,
    ON_INPUT,
    ON_START,
    ON_TIMER,
    POOL_FULL,
    ROWS_FULL,
)

NEVER = -1
BOOT = 7  # a command besides those of `scenario/plan.py`
COLD, MEMORY_LOST = 0, 1
DUPLICATES_FULL = 100  # a status: the table of deliveries is half full

BYTE = 0xFF


class Loop(NamedTuple):
    """A loop bound to a stack.

    Attributes:
        below, above: what the layer below the router does for it, and tells it.
        own: the loop's other parts.
        advance: the loop itself.
    """

    below: tuple[Callable[..., Any], ...]
    above: tuple[Callable[..., Any], ...]
    own: tuple[Callable[..., Any], ...]
    advance: Callable[..., None]


def pressing(world):
    """Why the loop has to stop before the next event, or DONE; limits leave room for one."""
    run = world.run[0]
    if run.broken:
        return BROKEN
    if run.rows > run.row_limit or run.sent > run.sent_limit or run.trail > run.trail_limit:
        return ROWS_FULL
    if run.delivered > run.delivered_limit or run.rounds > run.round_limit:
        return ROWS_FULL
    if run.taps > run.tap_limit:
        return ROWS_FULL
    if run.duplicates > run.duplicate_limit:
        return DUPLICATES_FULL
    if world.heap.size[0] + 64 * run.nodes + 64 > len(world.heap.keys):
        return POOL_FULL
    return DONE


def wipe(world, node):
    """A node's memory is lost: all but who it is, and how its random choices go on."""
    own, nodes, gate = world.nodes[node], world.run[0].nodes, world.radios[node].gate
    number, rank, robot, rng = own.number, own.rank, own.robot, own.rng
    words, blank = world.words[node], world.words[nodes]
    for i in range(len(world.low)):
        words[i] = blank[i]
    own.number, own.rank, own.robot, own.rng = number, rank, robot, rng
    spare = len(world.gates) - 1
    if gate != spare:
        words, blank = world.gate_words[gate], world.gate_words[spare]
        for i in range(world.run[0].gate_words):
            words[i] = blank[i]


def build(stack, layer):
    """The loop for a stack (see stacks.py) over a layer: `over_medium` or `over_channel`."""
    on_start, on_frame = stack.on_start, stack.on_frame
    on_timer, on_input = stack.on_timer, stack.on_input
    digest, is_sound = stack.digest, stack.is_sound
    below = layer.down(stack)
    hand_down, expire_below = below.hand_down, below.expire
    power_on, power_off = below.switch_on, below.switch_off
    short, due, step = layer.short, layer.due, layer.step

    def drain(world, node, time, now):
        """Carry out what a handler put into the outbox; fold it into the fingerprint."""
        run, out = world.run[0], world.out
        for i in range(out.count[0]):
            act = out.action[i]
            kind, a, b, c = act.kind, act.a, act.b, act.c
            mark = mix(run.fingerprint, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
            run.fingerprint = mark
            if kind == SEND:
                sent = hand_down(world, node, out.frame[i], b, c & URGENT, time, now)
                run.fingerprint = mix(run.fingerprint, sent)
            elif kind == SET_TIMER:
                set_timer(world, node, a, b, time, now)
            elif kind == REPORT:
                rows.record_row(world, time, node, a, b, c)
                if a == REPORT_GRAPH:
                    recorder.record_round(world, node, time)
            elif kind == DELIVER:
                run.fingerprint = mix(mark, digest(out.frame[i]))
                recorder.record_delivered(world, node, out.frame[i], time)
        out.count[0] = 0
        if out.overflow[0]:
            recorder.breaks(world, recorder.BROKEN_OUTBOX, node)

    def finish(world, node, time, now, handler, port):
        """After a handler: account for it, carry out what it asked for, check."""
        run = world.run[0]
        run.handled += 1
        run.fingerprint = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ (port << 40) ^ handler)
        if world.out.count[0] > 0:
            drain(world, node, time, now)
        if run.watchful:
            if run.checks and not is_sound(world, node):
                recorder.breaks(world, recorder.BROKEN_RANGE, node)
            rows.record_step(world, node, time, handler, port)

    def tell_sent(world, node, time, ok):
        """The router's frame has left the air, or could not."""
        if world.run[0].told:
            world.item[0].ok = ok
            now = time + world.radios[node].offset
            on_input(world, node, now & MASK30, SENT)
            finish(world, node, time, now, ON_INPUT, SENT)

    def take(world, node, frame, time):
        """A node's router is handed a frame that was received."""
        now = time + world.radios[node].offset
        on_frame(world, node, now & MASK30, frame)
        finish(world, node, time, now, ON_FRAME, frame.kind)

    above = layer.up(stack, below, take, tell_sent)
    dispatch_below = above.dispatch

    def switch_on(world, node, time, cause):
        """A node starts, for the first time or again; with MEMORY_LOST its record is wiped."""
        radio = world.radios[node]
        if cause == MEMORY_LOST:
            wipe(world, node)
        radio.state = ALIVE
        radio.boots += 1
        for timer in range(TIMERS):
            world.due[node * TIMERS + timer] = NEVER
        now = time + radio.offset
        power_on(world, node, time, now, cause)
        on_start(world, node, now & MASK30, cause)
        finish(world, node, time, now, ON_START, cause)

    def obey(world, index, time):
        """An event of the scenario."""
        command = world.commands[index]
        action, node = command.action, command.node
        state = world.radios[node].state
        if (action == KILL or action == RESTART) and state == ALIVE:
            power_off(world, node, time)
            medium.die(world, node)
        if action == BOOT and state == OFF:
            switch_on(world, node, time, COLD)
        elif (action == REVIVE and state != ALIVE) or action == RESTART:
            switch_on(world, node, time, MEMORY_LOST)
        elif action == CUT or action == RESTORE:
            medium.set_cut(world, node, command.other, action == CUT)
        elif action == JAM:
            medium.set_noise(world, node, powers.strength(world.strengths, command.value))
        elif action == QUIET:
            medium.set_noise(world, node, 0)

    def offer(world, index, time):
        """Hand a message down; its first bytes are the offer's index."""
        message, item = world.offers[index], world.item[0]
        node = message.node
        if world.radios[node].state != ALIVE:
            world.run[0].unasked += 1
            return
        item.handle = index & MASK16
        item.dest, item.flags, item.length = message.dest, message.flags, message.length
        for i in range(message.length):
            item.body[i] = (index >> (8 * (i & 3))) & BYTE
        now = time + world.radios[node].offset
        on_input(world, node, now & MASK30, MESSAGE)
        finish(world, node, time, now, ON_INPUT, MESSAGE)

    def sample(world, index, time):
        """A robot learns where it is."""
        node = world.walks[index].node
        motion.walk_on(world, index, time)
        if motion.tell_place(world, node):
            now = time + world.radios[node].offset
            on_input(world, node, now & MASK30, SAMPLE)
            finish(world, node, time, now, ON_INPUT, SAMPLE)
        at = time + world.run[0].sample
        queue.push(world.heap, queue.key_of(at, queue.SAMPLE, node, index))

    def expire(world, node, timer, time):
        """A timer is due, if it has not been set anew."""
        radio = world.radios[node]
        if world.due[node * TIMERS + timer] != time or radio.state != ALIVE:
            return
        world.due[node * TIMERS + timer] = NEVER
        now = time + radio.offset
        if timer < mesh_const.TIMERS:
            on_timer(world, node, now & MASK30, timer)
            finish(world, node, time, now, ON_TIMER, timer)
        else:
            expire_below(world, node, timer, time, now)

    def dispatch(world, key, time):
        """Hand the first event of the queue to what it is for."""
        run = world.run[0]
        rank = (key >> RANK_SHIFT) & 7
        node = (key >> STATION_SHIFT) & (STATIONS_MAX - 1)
        what = key & WHAT_MASK
        queue.pop(world.heap)
        if rank == queue.TIMER:
            expire(world, node, what, time)
        elif rank < queue.TIMER:
            dispatch_below(world, rank, node, what, time)
        elif rank == queue.SAMPLE:
            sample(world, what, time)
        elif rank == queue.OFFER:
            offer(world, run.next_offer, time)
            run.next_offer += 1
            if run.next_offer < run.offers:
                at = world.offers[run.next_offer].time
                queue.push(world.heap, queue.key_of(at, queue.OFFER, 0, 0))
        else:
            obey(world, run.next_command, time)
            run.next_command += 1
            if run.next_command < run.commands:
                at = world.commands[run.next_command].time
                queue.push(world.heap, queue.key_of(at, queue.COMMAND, 0, 0))

    def advance(world, until, budget):
        """Run up to, not including, time `until` (us), or `budget` events."""
        run, heap = world.run[0], world.heap
        for _ in range(budget):
            run.status = pressing(world)
            if run.status == DONE:
                run.status = short(world)
            if run.status != DONE:
                return
            key = heap.keys[0] if heap.size[0] > 0 else queue.LAST
            soon, time = due(world), key >> TIME_SHIFT
            if min(soon, time) >= until:
                return
            run.now = min(soon, time)
            if soon < time:
                step(world, soon)
            else:
                dispatch(world, key, time)
        run.status = BUDGET

    own = (drain, finish, tell_sent, take, switch_on, obey, offer, sample, expire, dispatch)
    return Loop(below, above, own, advance)
