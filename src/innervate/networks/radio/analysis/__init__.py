"""What a run of a radio team comes to, in numbers."""
