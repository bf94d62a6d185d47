"""Stations that share one half-duplex radio channel, event by event."""
