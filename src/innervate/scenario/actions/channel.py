"""What can be done to stations on a shared channel while it runs."""

ACTIONS = ("begin", "revive", "kill", "leave", "garble", "fade")
BEGIN, JOIN, KILL, LEAVE, GARBLE, FADE = range(6)
