"""A proof can fail: mistakes are planted in the protocol, and each has to be refuted."""

from innervate.network import Network
from innervate.prove.mutants import Mutant
from innervate.prove.theory import prove


def faults_of(network: Network) -> list[Mutant]:
    """A network's own mistakes, and the explorer's where its proofs are about these, too."""
    part = network.prove
    others = network.verify.MUTANTS if getattr(part, "EXPLORERS", False) else ()
    return [*getattr(part, "MUTANTS", ()), *others]


def hunt(network: Network, fault: Mutant) -> tuple[str, str]:
    """(step, lemma) that a mistake breaks first; "" if none.

    Raises:
        ProveError: its text is not in what is proved.
    """
    for theory in network.prove.theories(network, (fault.old, fault.new)):
        if theory.refuted_by:
            continue
        outcome = prove(theory, first_only=True)
        for one in outcome.checked:
            if one.refuted:
                return one.name, one.refuted[0].goal
    return "", ""
