"""What is explored of a radio team, and what must hold."""
