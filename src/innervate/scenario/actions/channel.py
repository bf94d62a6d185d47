"""What can be done to stations on a shared channel while it runs."""

BEGIN, JOIN, KILL, LEAVE, GARBLE, FADE = range(6)
