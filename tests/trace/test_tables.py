import numpy
import polars
import pytest

from innervate.networks.skin.tables import LOOPS, RECEIVED, TABLES
from innervate.trace import tables
from tests.fixtures.loading import loaded_by


def test_names_and_types_are_declared_once():
    assert [table.name for table in TABLES] == ["routes", "links", "outages", "loops", "received"]
    for table in TABLES:
        names = [column.name for column in table.columns]
        assert len(set(names)) == len(names)
        for column in table.columns:
            assert isinstance(getattr(polars, column.kind)(), polars.DataType)
            assert column.meaning
        empty = tables.frame(table, {name: [] for name in names})
        assert empty.columns == names


def test_round_trip(tmp_path):
    columns = {
        "opened_us": [1_000_000, 2_000_000],
        "closed_us": [1_000_500, None],
        "cell": [3, 4],
        "length": [4, 2],
    }
    path = tables.write(LOOPS, columns, tmp_path)
    assert path.name == "loops.parquet"
    read = tables.read(LOOPS, tmp_path).collect()
    assert read.to_dict(as_series=False) == columns
    assert read.schema["opened_us"] == polars.Int64


def test_missing_and_strange_columns_are_refused():
    with pytest.raises(ValueError, match="table loops has columns"):
        tables.frame(LOOPS, {"opened_us": []})
    with pytest.raises(ValueError, match="not"):
        tables.frame(RECEIVED, {"time": []})


def test_the_room_loads_without_numpy_and_polars():
    code = "import innervate.trace.tables, innervate.trace.provenance, innervate.trace.streams"
    assert loaded_by(code, "numpy", "polars", "numba") == []


def test_columns_that_lack_values_are_floats_and_others_stay_whole():
    columns = {"opened_us": [1, 2], "closed_us": [3, None], "cell": [3, 4], "length": [4, 2]}
    made = tables.arrays(tables.frame(LOOPS, columns))
    assert {name: array.dtype.kind for name, array in made.items()} == {
        "opened_us": "i", "closed_us": "f", "cell": "i", "length": "i"}  # fmt: skip
    assert made["closed_us"][0] == 3
    assert numpy.isnan(made["closed_us"][1])


def test_a_table_that_cannot_be_written_says_so(tmp_path):
    with pytest.raises(OSError, match="loops"):
        tables.write(LOOPS, {c.name: [] for c in LOOPS.columns}, tmp_path / "none")


def test_as_many_columns_of_other_names_are_refused():
    columns = {"opened_us": [1], "closed_us": [2], "cell": [3], "lenght": [4]}
    with pytest.raises(ValueError, match=r"table loops has columns .*length.*, not .*lenght"):
        tables.frame(LOOPS, columns)
