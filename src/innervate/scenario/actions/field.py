"""What can be done to the nodes of a field while it runs."""

KILL, REVIVE, CUT, RESTORE, JAM, QUIET, RESTART = range(7)
