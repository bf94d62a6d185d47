"""Simulated networks: event queue, wires, faults and the compiled loop."""
