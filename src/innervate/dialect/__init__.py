"""The state machines of the networks, in restricted Python, and what they declare."""
