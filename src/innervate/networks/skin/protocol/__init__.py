"""The protocol of a skin: its state machines and what they declare."""
