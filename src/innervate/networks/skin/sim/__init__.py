"""What the simulator has to know of a skin."""
