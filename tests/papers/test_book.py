import re
import sys
from dataclasses import replace
from types import ModuleType

import pytest

from innervate.network import Network, networks
from innervate.papers import PapersError, book, main
from innervate.papers.experiment import HOLDS, Claim, Experiment, Point
from innervate.plot import style


class Toy:
    """A paper of two figures, a and b, with three points each, one of them shared."""

    def __init__(self, monkeypatch):
        self.ran = []
        module = ModuleType("innervate.papers.toy")
        module.TITLE, module.AUTHORS, module.FIGURES = "Toys & <b>", "A. Nobody", ("a", "b")
        module.READINGS = {"Q1": "A sentence on <this>."}
        module.experiment, module.warm_up = self.experiment, lambda: None
        monkeypatch.setitem(sys.modules, "toy_papers", module)
        toy = Network("toy", "", papers="toy_papers")
        monkeypatch.setattr(book, "networks", lambda: {"skin": networks()["skin"], "toy": toy})

    def experiment(self, name):
        keys = [f"{name}1", f"{name}2", "shared"]

        def points(quick):
            return [Point.of(key, 1.0, self.work, key) for key in keys[: 2 if quick else 3]]

        def draw(got):
            figure, (ax,) = style.panels(2, 2)
            ax.plot([got.values[keys[0]], got.values[keys[1]]])
            return figure

        def judge(got):
            said = f"the claim | of {name}"
            return [Claim(name, said, str(got.values[keys[0]]), HOLDS, "<why>, Q1 and Q2")]

        return Experiment(name, f"Figure {name}", "A caption & more", points, draw, judge)

    def work(self, key):
        self.ran.append(key)
        return len(key)


@pytest.fixture
def toy(monkeypatch):
    return Toy(monkeypatch)


def test_everything_is_written(toy, tmp_path):
    page = main("toy", tmp_path)
    assert page == tmp_path / "papers-toy.html"
    assert sorted(toy.ran) == ["a1", "a2", "b1", "b2", "shared"]
    made = {path.name for path in tmp_path.iterdir()}
    pictures = {f"{name}.{kind}" for name in "ab" for kind in ("png", "svg")}
    tables = {f"papers-toy.{kind}" for kind in ("csv", "md", "html")}
    assert made == pictures | tables | {book.RESULTS}


def test_a_figure_that_compiles_by_itself_has_nothing_else_compiled(toy, monkeypatch, tmp_path):
    module, said = sys.modules["toy_papers"], []
    module.warm_up = lambda: said.append("all")
    made = {"a": None, "b": lambda: said.append("b")}
    monkeypatch.setattr(
        module, "experiment", lambda name: replace(toy.experiment(name), warm_up=made[name])
    )
    main("toy", tmp_path, only=["b"])
    assert said == ["b"]
    main("toy", tmp_path / "all")
    assert said == ["b", "all", "b"]


def test_the_page_stands_alone(toy, tmp_path):
    text = main("toy", tmp_path).read_text()
    assert text.count('src="data:image/svg+xml;base64,') == 2
    assert text.count("src=") == 2
    assert set(re.findall('href="(.)', text)) == {"#"}
    assert '<dt id="Q1">Q1</dt><dd>A sentence on &lt;this&gt;.</dd>' in text
    assert 'id="Q2"' not in text
    assert "Toys &amp; &lt;b&gt;" in text
    assert "&lt;why&gt;" in text
    assert "<why>" not in text


def test_the_tables_hold_every_claim(toy, tmp_path):
    main("toy", tmp_path)
    rows = (tmp_path / "papers-toy.csv").read_text().splitlines()
    assert rows[0] == "figure,claim,measurement,verdict,reason"
    assert rows[1:] == [f'{name},the claim | of {name},2,holds,"<why>, Q1 and Q2"' for name in "ab"]
    text = (tmp_path / "papers-toy.md").read_text()
    assert "the claim \\| of a" in text
    assert "2 claims: 2 hold" in text
    assert "sources: " in text


def test_a_second_run_runs_nothing_again(toy, tmp_path):
    main("toy", tmp_path)
    toy.ran.clear()
    main("toy", tmp_path)
    assert toy.ran == []


def test_only_some_figures(toy, tmp_path):
    main("toy", tmp_path, only=["b"])
    assert sorted(toy.ran) == ["b1", "b2", "shared"]
    assert not (tmp_path / "a.png").exists()
    assert "Figure a" not in (tmp_path / "papers-toy.html").read_text()


def test_figures_that_the_page_has_besides_stay_on_it(toy, tmp_path):
    page = main("toy", tmp_path)
    whole = [(tmp_path / f"papers-toy.{kind}").read_text() for kind in ("csv", "html")]
    toy.ran.clear()
    (tmp_path / "a.svg").unlink()  # it is drawn again, of what is kept
    assert main("toy", tmp_path, only=["b"]) == page
    assert toy.ran == []
    assert (tmp_path / "papers-toy.csv").read_text() == whole[0]
    assert "Figure a" in page.read_text()
    assert "innervate papers toy</pre>" in page.read_text()


def test_a_page_that_cannot_keep_its_other_figures_is_left_as_it_is(toy, tmp_path, monkeypatch):
    before = main("toy", tmp_path).read_text()
    with pytest.raises(PapersError, match=r"^\S+papers-toy\.html has other figures, .* with --out"):
        main("toy", tmp_path, quick=True, only=["b"])
    monkeypatch.setattr(book, "stamp", lambda: "changed")
    toy.ran.clear()
    with pytest.raises(PapersError, match=r"leave --only out$"):
        main("toy", tmp_path, only=["b"])
    assert toy.ran == []
    assert (tmp_path / "papers-toy.html").read_text() == before
    main("toy", tmp_path, only=["a", "b"])  # nothing is taken away
    main("toy", tmp_path, only=["b"], redraw=True)
    assert "Figure a" in (tmp_path / "papers-toy.html").read_text()


def test_quick_asks_for_less(toy, tmp_path):
    main("toy", tmp_path, quick=True)
    assert "shared" not in toy.ran
    assert "quick: few seeds" in (tmp_path / "papers-toy.md").read_text()


def test_an_interrupt_loses_nothing(toy, tmp_path, monkeypatch):
    monkeypatch.setattr(book, "cores", lambda: 1)

    def stop(step):
        if step.done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        main("toy", tmp_path, progress=stop)
    before = list(toy.ran)
    assert 3 <= len(before) <= 5
    main("toy", tmp_path)
    assert sorted(toy.ran) == ["a1", "a2", "b1", "b2", "shared"]


def test_new_sources_run_again_unless_redrawn(toy, tmp_path, monkeypatch):
    main("toy", tmp_path)
    toy.ran.clear()
    monkeypatch.setattr(book, "stamp", lambda: "changed")
    main("toy", tmp_path, redraw=True)
    assert toy.ran == []
    main("toy", tmp_path)
    assert len(toy.ran) == 5


def test_progress_counts_and_ends(toy, tmp_path):
    steps = []
    main("toy", tmp_path, progress=steps.append)
    assert steps[0].left_s is None
    assert [step.total for step in steps] == [5] * len(steps)
    assert [step.done for step in steps] == sorted(step.done for step in steps)
    assert steps[-1].done == 5
    assert [step.left_s is None for step in steps] == [step.done == 0 for step in steps]
    assert steps[-1].left_s == 0


def test_a_failing_point_ends_the_run(toy, tmp_path):
    def broken(key):
        raise ValueError(key)

    toy.work = broken
    with pytest.raises(ValueError, match=r"^(a|b|shared)"):
        main("toy", tmp_path)


def test_mistakes_are_one_line(toy, tmp_path):
    (tmp_path / "file").write_text("x")
    for arguments, words in (
        (("brain", tmp_path), 'no paper "brain"; choose from: skin'),
        (("toy", tmp_path, False, ["c"]), 'no figure "c"; choose from: a, b'),
        (("toy", tmp_path / "file"), "name another folder"),
        (("toy", tmp_path / "file" / "below"), "name another folder"),
    ):
        with pytest.raises(PapersError, match=words) as caught:
            main(*arguments)
        assert "\n" not in str(caught.value)


def test_two_at_once_in_one_folder_are_one_too_many(toy, tmp_path):
    said = []

    def at_work(step):
        with pytest.raises(PapersError, match="another innervate papers is at work in"):
            main("toy", tmp_path)
        said.append(step.done)

    main("toy", tmp_path, progress=at_work)
    assert said
    assert main("toy", tmp_path, only=["a"]).exists()
