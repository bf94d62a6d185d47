"""Managed flooding, as Meshtastic floods: who hears a packet passes it on, unless another has."""
