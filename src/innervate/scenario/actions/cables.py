"""What can be done to a network of cables while it runs."""

from innervate.scenario.actions.action import Action, harmful, targets, words

TABLE = (
    Action("cut", "cable", harms=True),
    Action("restore", "cable", mends="cut"),
    Action("kill", "cell", harms=True),
    Action("revive", "cell", mends="kill"),
    Action("loose", "cable", "loss", harms=True),
    Action("restart", "node"),
    Action("lose", "cable", "frames", harms=True),
)
ACTIONS, HARM, TARGETS = words(TABLE), harmful(TABLE), targets(TABLE)
CUT, RESTORE, KILL, REVIVE, LOOSE, RESTART, LOSE = range(7)
GIVE = 7  # no fault: the sink is given a command for nodes
