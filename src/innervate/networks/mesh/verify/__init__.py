"""What is explored of a mesh, and what must hold."""
