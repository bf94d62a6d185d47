"""The protocols' C held against their Python: `python -m boards.firmware`."""
