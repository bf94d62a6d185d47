"""The protocol of a mesh: its state machines and what they declare."""
