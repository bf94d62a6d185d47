"""What a recording knows of a skin's cells, by hand."""

from types import SimpleNamespace

from innervate.networks.skin.export.states import States


def test_a_cell_is_known_for_a_tenth_of_a_second_and_no_longer():
    told = SimpleNamespace(heard=[50_000, 50_001, 49_999])
    assert States.known(told, 150_000) == [True, True, False]
