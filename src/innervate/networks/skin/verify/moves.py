"""What can happen to a skin: its protocol's handlers, bound to rows of bytes.

With MERGE (periodic updates) a beacon is taken in right before its receiver's next tick: until then
nothing it brings is looked at, so every order of the two is the same state. What has not arrived
by then may arrive later; a lost beacon is one that never does.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from innervate.dialect.outbox import REPORT, SEND
from innervate.kernel.compilation import bound
from innervate.kernel.records import within
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.verify import row as rows
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.check import check, is_settled
from innervate.networks.skin.verify.reduction import tidy

REFUSED = -1


class System(NamedTuple):
    """A skin as the search (see search.py) and the fair schedule see it."""

    parts: tuple[Callable[..., Any], ...]
    start: Callable[..., Any]
    variants: Callable[..., Any]
    step: Callable[..., Any]
    check: Callable[..., Any]
    settle: Callable[..., Any]
    turn: Callable[..., Any]
    is_settled: Callable[..., Any]


def queued(world, way):
    """Frames in flight on a direction."""
    return world.work[world.queue_at[way]]


def first_loaded(world):
    """The first direction with a frame in flight, or NONE."""
    for way in range(world.at[w.DIRECTIONS]):
        if queued(world, way) > 0:
            return way
    return const.NONE


def may_break(world, c, p):
    """1 if the next tick may find this port broken: the cable is cut, or a false detection."""
    slot = world.port_at[const.PORTS * c + p]
    if (world.work[slot + w.SAYS] >> 2) & 3:
        return 0
    # Periodic cells look at a port in ticks only: without a route there nobody can tell, except
    # who counts the rounds until all is well again.
    is_periodic = world.params[0].updates == const.PERIODIC
    if is_periodic and world.at[w.KEEP] == 0 and world.work[slot + w.DIST] == const.INFINITY:
        return 0
    link = world.in_way[const.PORTS * c + p] // 2
    return 1 if not rows.is_up(world, link) or rows.has_budget(world, w.FALSE) else 0


def options(world, c, p):
    """Ways in which a port can come into its cell's next tick: beacons taken in, or broken."""
    count = 1 + may_break(world, c, p)
    if world.at[w.MERGE]:
        count = count + queued(world, world.in_way[const.PORTS * c + p])
    return count


def tick_variants(world, c):
    """Ways in which a cell can tick."""
    if world.work[world.cell_at[c] + w.TICKS] == 0:
        return 0
    ways = 1
    for p in range(const.PORTS):
        if world.port_at[const.PORTS * c + p] >= 0:
            ways = ways * options(world, c, p)
    return ways


def pc_variants(world):
    """Ways in which the PC can tick."""
    at = world.at[w.PC_AT]
    if world.work[at + w.PC_LISTEN] == 0 and world.work[at + w.PC_COUNTS] == 0:
        return 0
    ways = 1
    if world.at[w.MERGE]:
        for p in range(world.pc.own[0].ports):
            ways = ways * (1 + queued(world, world.in_way[const.PORTS * world.at[w.CELLS] + p]))
    return ways


def variants(world, move):
    """In how many ways a move can be made; 0 if it cannot."""
    kind, arg = world.move_kind[move], world.move_arg[move]
    if world.at[w.PROMPT]:
        loaded = first_loaded(world)
        if loaded != const.NONE and not ((kind == w.DELIVER or kind == w.LOSE) and arg == loaded):
            return 0
    if kind == w.TICK:
        return tick_variants(world, arg)
    if kind == w.PC_TICK:
        return pc_variants(world)
    if kind == w.SOON:
        return 1 if world.work[world.cell_at[arg] + w.FLAGS] & rows.IS_SOON else 0
    if kind == w.DELIVER:
        return 1 if queued(world, arg) > 0 else 0
    if kind == w.LOSE:
        return 1 if queued(world, arg) > 0 and rows.has_budget(world, w.LOSS) else 0
    if kind == w.CUT_LINK:
        return 1 if rows.is_up(world, arg) and rows.has_budget(world, w.CUT) else 0
    if kind == w.HEAL_LINK:
        return 1 if not rows.is_up(world, arg) and rows.has_budget(world, w.HEAL) else 0
    # A PC that never sends again is as dead as before; in the fair schedule it does.
    sends = world.at[w.KEEP] or world.work[world.at[w.PC_AT] + w.PC_COUNTS] > 0
    return 1 if sends and rows.has_budget(world, w.RESTART) else 0


def change_link(world, link, down):
    """Cut a cable, with all frames on it, or mend it."""
    world.work[world.at[w.LINK_AT] + link] = down
    rows.clear(world, 2 * link)
    rows.clear(world, 2 * link + 1)


def check_range(world):
    """Note a value of scratch record 0 that is outside its declared range."""
    if not within(world.words[0], world.low, world.high):
        world.found[0] = w.BROKEN_RANGE


def check_feasible(world, known, sq, dist, forgot):
    """Note a feasible distance that got worse without being forgotten; numbers do not wrap here."""
    cell = world.cells[0]
    if world.at[w.FEASIBLE] == 0 or forgot or known == 0:
        return
    if cell.fd_known == 0 or cell.fd_sq < sq or (cell.fd_sq == sq and cell.fd_dist > dist):
        world.found[0] = w.BROKEN_WORSE


def drain(world, first_end):
    """Carry out what a handler asked for; 1 if it forgot its feasible distance."""
    out = world.out
    forgot = 0
    for i in range(out.count[0]):
        act = out.action[i]
        if act.kind == SEND:
            way = world.out_way[first_end + act.a]
            if way != const.NONE and rows.is_up(world, way // 2):
                rows.push(world, way, out.frame[i])
        elif act.kind == REPORT and act.a == const.REPORT_FORGET:
            forgot = 1
    out.count[0] = 0
    if out.overflow[0]:
        world.found[0] = w.BROKEN_OUTBOX
    return forgot


def finish_cell(world, c, has_ticked):
    """After a handler of a cell: check it, put it back, send what it sends; draws it asked for."""
    cell, row, at = world.cells[0], world.work, world.cell_at[c]
    known, sq, dist = row[at + w.FLAGS] & rows.FD_KNOWN, row[at + w.FD_SQ], row[at + w.FD_DIST]
    asked = max(cell.asked, 1)
    if asked > 1 and world.at[w.FAIR]:
        rows.note_draw(world, asked)
    cell.asked = 0
    cell.choice = 0
    check_range(world)
    rows.save_cell(world, c, has_ticked)
    forgot = drain(world, const.PORTS * c)
    check_feasible(world, known, sq, dist, forgot)
    return asked


def start(world, do):
    """Everything is switched on, and the PC has listened for its period."""
    for c in range(world.at[w.CELLS]):
        rows.load_cell(world, c, 0)
        do.cell.on_start(world.cells[0], world.params[0], 0, 0, world.out)
        finish_cell(world, c, 0)
    do.sink.on_start(world.pc, world.params[0], 0, 0, world.out)
    while world.pc.own[0].listen > 0:
        do.sink.on_timer(world.pc, world.params[0], 0, const.TICK, world.out)
    world.out.count[0] = 0
    rows.save_pc(world)


def hear(world, do, way, choice):
    """The oldest frame of a direction arrives."""
    end = world.way_end[way]
    rows.take(world, way, 0)
    first = const.PORTS * world.at[w.CELLS]
    if end >= first:
        rows.load_pc(world)
        params = world.params[world.at[w.FAIR]]
        do.sink.on_frame(world.pc, params, 0, end - first, world.frame[0], world.out)
        rows.save_pc(world)
        drain(world, first)
        return 1
    c = end // const.PORTS
    rows.load_cell(world, c, 0)
    cell = world.cells[0]
    cell.choice = choice
    params = world.params[world.at[w.FAIR]]
    do.cell.on_frame(cell, params, 0, end - const.PORTS * c, world.frame[0], world.out)
    return finish_cell(world, c, 0)


def attend(world, do, c, variant):
    """What reaches a cell right before its tick; 0 if this cannot be."""
    cell, params = world.cells[0], world.params[world.at[w.FAIR]]
    for p in range(const.PORTS):
        slot = world.port_at[const.PORTS * c + p]
        if slot < 0:
            continue
        way = world.in_way[const.PORTS * c + p]
        up = rows.is_up(world, way // 2)
        count = options(world, c, p)
        chosen = variant % count
        variant = variant // count
        if world.at[w.FAIR]:
            cell.heard[p] = up
            continue
        if may_break(world, c, p) and chosen == count - 1:
            cell.heard[p] = 0
            if up and not rows.spend(world, w.FALSE):
                return False
            continue
        if world.at[w.MERGE]:
            for _ in range(chosen):
                rows.take(world, way, 0)
                do.cell.on_frame(cell, params, 0, p, world.frame[0], world.out)
        # A cable that is not found broken now has brought something since the last tick.
        cell.heard[p] = 1 if up or cell.pf[p] < const.ONE else 0
    return True


def tick(world, do, c, variant, choice):
    """A cell's period is over."""
    rows.load_cell(world, c, 0)
    cell = world.cells[0]
    if not attend(world, do, c, variant):
        return REFUSED
    if world.at[w.FAIR] == 0 and world.work[world.cell_at[c] + w.TICKS] != w.ANY:
        world.work[world.cell_at[c] + w.TICKS] -= 1
    cell.choice = choice
    do.cell.on_timer(cell, world.params[world.at[w.FAIR]], 0, const.TICK, world.out)
    asked = finish_cell(world, c, rows.HAS_TICKED)
    if world.at[w.MERGE]:
        rows.trim(world, c)
    return asked


def soon(world, do, c, choice):
    """A cell's timer for news fires."""
    rows.load_cell(world, c, 0)
    cell = world.cells[0]
    cell.choice = choice
    do.cell.on_timer(cell, world.params[world.at[w.FAIR]], 0, const.SOON, world.out)
    return finish_cell(world, c, 0)


def pc_tick(world, do, variant):
    """The PC's period is over."""
    params = world.params[world.at[w.FAIR]]
    rows.load_pc(world)
    first = const.PORTS * world.at[w.CELLS]
    if world.at[w.MERGE]:
        for p in range(world.pc.own[0].ports):
            way = world.in_way[first + p]
            count = 1 + queued(world, way)
            for _ in range(variant % count):
                rows.take(world, way, 0)
                do.sink.on_frame(world.pc, params, 0, p, world.frame[0], world.out)
            variant = variant // count
    if world.pc.own[0].listen == 0 and world.at[w.FAIR] == 0:
        world.work[world.at[w.PC_AT] + w.PC_COUNTS] -= 1
    do.sink.on_timer(world.pc, params, 0, const.TICK, world.out)
    rows.save_pc(world)
    drain(world, first)
    return 1


def step(world, do, move, variant, choice):
    """Make a move in the row; out of how many the draw it asked for was, or REFUSED."""
    asked = make(world, do, move, variant, choice)
    if world.at[w.LEAN]:
        tidy(world)
    return asked


def make(world, do, move, variant, choice):
    """Carry out a move, without asking what it may cost: FINE, or what is broken."""
    world.found[0] = w.FINE
    kind, arg = world.move_kind[move], world.move_arg[move]
    if kind == w.TICK:
        return tick(world, do, arg, variant, choice)
    if kind == w.PC_TICK:
        return pc_tick(world, do, variant)
    if kind == w.SOON:
        return soon(world, do, arg, choice)
    if kind == w.DELIVER:
        return hear(world, do, arg, choice)
    if kind == w.LOSE:
        rows.spend(world, w.LOSS)
        rows.drop(world, arg)
    elif kind == w.CUT_LINK:
        rows.spend(world, w.CUT)
        change_link(world, arg, 1)
    elif kind == w.HEAL_LINK:
        rows.spend(world, w.HEAL)
        change_link(world, arg, 0)
    else:
        rows.spend(world, w.RESTART)
        rows.load_pc(world)
        do.sink.on_start(world.pc, world.params[0], 0, const.MEMORY_LOST, world.out)
        world.out.count[0] = 0
        rows.save_pc(world)
    return 1


def settle(world, do):
    """Everything in flight arrives, and what that sets off; 0 if it never ends."""
    for _ in range(200):
        moved = False
        for way in range(world.at[w.DIRECTIONS]):
            while queued(world, way) > 0:
                hear(world, do, way, rows.next_draw(world))
                moved = True
        for c in range(world.at[w.CELLS]):
            if world.work[world.cell_at[c] + w.FLAGS] & rows.IS_SOON:
                soon(world, do, c, rows.next_draw(world))
                moved = True
        if not moved:
            return True
    return False


def turn(world, do, node):
    """A node ticks in the fair schedule, and is heard before the next one does."""
    if node == world.at[w.CELLS]:
        pc_tick(world, do, 0)
    else:
        tick(world, do, node, 0, rows.next_draw(world))
    return settle(world, do)


def bind(skin: Any, skin_sink: Any) -> System:
    """The moves of a skin for a copy of its protocol: modules `skin` and `skin_sink`."""
    do = bound("protocol", cell=skin, sink=skin_sink)

    def start_all(world):  # type: ignore[no-untyped-def]
        start(world, do)

    def make_move(world, move, variant, choice):  # type: ignore[no-untyped-def]
        return step(world, do, move, variant, choice)

    def settle_all(world):  # type: ignore[no-untyped-def]
        return settle(world, do)

    def take_turn(world, node):  # type: ignore[no-untyped-def]
        return turn(world, do, node)

    parts = (make_move, settle_all, take_turn)
    return System(parts, start_all, variants, make_move, check, settle_all, take_turn, is_settled)
