"""What can be done to the nodes of a field while it runs."""

from innervate.scenario.actions.action import Action, harmful, targets, words

TABLE = (
    Action("kill", "node", harms=True),
    Action("revive", "node", mends="kill"),
    Action("cut", "link", harms=True),
    Action("restore", "link", mends="cut"),
    Action("jam", "node", "noise_dbm", harms=True),
    Action("quiet", "node", mends="jam"),
    Action("restart", "node", revives=True),
)
ACTIONS, HARM, TARGETS = words(TABLE), harmful(TABLE), targets(TABLE)
KILL, REVIVE, CUT, RESTORE, JAM, QUIET, RESTART = range(7)
