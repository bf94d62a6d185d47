"""The simulation loop of a mesh: one function, compiled on arrays or plain on lists."""

from collections.abc import Callable
from typing import NamedTuple

from innervate.kernel.bits import mix
from innervate.protocol import csma, mesh_words
from innervate.protocol.arith import MASK16, MASK30
from innervate.protocol.mesh_words import ACK, MESSAGE, REPORT_GRAPH, SAMPLE, SENT
from innervate.protocol.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.scenario.mesh_plan import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim.loop import (
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
from innervate.sim.mesh import books, medium, motion, powers, queue
from innervate.sim.mesh.medium import NONE
from innervate.sim.mesh.queue import RANK_SHIFT, STATION_SHIFT, STATIONS_MAX, TIME_SHIFT, WHAT_MASK
from innervate.sim.mesh.world import ALIVE, COMMITTED, FREE, HELD, OFF, ON_AIR, TIMERS

NEVER = -1
BOOT = 7  # a command besides those of `scenario/mesh_plan.py`
COLD, MEMORY_LOST = 0, 1
MAC = 8  # in trails: a handler of the medium access
SEEN_FULL = 100  # a status: the table of deliveries is half full

RSSI_LOW, RSSI_HIGH = -128, 127
BYTE = 0xFF


class Handlers(NamedTuple):
    """A loop's parts, bound to a stack; `advance` is the loop itself."""

    drain_mac: Callable[..., int]
    hand_down: Callable[..., int]
    drain: Callable[..., None]
    finish: Callable[..., None]
    tell_sent: Callable[..., None]
    arrive: Callable[..., None]
    end: Callable[..., None]
    kill: Callable[..., None]
    switch_on: Callable[..., None]
    obey: Callable[..., None]
    offer: Callable[..., None]
    sample: Callable[..., None]
    expire: Callable[..., None]
    dispatch: Callable[..., None]
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
    if run.seen > run.seen_limit:
        return SEEN_FULL
    if world.heap.size[0] + 64 * run.nodes + 64 > len(world.heap.keys):
        return POOL_FULL
    return DONE


def set_timer(world, node, timer, at, time, now):
    """A timer of a node fires at its clock reading `at`."""
    due = time + max(0, ((at - now + (1 << 29)) & MASK30) - (1 << 29))
    if world.due[node * TIMERS + timer] != due:
        world.due[node * TIMERS + timer] = due
        queue.push(world.heap, queue.key_of(due, queue.TIMER, node, timer))


def give_up(world, node, time):
    """The medium access returns the node's frame."""
    run, radio = world.run[0], world.radios[node]
    run.gave_up += 1
    if radio.held != NONE:
        medium.release(world, radio.held)
        radio.held = NONE
    radio.tell_at = time
    queue.push(world.heap, queue.key_of(time, queue.TELL, node, 0))


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


def build(stack):
    """The loop for a stack (see stacks.py)."""
    start, hear, fire, give = stack.start, stack.hear, stack.fire, stack.give
    mac_start, mac_hear, mac_fire = stack.mac_start, stack.mac_hear, stack.mac_fire
    mac_give, mac_carrier = stack.mac_give, stack.mac_carrier
    digest, copy_frame, frame_bytes = stack.digest, stack.copy_frame, stack.frame_bytes
    is_sound = stack.is_sound

    def drain_mac(world, node, time, now, handler):
        """Carry out what the medium access wants: True if it hands up the frame it was given."""
        run, out, radio = world.run[0], world.mac_out, world.radios[node]
        mark = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ handler)
        handed_up = False
        for i in range(out.count[0]):
            act = out.action[i]
            kind, a, b, c = act.kind, act.a, act.b, act.c
            mark = mix(mark, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
            if kind == SEND:
                medium.commit(world, radio.hot if c & URGENT else radio.held, time)
            elif kind == SET_TIMER:
                set_timer(world, node, mesh_words.TIMERS + a, b, time, now)
            elif kind == REPORT and a == csma.REPORT_GAVE_UP:
                give_up(world, node, time)
            elif kind == DELIVER:
                handed_up = True
        out.count[0] = 0
        run.fingerprint = mark
        if out.overflow[0]:
            books.breaks(world, books.BROKEN_OUTBOX, node)
        if run.watchful:
            books.keep_step(world, node, time, handler, 0)
        return handed_up

    def hand_down(world, node, frame, attempt, urgent, time, now):
        """The router sends a frame: put it where frames under way are; returns its digest."""
        run, radio, item = world.run[0], world.radios[node], world.mac_item[0]
        if radio.held != NONE and not urgent:
            books.breaks(world, books.BROKEN_HELD, node)
            return 0
        if radio.deaf and (urgent or not run.mac):
            run.blocked += 1
            if not urgent:
                give_up(world, node, time)
            return 0
        place = medium.reserve(world, node, HELD)
        if place == NONE:
            return 0
        kept = world.frames[place]
        copy_frame(kept, frame)
        mark = digest(kept)
        world.air[place].digest = mark
        if not urgent and (run.mac or run.told):
            radio.held = place
        if not run.mac:
            medium.commit(world, place, time)
            return mark
        radio.hot = place
        item.us = medium.airtime(world, frame_bytes(kept))
        item.urgent = 1 if urgent else 0
        item.attempt = attempt
        mac_give(world, node, now & MASK30, csma.PACKET)
        drain_mac(world, node, time, now, MAC + ON_INPUT)
        return mark

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
                books.keep_row(world, time, node, a, b, c)
                if a == REPORT_GRAPH:
                    books.keep_round(world, node, time)
            elif kind == DELIVER:
                run.fingerprint = mix(mark, digest(out.frame[i]))
                books.keep_delivered(world, node, out.frame[i], time)
        out.count[0] = 0
        if out.overflow[0]:
            books.breaks(world, books.BROKEN_OUTBOX, node)

    def finish(world, node, time, now, handler, port):
        """After a handler: account for it, carry out what it asked for, check."""
        run = world.run[0]
        run.handled += 1
        run.fingerprint = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ (port << 40) ^ handler)
        if world.out.count[0] > 0:
            drain(world, node, time, now)
        if run.watchful:
            if run.checks and not is_sound(world, node):
                books.breaks(world, books.BROKEN_RANGE, node)
            books.keep_step(world, node, time, handler, port)

    def tell_sent(world, node, time, ok):
        """The router's frame has left the air, or could not."""
        if world.run[0].told:
            world.item[0].ok = ok
            now = time + world.radios[node].offset
            give(world, node, now & MASK30, SENT)
            finish(world, node, time, now, ON_INPUT, SENT)

    def arrive(world, node, place, time):
        """A node has received the frame at `place`."""
        run, frame = world.run[0], world.frames[place]
        now = time + world.radios[node].offset
        if frame.kind != ACK:
            rssi = (world.rssi[world.air[place].node * run.nodes + node] + 50) // 100
            frame.rssi = min(max(rssi, RSSI_LOW), RSSI_HIGH)
        run.arrived += 1
        if run.mac:
            mac_hear(world, node, now & MASK30, frame)
            if not drain_mac(world, node, time, now, MAC + ON_FRAME):
                return
        hear(world, node, now & MASK30, frame)
        finish(world, node, time, now, ON_FRAME, frame.kind)

    def end(world, place, time):
        """A frame has left the air: receivers first, then its sender is told."""
        run, air = world.run[0], world.air[place]
        frame, node, is_whole = world.frames[place], air.node, air.state == ON_AIR
        if is_whole:
            medium.leave(world, place)
            count = medium.receivers(world, place)
            books.keep_sent(world, place, time, frame_bytes(frame), count)
            for i in range(count):
                arrive(world, world.got[i], place, time)
            if run.checks and digest(frame) != air.digest:
                books.breaks(world, books.BROKEN_FRAME, node)
        medium.release(world, place)
        if is_whole and world.radios[node].held == place:
            world.radios[node].held = NONE
            tell_sent(world, node, time, 1)

    def kill(world, node, time):
        """A node stops, in mid-frame too."""
        for place in range(len(world.air)):
            air = world.air[place]
            if air.node == node and air.state != FREE:
                length = frame_bytes(world.frames[place])
                books.keep_sent(world, place, time, length, 0)
                medium.abandon(world, place)
        medium.die(world, node)

    def switch_on(world, node, time, cause):
        """A node starts."""
        radio = world.radios[node]
        if cause == MEMORY_LOST:
            wipe(world, node)
        medium.miss(world, node, time)
        radio.state, radio.told = ALIVE, 0
        radio.boots += 1
        for timer in range(TIMERS):
            world.due[node * TIMERS + timer] = NEVER
        now = time + radio.offset
        if world.run[0].mac:
            mac_start(world, node, now & MASK30, cause)
            drain_mac(world, node, time, now, MAC + ON_START)
        start(world, node, now & MASK30, cause)
        finish(world, node, time, now, ON_START, cause)

    def obey(world, index, time):
        """An event of the scenario."""
        command = world.commands[index]
        action, node = command.action, command.node
        state = world.radios[node].state
        if (action == KILL or action == RESTART) and state == ALIVE:
            kill(world, node, time)
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
        give(world, node, now & MASK30, MESSAGE)
        finish(world, node, time, now, ON_INPUT, MESSAGE)

    def sample(world, index, time):
        """A robot learns where it is."""
        node = world.walks[index].node
        motion.walk_on(world, index, time)
        if motion.tell_place(world, node):
            now = time + world.radios[node].offset
            give(world, node, now & MASK30, SAMPLE)
            finish(world, node, time, now, ON_INPUT, SAMPLE)
        at = time + world.run[0].sample
        queue.push(world.heap, queue.key_of(at, queue.SAMPLE, node, index))

    def expire(world, node, timer, time):
        """A timer is due, if it has not been set anew."""
        run, radio = world.run[0], world.radios[node]
        if world.due[node * TIMERS + timer] != time or radio.state != ALIVE:
            return
        world.due[node * TIMERS + timer] = NEVER
        now = time + radio.offset
        if timer < mesh_words.TIMERS:
            fire(world, node, now & MASK30, timer)
            finish(world, node, time, now, ON_TIMER, timer)
            return
        run.handled += 1
        carrier = 1 if medium.senses(world, node) else 0
        if carrier != radio.told:
            radio.told = carrier
            mac_carrier(world, node, now & MASK30, carrier, 0)
        mac_fire(world, node, now & MASK30, timer - mesh_words.TIMERS)
        drain_mac(world, node, time, now, MAC + ON_TIMER)

    def dispatch(world, key, time):
        """Hand the first event of the queue to what it is for."""
        run = world.run[0]
        rank = (key >> RANK_SHIFT) & 7
        node = (key >> STATION_SHIFT) & (STATIONS_MAX - 1)
        what = key & WHAT_MASK
        queue.pop(world.heap)
        if rank == queue.ENDS:
            end(world, what, time)
        elif rank == queue.STARTS:
            if world.air[what].state == COMMITTED:
                medium.start(world, what, time, frame_bytes(world.frames[what]))
            else:
                medium.release(world, what)
        elif rank == queue.TIMER:
            expire(world, node, what, time)
        elif rank == queue.TELL:
            if world.radios[node].tell_at == time:
                world.radios[node].tell_at = NEVER
                tell_sent(world, node, time, 0)
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
            if run.status != DONE or heap.size[0] == 0:
                return
            key = heap.keys[0]
            time = key >> TIME_SHIFT
            if time >= until:
                return
            run.now = time
            dispatch(world, key, time)
        run.status = BUDGET

    return Handlers(
        *(drain_mac, hand_down, drain, finish, tell_sent, arrive, end, kill, switch_on),
        *(obey, offer, sample, expire, dispatch, advance),
    )
