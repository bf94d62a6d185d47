import json
from concurrent.futures import ThreadPoolExecutor

import pytest

from innervate.papers.errors import PapersError
from innervate.papers.store import Store
from innervate.trace.sources import stamp


def test_results_come_back(tmp_path):
    path = tmp_path / "results.jsonl"
    store = Store(path, "now")
    store.put("a", (1, None, {"x": 2.5}))
    assert store.values["a"] == [1, None, {"x": 2.5}]
    assert Store(path, "now").values == {"a": [1, None, {"x": 2.5}]}
    assert store.missing(["a", "b"]) == ["b"]


def test_a_full_disk_costs_no_result_that_was_kept(tmp_path, full_disk):
    path = tmp_path / "results.jsonl"
    store = Store(path, "now")
    store.put("a", 1)
    with full_disk(), pytest.raises(PapersError, match=r"results\.jsonl: .*what is done is kept"):
        store.put("b", 2)
    assert store.missing(["a", "b"]) == ["b"]
    store.put("b", 3)
    assert Store(path, "now").values == {"a": 1, "b": 3}


def test_results_of_other_sources_are_not_used(tmp_path):
    path = tmp_path / "results.jsonl"
    Store(path, "then").put("a", 1)
    assert Store(path, "now").values == {}
    assert Store(path, "now", any_stamp=True).values == {"a": 1}


def test_the_later_line_wins(tmp_path):
    path = tmp_path / "results.jsonl"
    Store(path, "now").put("a", 1)
    Store(path, "now").put("a", 2)
    assert Store(path, "now").values == {"a": 2}


def test_a_line_cut_off_by_a_kill_costs_only_itself(tmp_path):
    path = tmp_path / "results.jsonl"
    store = Store(path, "now")
    store.put("a", 1)
    store.put("b", 2)
    path.write_text(path.read_text()[:-9])
    again = Store(path, "now")
    assert again.values == {"a": 1}
    again.put("c", 3)
    assert Store(path, "now").values == {"a": 1, "c": 3}


def test_odd_lines_are_passed_over(tmp_path):
    path = tmp_path / "results.jsonl"
    path.write_text('[]\n{"key": 3, "stamp": "now", "value": 1}\nnull\n\n"x"\n')
    assert Store(path, "now").values == {}


def test_several_threads_may_put(tmp_path):
    path = tmp_path / "results.jsonl"
    store = Store(path, "now")
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda i: store.put(str(i), i), range(200)))
    assert len(path.read_text().splitlines()) == 200
    assert all(json.loads(line) for line in path.read_text().splitlines())
    assert Store(path, "now").values == {str(i): i for i in range(200)}


def test_the_stamp_follows_the_sources():
    assert stamp() == stamp()
    assert len(stamp()) == 16
