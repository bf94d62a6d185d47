"""Whose message goes next: a queue for each recipient, urgent ones first, recipients in turn.

The router keeps 32 messages until they are acknowledged. Whoever does not answer would soon have
all places, and hold up who does; so places are given out with the others in mind. A recipient has
a few at first, and one more with each message that arrives, up to three quarters.
"""

from collections import Counter, deque
from itertools import compress
from typing import Any

from innervate.dialect.arith import MASK16
from innervate.networks.mesh.live.long import Long, Maker
from innervate.networks.mesh.live.stack import MeshStack, is_avoided
from innervate.networks.mesh.protocol.constants import ALL, CONTROL, END_TO_END, OWN, PRIORITY
from innervate.networks.mesh.protocol.duplicates import UNREACHABLE
from innervate.networks.mesh.protocol.messages import resolve
from innervate.networks.mesh.protocol.neighbours import place_of
from innervate.networks.mesh.protocol.retransmission import (
    AHEAD_MAX,
    FREE,
    SURE_AFTER,
    crowds,
    is_ahead,
    is_in_vain,
)

MOST = 4096  # messages that wait ...
FEW = 16  # ... but to each recipient so many may, whatever others have
SILENT = 4  # the router's places for all recipients together that do not answer
SPARE = 2  # its last places, for recipients that have none
FIRST = 4  # places of a recipient of which nothing is known, or that does not answer at once

# A message as the router takes it, and its owner's name for it.
Waiting = tuple[int, Any]


class Turns:
    """Messages that wait for a place in the router; `make` makes what a piece of one goes by."""

    def __init__(self, stack: MeshStack, make: Maker) -> None:
        self._stack = stack
        self._make = make
        self._urgent: dict[int, deque[Waiting]] = {}
        self._others: dict[int, deque[Waiting]] = {}
        self._count: Counter[int] = Counter()
        self._total = 0
        self._in_vain: Any = None  # what nobody could go by: the same again will not do either
        self._under_way: dict[int, int] = {}  # by handle: the recipient
        self._gone: set[int] = set()  # recipients to whom everything was in vain since
        self._most: dict[int, int] = {}  # by recipient: how many places it may have

    def __len__(self) -> int:
        return self._total

    def has_room(self, recipient: int) -> bool:
        """True if a message more may wait for this recipient."""
        return self._total < MOST or self._count[self._name(recipient)] < FEW

    def put(self, handle: int, item: Any) -> bool:
        """A message waits behind others to the same recipient; urgent ones apart.

        False = behind others, which may not go as yet.
        """
        queues = self._urgent if item.flags & PRIORITY else self._others
        name = self._name(item.dest)
        queue = queues.setdefault(name, deque())
        queue.append((handle, item))
        self._count[name] += 1
        self._total += 1
        if len(queue) > 1:
            return False
        self._in_vain = None
        return True

    def take(self) -> Waiting | None:
        """The message that goes now, None = none may."""
        if not self._total or (self._in_vain and self._in_vain == self._facts()):
            return None
        all_wait = ALL in self._urgent or ALL in self._others
        places = Places(self._stack, self._gone, all_wait, self._most)
        for queues in (self._urgent, self._others):
            for name, queue in queues.items():
                item = queue[0][1]
                if places.takes(item) and not (isinstance(item, Long) and not item.may_go()):
                    return self._pop(queues, name)
        self._in_vain = self._facts()
        return None

    def ended(self, handle: int, is_there: bool | None) -> None:
        """A message has its end: True = it arrived, False = in vain, None = that says nothing."""
        recipient = self._under_way.pop(handle, ALL)
        if is_there is False:
            self._gone.add(recipient)
            self._most.pop(recipient, None)
        elif is_there:
            self.heard(recipient)
            most = self._most.get(recipient, FIRST) + 1
            self._most[recipient] = min(most, self._stack.params.kept * 3 // 4)

    def drop(self, handle: int, long: Long) -> None:
        """A message that goes in pieces has its end before all were sent, perhaps."""
        queues, name = self._urgent if long.flags & PRIORITY else self._others, long.dest
        queue = queues.get(name, deque())
        if (handle, long) in queue:
            queue.remove((handle, long))
            self._leave(name)
            if not queue:
                del queues[name]

    def heard(self, sender: int) -> None:
        """A message of this node came: it is there."""
        if sender in self._gone:
            self._gone.discard(sender)
            self._in_vain = None

    def waiting(self) -> dict[int, int]:
        """How many wait for whom."""
        return dict(sorted(self._count.items()))

    def _pop(self, queues: dict[int, deque[Waiting]], name: int) -> Waiting:
        queue = queues.pop(name)
        found = queue[0]
        long = found[1] if isinstance(found[1], Long) else None
        if long is not None:
            found = long.cut(self._make)
        if long is None or long.is_cut:
            queue.popleft()
            self._leave(name)
        if queue:
            queues[name] = queue  # behind all others
        self._under_way[found[0]] = name
        return found

    def _leave(self, name: int) -> None:
        """One fewer waits for a recipient."""
        self._total -= 1
        self._count[name] -= 1
        if not self._count[name]:
            del self._count[name]

    def _name(self, recipient: int) -> int:
        """One queue for all names of a recipient, so that its messages keep their order."""
        known = resolve(self._stack.node, self._stack.params, recipient)
        return recipient if known == ALL else known

    def _facts(self) -> Any:
        """What the answer depends on, but for what can only make it a no."""
        node = self._stack.node
        queue = node.q_state[:].count(FREE)
        room = (queue > OWN, queue > CONTROL, node.gateway)
        suspects = (node.neighbour[:], node.suspect[:]) if self._gone else ()
        return (*room, *suspects, node.wait_kind[:], node.wait_dest[:], node.wait_seq[:],
                node.bad_neighbour[:], node.bad_dest[:])  # fmt: skip


class Places:
    """The router's places at this moment; see Turns for `gone` and `most`."""

    def __init__(
        self, stack: MeshStack, gone: set[int], all_wait: bool, most: dict[int, int]
    ) -> None:
        node = stack.node
        self._node = node
        self._gone = gone
        self._params = stack.params
        self._queue = node.q_state[:].count(FREE)
        self._most = most
        kinds = node.wait_kind[:]
        self._free = kinds.count(FREE)
        self._held: list[int] = []  # recipients
        self._tries: list[int] = []
        self._tries_most, self._is_near = 0, True
        if self._free < len(kinds):
            self._held = list(compress(node.wait_dest[:], kinds))
            self._tries = list(compress(node.wait_tries[:], kinds))
            self._tries_most = max(self._tries)
            after = node.seq + 1
            ages = [(after - seq) & MASK16 for seq in compress(node.wait_seq[:], kinds)]
            self._is_near = max(ages) <= AHEAD_MAX
        self._is_calm = self._tries_most <= SURE_AFTER and UNREACHABLE not in node.bad_neighbour[:]
        self._all_wait = all_wait  # one to all waits, which cannot go while one is long under way

    def takes(self, item: Any) -> bool:
        """True if the router has a place for a message, with all others in mind."""
        node, urgent = self._node, bool(item.flags & PRIORITY)
        dest = resolve(node, self._params, item.dest)
        if dest == node.number:
            return True
        if self._queue <= (CONTROL if urgent else OWN):
            return False
        held = self._held.count(dest)
        if not self._is_near and (held or dest == ALL) and is_ahead(node, dest):
            return False
        if dest == ALL or not item.flags & END_TO_END:
            return True
        if held >= FIRST and held >= self._share(dest) + SPARE * urgent:
            return False
        if self._free < (1 if urgent else 2) + (SPARE if held else 0):
            return False
        if not self._is_calm and held >= node.kept >> 1 and crowds(node, dest):
            return False
        if not self._is_silent(dest):
            return True
        silent = sum(self._held.count(other) for other in set(self._held)
                     if self._is_silent(other))  # fmt: skip
        return silent < SILENT + urgent and not (self._all_wait and is_ahead(node, ALL))

    def _share(self, dest: int) -> int:
        """How many places a recipient may have now: half while a message is sent to it again."""
        most = self._most.get(dest, FIRST)
        if self._tries_most <= 1:
            return most
        kept = zip(self._tries, self._held, strict=True)
        tries = max((tries for tries, to in kept if to == dest), default=0)
        if tries > SURE_AFTER:
            self._most.pop(dest, None)
            return FIRST
        return max(FIRST, most // 2) if tries > 1 else most

    def _is_silent(self, dest: int) -> bool:
        """True if messages to `dest` were tried in vain, or are being for a while.

        The router forgets that after a while, or of more than a few; we until something is heard.
        """
        node = self._node
        if dest in self._gone:
            k = place_of(node, self._params, dest)
            return k < 0 or is_avoided(node, k)
        return not self._is_calm and bool(is_in_vain(node, dest, (node.seq + 1) & MASK16))
