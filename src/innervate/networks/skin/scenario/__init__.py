"""What a scenario of a skin says, and the plan of its run."""
