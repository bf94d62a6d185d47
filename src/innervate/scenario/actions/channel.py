"""What can be done to stations on a shared channel while it runs."""

from innervate.scenario.actions.action import Action, harmful, words

TABLE = (
    Action("begin", "node"),
    Action("revive", "node", mends="kill"),
    Action("kill", "node", harms=True),
    Action("leave", "node", harms=True),
    Action("garble", "node", "frames", harms=True),
    Action("fade", "node", "frames", harms=True),
)
ACTIONS, HARM = words(TABLE), harmful(TABLE)
BEGIN, JOIN, KILL, LEAVE, GARBLE, FADE = range(6)
# What a scenario calls them; stations begin by themselves.
WORDS = {
    "join": JOIN, "leave": LEAVE, "kill": KILL, "revive": JOIN, "garble": GARBLE, "fade": FADE,
}  # fmt: skip
