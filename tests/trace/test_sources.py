"""A hash of the sources that results depend on."""

from innervate.trace import sources


def test_results_are_of_all_rooms_that_decide_them_and_of_those_that_are_named(
    monkeypatch, tmp_path
):
    def write(name, text="1"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)

    write("trace/sources.py")
    monkeypatch.setattr(sources, "__file__", str(tmp_path / "trace" / "sources.py"))
    seen = []

    def stamp(*more):
        sources.stamp.cache_clear()
        return sources.stamp(*more)

    seen.append(stamp())
    for name in ("sim/a.py", "networks/x/y.toml", "topology/b.py", "dialect/c.py", "analysis/d.py"):
        write(name)
        seen.append(stamp())
    assert len(set(seen)) == len(seen)
    write("papers/e.py")
    write("sim/notes.txt")
    assert stamp() == seen[-1]
    assert stamp("papers") != seen[-1]
    write("sim/a.py", "2")
    seen.append(stamp())
    assert len(set(seen)) == len(seen)
    (tmp_path / "sim/a.py").rename(tmp_path / "sim/b.py")
    assert stamp() not in seen
    sources.stamp.cache_clear()
