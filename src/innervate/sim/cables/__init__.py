"""The medium of cables: every frame has one sender and one receiver.

Nodes have up to four ports; one more node, the sink, may have any number. What the medium decides:
when a frame arrives (`wires`: queues, latency, loss), what faults do to it (`commands`), when
timers fire on clocks that drift, and in what order all this happens (`loop`).

What a network brings (`declared.py` makes all of it from declarations):

- `build.Records`: the declared fields of nodes, frames, parameters, inputs, a sink; the names of
  the columns of its deliveries, and of its recorder's own numbers.
- Functions, in a module `do` (`kernel/compilation.bound`), with the world first. The protocol's:
  `on_start(world, node, now, cause)`, `on_frame(world, node, time, port, frame)`,
  `on_timer(world, node, now, timer)`, `on_input(world, node, now, kind)` with the item in
  `world.sample[0]`; they fill `world.out`, which the medium carries out: SEND (port, delay, flags),
  SET_TIMER, DELIVER, REPORT. Of frames: `copy_frame(to, frame)`, `digest(frame)`,
  `block_of(frame)` (0, or OTHER_BLOCK: how it is counted).
- The recorder's (`recorder.py` has the default): `on_report(world, time, node, code, a, b)`,
  `on_deliver(world, time, node, port, frame)`, `on_stop(world, time, node)` when a node loses its
  memory, `is_off(world, end)` if a frame on a cable that is down was lost to a node that is off
  rather than to a cut, `before_change(world)` and `on_change(world, time, node, index)` around
  faults, `check(world, node)` after every call.
- The users': `sense(world, node, time)` fills `world.sample[0]` with what its sensors say (its
  carrier: touch), `take_input(world, command)` with what a node is given, and returns the kind of
  input, or 0 if it cannot be given.
"""
