"""What goes to microcontroller boards, and what holds it against the simulator."""
