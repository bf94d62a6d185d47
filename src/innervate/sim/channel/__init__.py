"""The medium of a shared channel: stations that all hear each other, event by event.

What the medium decides: who hears which frame and when, whether it is received (alone, from its
start, not lost to noise), and what a radio hears of the carrier (`medium`). It offers packets
(`traffic`), and does to stations what a scenario says (`loop.obey`).

What a network brings:

- `build.Records`: the declared fields of stations, parameters, frames and packets.
- Functions, in a module `do` (`kernel/compilation.bound`), with the world first. The protocol's:
  `on_start(world, node, now, cause)`, `on_frame(world, node, now, frame)`,
  `on_timer(world, node, now, timer)`, `on_input(world, node, now, kind)` with the item in
  `world.item[0]`, `on_carrier(world, node, now, cd, voc)`: cd 1 = somebody sends, voc 1 = one and
  no more. Inputs and the reports that count stand in `dialect/access.py`. Of frames:
  `copy_frame(to, frame)`, `digest(frame)`.
- The recorder's: `record_sent(world, node, frame, time)`, `record_received(world, node, what, time,
  clear, received)`, `watch(world, node, time, handler, port)` after every call.
- What becomes of packets: `note_sent(world, node, frame, time)`, `note_received(world, node, frame,
  time)`, `note_delivered(world, node, handle, time)`: `traffic`, or a protocol above.
"""
