"""What the documentation says is so: generated parts, keys, commands, files and numbers."""

import contextlib
import importlib.util
import re
import tomllib
import typing
from pathlib import Path

import msgspec
import pytest

from innervate import scenario
from innervate.analysis import summary, summary_common
from innervate.cli import main
from innervate.cli.app import app
from innervate.live import nodefile
from innervate.network import networks
from innervate.networks.skin.scenario import model
from innervate.sweeping import make_plan, planfile

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
ROOMS = ("benchmarks", "boards", "docs/decisions", "examples", "paper", "src", "tests")
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
TABLES = {
    model.PatchTable: "[[patch]]",
    model.InterfaceTable: "[[interface]]",
    model.CableTable: "[[cable]]",
    model.LinkTable: "[[link]]",
    model.BodyTable: "[body]",
    model.ProtocolTable: "[protocol]",
    model.TimingTable: "[timing]",
    model.DataTable: "[data]",
    model.TouchTable: "[touch]",
    model.EventTable: "[[event]]",
}


def load_maker():
    spec = importlib.util.spec_from_file_location("docs_make", DOCS / "make.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def blocks(path, language):
    return re.findall(rf"```{language}\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)


def test_generated_parts_are_current(capsys):
    assert load_maker().main(["--check"]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("name", ["recovery", "radio", "mesh"])
def test_pictures_of_pages_are_as_the_code_draws_them(name, tmp_path, monkeypatch):
    maker = load_maker()
    kept = {which: path.read_bytes() for which, path in maker.PICTURES.items()}
    monkeypatch.setitem(maker.PICTURES, name, tmp_path / "drawn.svg")
    maker.DRAWN[name]()
    assert (tmp_path / "drawn.svg").read_bytes() == kept[name], "python docs/make.py"


def test_a_page_without_the_part_is_refused():
    with pytest.raises(ValueError, match="no part parameters"):
        load_maker().renewed("# Page", "parameters", "x")


@pytest.mark.parametrize("table", TABLES, ids=TABLES.values())
def test_every_key_is_documented(table):
    """Keys of a table stand in the rows below its name, and no others do."""
    text = (DOCS / "scenarios.md").read_text(encoding="utf-8")
    rows = text.split(f"| `{TABLES[table]}` |")[1].split("\n\n")[0].splitlines()[2:]
    found = {key for row in rows for key in re.findall(r"`(\w+)`", row.split("|")[1])}
    assert found == {field.encode_name for field in msgspec.structs.fields(table)}


def test_every_key_at_the_top_is_documented():
    text = (DOCS / "scenarios.md").read_text(encoding="utf-8")
    for field in msgspec.structs.fields(model.SkinScenario):
        assert f"`{field.encode_name}`" in text or f"[{field.encode_name}]" in text


def test_defaults_in_the_protocols_table():
    """What stands there as left out is what the model takes."""
    text = (DOCS / "scenarios.md").read_text(encoding="utf-8")
    rows = text.split("| `[protocol]` |")[1].split("\n\n")[0].splitlines()[2:]
    cells = {row.split("|")[1].strip(" `"): row.split("|")[3].strip(" `") for row in rows}
    made = model.ProtocolTable()
    for key in ("beacon_hz", "max_depth", "gap_us", "restart_s"):
        assert float(cells[key]) == getattr(made, key)
    for key in ("rule", "updates"):
        assert cells[key] == f'"{getattr(made, key)}"'
    assert tuple(tomllib.loads(f"v={cells['forward_us']}")["v"]) == made.forward_us


def test_every_event_action_is_documented():
    text = (DOCS / "scenarios.md").read_text(encoding="utf-8")
    rows = text.split("| action |")[1].split("\n\n")[0].splitlines()[2:]
    assert {row.split("`")[1] for row in rows} == set(typing.get_args(model.Action))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_scenarios_in_pages_can_be_run(page, tmp_path):
    for block in blocks(page, "toml"):
        if planfile.is_plan(block):
            (tmp_path / "plan.toml").write_text(block)
            assert make_plan(tmp_path / "plan.toml").points
            continue
        tables = tomllib.loads(block)
        if "number" in tables:  # a live node
            nodefile.parse(tables)
        else:
            scenario.plan(scenario.loads(block))


def test_keys_of_any_networks_summary_are_documented():
    page = (DOCS / "reading-a-report.md").read_text(encoding="utf-8")
    part = page.split("### Of any other network")[1].split("## ")[0]
    there = {key for name in re.findall(r"`([\w.]+)`", part) for key in name.split(".")}
    common = set(summary_common.Common.__annotations__) - {"headline"}
    of = (summary.Summary, summary.Reports, summary.Frames, summary.Messages)
    assert {key for one in of for key in one.__annotations__} - common - {"kind"} <= there
    assert {f"{name}.parquet" for name in ("reports", "deliveries")} <= set(page.split("`"))


def test_link_types_of_captures_are_those_of_the_page():
    page = (DOCS / "export.md").read_text()
    rows = re.findall(r"^\| (\w+) \| (\d+), LINKTYPE_USER(\d+) ", page, re.MULTILINE)
    assert all(int(number) == 147 + int(user) for _, number, user in rows)
    ours = [name for name in networks() if networks()[name].package.startswith("innervate.")]
    said = {name: int(number) for name, number, _ in rows}
    assert said == {name: networks()[name].link_type for name in ours}


def test_commands_in_pages_exist():
    known = {name for name in app if not name.startswith("-")}
    for page in PAGES:
        for words in re.findall(r"innervate (\w+)", " ".join(
            re.findall(r"`(innervate [^`]*)`", page.read_text(encoding="utf-8"))
            + blocks(page, "console")
        )):  # fmt: skip
            assert words in known, (page.name, words)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_the_readmes_numbers_are_the_demos(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["demo"]) == 0
    out = capsys.readouterr().out
    (block,) = blocks(ROOT / "README.md", "text")
    for line in filter(None, block.splitlines()):
        assert line in out


def test_the_papers_results_stand_in_the_readme_or_where_faults_are_counted():
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    results = paper.partition("# Results")[2].partition("\n# ")[0]
    said = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    figures = re.findall(r"[\d.]+ (?:ms|%)", results)
    assert len(figures) >= 4
    assert [figure for figure in figures if figure not in said] == []
    drawn, found = re.search(r"Of (\d+) faults .* find (\d+)\.", results).groups()
    counted = " ".join((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split())
    assert f"{found} of {drawn}, 92.2 %, by tests of which none was written for it" in counted


def test_the_readmes_picture_shows_the_demo():
    text = (DOCS / "images" / "recovery.svg").read_text(encoding="utf-8")
    (block,) = blocks(ROOT / "README.md", "text")
    routed = re.search(r"\+([\d.]+ ms) +every cell", block)[1]
    assert f"{routed} after the cut" in text
    assert len(text) < 150_000


def test_pages_have_no_long_lines():
    for page in PAGES:
        plain = [line for line in page.read_text(encoding="utf-8").splitlines()
                 if not line.startswith("|")]  # fmt: skip
        assert max(map(len, plain)) <= 150, page.name


def named_files(text):
    """Names of files and folders of ours that stand in running text, as code."""
    for span in re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL)):
        yield from re.findall(r"(?<![\w/.<-])(?:[\w-]+/)*(?!_)\w+\.(?:py|c|h)\b", span)
        yield from re.findall(rf"(?<![\w/.-])(?:{'|'.join(ROOMS)})(?:/[\w-]+)+(?![\w.-])", span)


def made_in(folder):
    """What `new network gossip` and `firmware` write."""
    with contextlib.chdir(folder):
        assert main(["new", "network", "gossip"]) == 0
        for words in ("skin", "skin --sealed", "radio", "mesh"):
            assert main(["firmware", *words.split(), "--out", words]) == 0
    return folder.rglob("*")


def test_files_that_pages_name_are_there(tmp_path):
    ours = [*ROOT.glob("*.py"), *DOCS.glob("*.py")]
    ours += [path for room in ROOMS for path in (ROOT / room).rglob("*")]
    files = "\n".join(f"{path}/" for path in [*ours, *made_in(tmp_path)])
    more = [ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md", *(DOCS / "decisions").glob("*.md")]
    missing = {
        (page.name, name)
        for page in PAGES + more
        for name in named_files(page.read_text(encoding="utf-8"))
        if f"/{name}/" not in files
    }
    assert not missing
