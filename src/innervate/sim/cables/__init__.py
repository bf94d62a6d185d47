"""The medium of cables: every frame has one sender and one receiver."""
