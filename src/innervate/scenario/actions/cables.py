"""What can be done to a network of cables while it runs."""

ACTIONS = ("cut", "restore", "kill", "revive", "loose", "restart", "lose")
HARM = ("cut", "kill", "loose", "lose")  # what makes it worse
CUT, RESTORE, KILL, REVIVE, LOOSE, RESTART, LOSE = range(7)
GIVE = 7  # no fault: the sink is given a command for nodes
