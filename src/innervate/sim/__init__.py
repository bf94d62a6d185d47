"""The simulator: event queue, cables, faults, touch, observers and the compiled loop."""
