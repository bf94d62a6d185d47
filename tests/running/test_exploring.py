"""explore(network): what the command `verify` finds, for programs."""

import pytest

import innervate
from innervate.cli.app import main


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


@pytest.mark.parametrize(("network", "asked", "said"), [
    ("babel", {"rule": "x"}, "--rule is not for babel, of which --graph, --budget can be said"),
    ("flooding", {"walks": 3}, "--walks is not for flooding"),
    ("radio", {"graph": "pair"}, "--graph is not for radio, of which --rule, --cells can be said"),
    ("radio", {"updates": "triggered"}, "--updates is not for radio"),
    ("mesh", {"cells": 3}, "--cells is not for mesh, of which --rule, --graph, --budget, --walks"),
])  # fmt: skip
def test_what_a_network_has_no_use_for_is_refused_and_not_passed_over(network, asked, said):
    with pytest.raises(innervate.VerifyError, match=said):
        innervate.explore(network, **asked)
    assert main(["verify", network, *(f"--{key}={value}" for key, value in asked.items())]) == 2


def test_a_search_at_random_plants_no_mistakes(capsys):
    assert main(["verify", "--random", "--mutants"]) == 2
    assert "--random and --mutants exclude each other" in capsys.readouterr().err
