"""What a scenario of a mesh says, and the plan of its run."""
