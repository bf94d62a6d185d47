"""What a scenario of a radio team says, and the plan of its run."""
