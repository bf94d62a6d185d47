"""What can be done to the nodes of a field while it runs."""

ACTIONS = ("kill", "revive", "cut", "restore", "jam", "quiet", "restart")
HARM = ("kill", "cut", "jam")  # what makes it worse
KILL, REVIVE, CUT, RESTORE, JAM, QUIET, RESTART = range(7)
