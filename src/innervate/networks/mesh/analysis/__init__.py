"""What a run of a mesh comes to, in numbers."""
