"""The same scenario compiled, plain and on MicroPython: `python -m boards.parity`."""
