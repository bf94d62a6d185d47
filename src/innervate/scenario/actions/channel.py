"""What can be done to stations on a shared channel while it runs."""

ACTIONS = ("begin", "revive", "kill", "leave", "garble", "fade")
HARM = ("kill", "leave", "garble", "fade")  # what makes it worse
BEGIN, JOIN, KILL, LEAVE, GARBLE, FADE = range(6)
