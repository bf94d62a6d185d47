"""Managed flooding, after Meshtastic's "Mesh Broadcast Algorithm".

A node that hears a packet for the first time delivers it if it is for it or for all, waits, the
shorter the fainter it came in, and passes it on with one hop less, unless it hears meanwhile that
another did. Who made a packet takes hearing it again for an acknowledgement; without one it sends
it again, three times at most. Who a packet is for answers with an acknowledgement, which is flooded
alike.

Left out: roles (all nodes are clients), next-hop routing of direct messages (since 2.6), channels
and encryption, windows that grow with the use of the channel, a negative acknowledgement as a
packet. A packet that went down to CSMA is not taken back.
"""
