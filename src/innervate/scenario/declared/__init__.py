"""Scenarios of networks that have no keys of their own: a module for each medium."""
