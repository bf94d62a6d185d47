"""What comes of a theory that holds."""

from innervate.prove.theory import prove


def held(theory):
    """The outcome of a theory: nothing is refuted, and no branch is left out that nobody named."""
    outcome = prove(theory)
    refuted = [bad.goal for one in outcome.checked for bad in one.refuted]
    assert refuted == [], refuted
    assert outcome.unreached == [], outcome.unreached
    assert outcome.is_as_expected
    return outcome
