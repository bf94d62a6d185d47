"""Compilation: what Numba may compile, record types, where compiled code is kept."""
