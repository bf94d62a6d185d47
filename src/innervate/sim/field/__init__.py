"""The medium of a field: nodes that do not all hear each other.

What the medium decides: who hears whom, and how loud (`powers`: path loss, walls, noise), which of
several frames survives (`medium`: capture), where nodes are (`motion`), and the order of events
(`queue`). A loop over it hands frames to a medium access protocol (`on_start`, `on_frame`,
`on_timer`, `on_input`, `on_carrier`, as `dialect/access.py` has it) and, above that, to a router;
it reserves a place for a frame (`medium.reserve`), commits it to the air, and is told its end.
The mesh has the one loop there is, as long as no other network needs one.
"""
