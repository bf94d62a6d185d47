"""Protocols turned into formulas: what holds in every step, of any number of nodes."""
