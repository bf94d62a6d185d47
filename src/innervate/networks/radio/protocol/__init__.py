"""The protocol of a radio team: its state machines and what they declare."""
