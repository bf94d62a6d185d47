"""The medium of a field: nodes that do not all hear each other.

What the medium decides: who hears whom, and how loud (`powers`: path loss, walls, noise), which of
several frames survives (`medium`: capture), where nodes are (`motion`), and the order of events
(`queue`). The `loop` hands frames to a protocol and, below it, to a medium access or to none
(`access`), which reserves a place for a frame, commits it to the air, and is told its end.

What a network brings, in a module `do` (`kernel/compilation.bound`), with the world first:

- The handlers of its protocol, and those of the medium access with `mac_` before their names.
- Of frames: `copy_frame(to, frame)`, `digest(frame)`, `frame_bytes(frame)`.
- What the loop asks: `pressing(world)`, `wipe(world, node)`, `offer(world, do, index, time)`,
  `sample(world, do, index, time)`; of the layer below `hand_down` and what `access` has.
- What is kept and told: `record_sent`, `record_delivered`, `tap`, `note_report`, `note_heard`,
  `tell_sent(world, do, node, time, ok)`, `note_carriers(world, do, time)`,
  `tell_place(world, do, index, time)` of robots (`motion.sample`), and
  `check(world, do, node, time)` after every call.

A network that only declares its protocol is given all of that by `declared`.
"""
