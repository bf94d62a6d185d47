"""`innervate docs`, what stands below the commands' help, and the man page made of both."""

import re
import shlex

import pytest

from docs import manpage
from innervate.cli import pages
from innervate.cli.app import app
from innervate.cli.examples import BELOW


def test_all_pages_are_listed_with_their_titles(sh):
    assert sh("docs") == 0
    assert re.search(r"^sweeps +Sweeps$", sh.out, re.MULTILINE)
    assert len(sh.out.splitlines()) == len(pages.pages()) + 1 >= 20


@pytest.mark.parametrize("name", ["sweeps", "sweeps.md", "docs/sweeps.md"])
def test_a_page_is_printed_as_it_is_where_nobody_reads_on_a_terminal(sh, name):
    assert sh("docs", name) == 0
    assert sh.out == pages.pages()["sweeps"].read_text(encoding="utf-8")


def test_names_with_a_signature_on_the_site_say_where_their_help_is(sh):
    assert sh("docs", "api") == 0
    assert "- `innervate.run`: `help(innervate.run)`" in sh.out
    assert ":::" not in sh.out


def test_the_page_of_commands_has_each_with_its_arguments(sh):
    assert sh("docs", "commands") == 0
    assert ":::" not in sh.out
    for words in manpage.commands():
        assert f"# innervate {words}\n" in sh.out
    assert "--min-tq" in sh.out
    assert "Worst quality of a link that counts" in sh.out


def test_there_is_no_such_page(sh):
    assert sh("docs", "sweps") == 2
    assert sh.err == 'innervate: there is no page "sweps"; did you mean "sweeps"?\n'


def test_a_wheel_has_them_beside_the_command(tmp_path, monkeypatch):
    (tmp_path / "index.md").write_text("# Here\n")
    monkeypatch.setattr(pages, "FOLDERS", (tmp_path / "none", tmp_path))
    assert list(pages.pages()) == ["index"]
    monkeypatch.setattr(pages, "FOLDERS", (tmp_path / "none",))
    with pytest.raises(pages.errors.UserError, match="no pages came with this installation"):
        pages.pages()


@pytest.mark.parametrize("words", sorted(BELOW))
def test_examples_are_commands_and_pages_are_there(sh, words):
    page, examples = BELOW[words]
    assert page in pages.pages()
    for example in examples:
        tokens = shlex.split(example)
        assert tokens[: 1 + len(words.split())] == ["innervate", *words.split()]
        app.parse_args(tokens[1:], exit_on_error=False, print_error=False)
    assert sh(*words.split(), "--help") == 0
    assert f"More: innervate docs {page}" in sh.out
    said = " ".join(sh.out.split())  # a narrow terminal breaks long ones
    assert all(example in said for example in examples)


@pytest.mark.parametrize("words", ["run", "sweep", "papers"])
def test_help_breaks_no_line_where_the_sources_do(sh, monkeypatch, words):
    monkeypatch.setenv("COLUMNS", "300")
    assert sh(*words.split(), "--help") == 0
    assert not re.findall(r"│ {9,}\S.*", sh.out)
    above = sh.out.partition("╭")[0].strip().split("\n\n")
    assert not [paragraph for paragraph in above if "\n" in paragraph.strip()]


@pytest.mark.parametrize("words", ["verify", "docs", "size", "new", "firmware", "sweep"])
def test_help_names_no_default_that_is_none(sh, words):
    assert sh(words, "--help") == 0
    said = " ".join(sh.out.replace("│", " ").split())
    assert '[default: ""]' not in said
    assert "[default: 0]" not in said


def test_help_breaks_no_setting_in_two(sh):
    assert sh("verify", "--help") == 0
    assert not re.findall(r",[a-z]+ *│", sh.out)


def test_every_command_has_something_below_its_help():
    bare = {"scenarios", "doctor"}  # they have no more to say
    assert {name for name in manpage.commands() if " " not in name} - bare <= set(BELOW)


def test_the_man_page_is_current_and_names_every_command():
    made = manpage.made()
    assert manpage.PAGE.read_text(encoding="utf-8") == made, "python -m docs.manpage"
    for words in manpage.commands():
        assert f'.SS "{words.replace("-", chr(92) + "-")}' in made


def test_man_reads_nothing_as_a_request_that_is_none():
    requests = {line.split()[0] for line in manpage.made().splitlines() if line.startswith(".")}
    assert requests == {".TH", ".ad", ".nh", ".SH", ".SS", ".PP", ".TP", ".nf", ".fi", ".RS", ".RE"}
    assert not [line for line in manpage.made().splitlines() if line.startswith("'")]
    assert manpage._plain("'a' .b - \\c") == "\\&'a' .b \\- \\ec"
