"""What can be done to a network while it runs, by medium: words of [[event]]s, numbers."""

from innervate.scenario.actions import cables, channel, field

_ALL = cables.TABLE + channel.TABLE + field.TABLE
# Those that happen to a link; what the others happen to is a node.
ON_LINKS = frozenset(one.word for one in _ALL if one.target in ("cable", "link"))
# Those after which a node is off, and those after which it is on again or for the first time.
GOES = frozenset({"kill", "leave"})
COMES = frozenset({"begin"} | {one.word for one in _ALL if one.mends in GOES or one.revives})
