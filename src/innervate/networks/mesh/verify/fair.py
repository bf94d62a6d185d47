"""What becomes of a state if nothing fails any more: all clocks run alike, every frame arrives.

Then every message whose recipient is connected to its origin is delivered, no packet stays for
ever, and of several gateways one is left, which all follow.
"""

from typing import NamedTuple

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.standby import IN_VAIN
from innervate.networks.mesh.verify import local
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.net import DEAD, EVENTS_MAX, Net, Nets

IN_USE = (const.DATA, const.E2E_ACK, const.ALARM)


class End(NamedTuple):
    """A calm future's end: what is broken, what was delivered, how many events it took."""

    broken: int
    got: int
    events: int


class Fair:
    """Calm futures of a model's states; what was on a way already is not played again."""

    def __init__(self, nets: Nets) -> None:
        self.nets = nets
        self.ends: dict[bytes, End] = {}
        self.longest = 0

    def check(self, net: Net) -> int:
        """What a state's calm future breaks; 0 nothing."""
        if self.nets.model.beats:
            return local.BROKEN_DEPOSED if self._is_deposed(net) else self._one_gateway(net)
        wanted = self._wanted(net)
        end = self._end(net)
        self.longest = max(self.longest, end.events)
        if end.broken:
            return end.broken
        return 0 if wanted <= self.nets.sets[end.got] else local.BROKEN_UNHEARD

    def _wanted(self, net: Net) -> set[tuple[int, int, int, int]]:
        """Messages that their origins will send again, to recipients that are connected to these.

        Whoever had the newest copy may have died with it; of one that is not sent again, nothing
        is promised.
        """
        found, field = set(), self.nets.locals.field
        tries = self.nets.locals.params.e2e_tries
        dead = [node for node, number in enumerate(net.nodes) if number == DEAD]
        for node, number in enumerate(net.nodes):
            if number == DEAD:
                continue
            kinds = field(number, "wait_kind")
            for w, kind in enumerate(kinds):
                dest = field(number, "wait_dest")[w]
                live = dest < self.nets.n and net.nodes[dest] != DEAD
                live = live and field(number, "wait_tries")[w] <= tries
                links = self.nets.model.links
                if kind and live and dest in mesh_model.reach(self.nets.n, links, node, dead):
                    found.add((dest, node, field(number, "wait_seq")[w], kind))
        return found - self.nets.sets[net.got]

    def _end(self, net: Net) -> End:
        """Play on until nothing is kept or under way."""
        calm = net._replace(left=(0, 0, 0, 0), ticks=(1 << 20,) * self.nets.n)
        rows: list[bytes] = []
        for _ in range(EVENTS_MAX):
            row = self.nets.pack(calm)
            known = self.ends.get(row)
            if known is not None:
                return self._note(rows, known)
            rows.append(row)
            if self._is_quiet(calm):
                return self._note(rows, End(0, calm.got, -1))
            step = self.nets.steady(calm)
            if step is None:  # nobody does anything any more
                return self._note(rows, End(local.BROKEN_ENDLESS, calm.got, -1))
            _, calm, broken = step
            if broken:
                return self._note(rows, End(broken, calm.got, -1))
        return self._note(rows, End(local.BROKEN_ENDLESS, calm.got, 0))

    def _note(self, rows: list[bytes], end: End) -> End:
        for row in reversed(rows):
            end = end._replace(events=end.events + 1)
            self.ends[row] = end
        return end

    def _is_quiet(self, net: Net) -> bool:
        """No message is kept, nor a packet of one in a queue or under way."""
        locals_ = self.nets.locals
        for number in net.nodes:
            if number != DEAD:
                if any(locals_.field(number, "wait_kind")):
                    return False
                kinds, states = locals_.field(number, "q_kind"), locals_.field(number, "q_state")
                if any(s and k in IN_USE for s, k in zip(states, kinds, strict=True)):
                    return False
        return True

    # Gateways.

    def _one_gateway(self, net: Net) -> int:
        """Within `calm_beats` there is one gateway, which all follow, until the last beat.

        `events` of an end is how many us later they disagree for the last time.
        """
        end = self._last_quarrel(net)
        self.longest = max(self.longest, end.events)
        late = self.nets.calm_beats() * self.nets.locals.params.tick_us
        return end.broken or (local.BROKEN_GATEWAYS if end.events > late else 0)

    def _is_deposed(self, net: Net) -> bool:
        """True if another leads, too, though nobody died and fewer frames than questions failed."""
        budget, (deaths, _, frames, _) = self.nets.model.budget, net.left
        if deaths < budget.deaths or budget.frames - frames >= IN_VAIN:
            return False
        asks = self.nets.locals.params.guard_us > 0  # else a request that is lost may do it
        return asks and any(self.nets.locals.field(number, "leading") for number in net.nodes[1:])

    def _last_quarrel(self, net: Net) -> End:
        rows: list[tuple[bytes, int, bool]] = []
        calm, end = net._replace(left=(0, 0, 0, 0)), End(0, 0, local.NONE)
        while len(rows) < EVENTS_MAX:
            row = self.nets.pack(calm)
            known = self.ends.get(row)
            if known is not None:
                end = known
                break
            step = self.nets.steady(calm)
            if step is None:
                break
            rows.append((row, self.nets.soonest(calm)[0], self._disagree(calm)))
            calm = step[1]
            if step[2]:
                end = End(step[2], 0, 0)
                break
        else:
            end = End(local.BROKEN_ENDLESS, 0, 0)
        for row, wait, quarrels in reversed(rows):
            later = end.events
            here = wait + later if later != local.NONE else wait if quarrels else local.NONE
            end = self.ends[row] = end._replace(events=here)
        return end

    def _disagree(self, net: Net) -> bool:
        """True if live nodes that are connected do not follow one gateway among them."""
        field, model = self.nets.locals.field, self.nets.model
        dead = [node for node, number in enumerate(net.nodes) if number == DEAD]
        for node, number in enumerate(net.nodes):
            if number == DEAD:
                continue
            team = mesh_model.reach(self.nets.n, model.links, node, dead)
            if not any(self.nets.locals.ranks[v] >= 0 for v in team):
                continue
            leaders = [v for v in team if field(net.nodes[v], "leading")]
            if len(leaders) != 1 or field(number, "gateway") != leaders[0]:
                return True
        return False
