"""What a run of a skin comes to, in numbers."""
