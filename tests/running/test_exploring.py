"""explore(network): what the command `verify` finds, for programs."""

import pytest

import innervate


def test_options_are_those_of_the_command():
    (case,) = innervate.explore(
        "skin", graph="triangle", rule="paper", updates="periodic", liveness=False, plain=True
    )
    assert case.is_broken
    assert "closed loop" in case.story.title
    assert case.record["rule"] == "paper"


def test_what_is_no_option_is_said_with_those_that_there_are():
    with pytest.raises(TypeError, match=r"explore takes no grahp; it takes rule, updates, graph"):
        innervate.explore("skin", grahp="triangle")
    with pytest.raises(innervate.VerifyError, match=r'--rule is .* not "papre"'):
        innervate.explore("skin", rule="papre")
    with pytest.raises(innervate.NetworkError, match="there is no network 'skni'"):
        innervate.explore("skni")
