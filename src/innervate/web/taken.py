"""What faults took away and nothing gave back yet: to take it once more changes nothing."""

from collections.abc import Collection
from typing import Any

from innervate.scenario.actions.action import Action

KILL, LEAVE = "kill", "leave"


class Taken(dict[tuple[str, Any], bool]):
    """By action and the thing that it happened to, whether it holds now."""

    def changes(
        self, table: tuple[Action, ...], action: Action, thing: Any, absent: Collection[int]
    ) -> bool:
        """Take in what happens to a thing, a node, cable or link; false if all stays as it was.

        `table` are the medium's actions; absent nodes are off until they come for the first time.
        """
        is_node = action.target not in ("cable", "link")
        is_off = is_node and self.get((KILL, thing), thing in absent)
        if action.mends == KILL or action.revives:
            self[KILL, thing] = False
            left = self.pop((LEAVE, thing), False)
            return is_off or left or action.revives
        if action.mends:
            return self.pop((action.mends, thing), False)
        if is_off and not action.key:  # noise stays for who is switched on again
            return False
        if action.word == LEAVE or any(action.word == one.mends for one in table):
            was = self.get((action.word, thing), False)
            self[action.word, thing] = True
            return not was or bool(action.key)  # a louder noise is a change
        return True

    def gone(self, node: int) -> None:
        """A node that was told to leave has left, and is off."""
        self[KILL, node] = True
