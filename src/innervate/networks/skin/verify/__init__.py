"""What is explored of a skin, and what must hold."""
