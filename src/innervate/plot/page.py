"""The HTML of a report: skeleton, style sheet and small parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK
from innervate.plot import theme
from innervate.plot.charts import Bars, Panel, Steps
from innervate.plot.svg import Drawing, clean
from innervate.plot.words import count_words, figure_words

ROWS_MAX = 200
LEVEL_CLASSES = {OK: "status", DEGRADED: "status warn", DOWN: "status bad", NO_DATA: "status none"}

# Parts of a page, wherever they stand.
PARTS = """
*{box-sizing:border-box}
h1{font-size:1.55rem;line-height:1.3;margin:.2em 0 .4em}
h2{font-size:1.15rem;margin:2.2em 0 .6em;padding-bottom:.3em;border-bottom:1px solid var(--faint)}
h3{font-size:.95rem;margin:0 0 .1em}
p{margin:.4em 0}
.over,.note,figcaption{color:var(--soft)}
.over{font-size:.9rem;margin:0}
.note,figcaption{font-size:.9rem}
.status{display:inline-block;margin:.6em 0;padding:.35em .8em;border-radius:6px;
border:1px solid var(--good);color:var(--good);font-weight:600}
.status.warn{border-color:var(--warn);color:var(--warn)}
.status.bad{border-color:var(--alarm);color:var(--alarm)}
.status.none{border-color:var(--soft);color:var(--soft)}
.status ul{margin:.2em 0;padding-left:1.2em;font-weight:400}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(140px,1fr));gap:10px;margin:1em 0}
.tiles div{background:var(--panel);border-radius:8px;padding:10px 14px}
.tiles b{display:block;font-size:1.25rem}
.tiles span{font-size:.85rem;color:var(--soft)}
.pictures{display:grid;gap:22px;align-items:start}
.four{grid-template-columns:repeat(auto-fit,minmax(min(100%,215px),1fr))}
.three{grid-template-columns:repeat(auto-fit,minmax(min(100%,250px),1fr))}
.two{grid-template-columns:repeat(auto-fit,minmax(min(100%,400px),1fr))}
figure{margin:0;min-width:0;break-inside:avoid}
figure svg{display:block;max-width:100%;height:auto;margin:.3em 0}
.wide{overflow-x:auto;margin:1em 0}
.wide svg{max-width:none}
.film input{width:min(60%,360px);vertical-align:middle}
.film button{font:inherit;font-size:.9rem;padding:.2em .9em;margin-right:.8em;border-radius:6px;
border:1px solid var(--soft);background:var(--panel);color:var(--ink);cursor:pointer}
.keys{display:flex;flex-wrap:wrap;gap:6px 18px;margin:.8em 0;font-size:.9rem;padding:0}
.keys li{display:flex;align-items:center;gap:6px;list-style:none}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}
th,td{text-align:left;padding:.35em .9em .35em 0;border-bottom:1px solid var(--faint);
vertical-align:top}
th{color:var(--soft);font-weight:600}
td:first-child{white-space:nowrap}
.summary td{overflow-wrap:anywhere;white-space:normal}
pre{background:var(--panel);border-radius:8px;padding:12px 14px;overflow-x:auto;font-size:.85rem;
line-height:1.45}
"""
_PAGE = """
body{margin:0;background:var(--ground);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:1060px;margin:0 auto;padding:28px 20px 60px}
details{margin:.5em 0}
summary{cursor:pointer;color:var(--accent)}
footer{margin-top:3em;color:var(--soft);font-size:.85rem}
@media (max-width:480px){main{padding:18px 14px 40px}h1{font-size:1.3rem}}
@media print{main{max-width:none;padding:0}h2{break-after:avoid}body{font-size:11pt}
.four{grid-template-columns:repeat(4,1fr)}.three{grid-template-columns:repeat(3,1fr)}
.two{grid-template-columns:repeat(2,1fr)}
.wide svg{max-width:100%}
.controls{display:none}
pre{white-space:pre-wrap}details::details-content{content-visibility:visible;block-size:auto}}
"""


def page(title: str, body: str) -> str:
    """A whole HTML document; `body` is HTML."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{theme.drawing_style()}{PARTS}{_PAGE}</style>\n"
        f"</head>\n<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def element(tag: str, text: str, kind: str = "") -> str:
    """An element with text, which is escaped."""
    opening = f'<{tag} class="{kind}">' if kind else f"<{tag}>"
    return f"{opening}{clean(text)}</{tag}>\n"


def headline(found: Mapping[str, str]) -> str:
    """A summary's headline: its sentence, and below it its level, in the level's colour."""
    level = found["level"]
    return element("h1", found["text"]) + element("p", level, LEVEL_CLASSES[level])


def joined(*parts: str) -> str:
    """Those parts of a page that have something to say."""
    return "\n".join(part for part in parts if part)


def top(over: str, summary: Mapping[str, Any], *parts: str) -> str:
    """What a report begins with: what it is about, what came of it, parts as HTML."""
    begin = element("p", over, "over") + headline(summary["headline"])
    return f"<header>\n{begin}{''.join(parts)}</header>"


def paragraphs(sentences: Iterable[str], kind: str = "") -> str:
    """A paragraph for each sentence."""
    return "".join(element("p", sentence, kind) for sentence in sentences)


def ended_early(summary: Mapping[str, Any]) -> str:
    """A word on a run that was interrupted."""
    if "interrupted_at_s" not in summary:
        return ""
    early = f"Ended early, at {summary['interrupted_at_s']:.3f} s of simulated time."
    return element("p", early, "status bad")


def took(summary: Mapping[str, Any], simulated_s: float) -> tuple[str, str]:
    """The figure on how long the simulation took."""
    wall = f"{figure_words(summary['wall_s'], 2)} s" if summary["wall_s"] >= 0.01 else "10 ms"
    return (
        wall,
        f"to simulate {figure_words(simulated_s, 4)} s, {count_words(summary['events'])} events",
    )


def beginning(head: Sequence[str], rows: Sequence[Sequence[str]], rest: str = "") -> str:
    """The first rows of a table, and how many more there are; `rest` says where."""
    more = len(rows) - ROWS_MAX
    note = element("p", f"And {more:,} more{rest}.", "note") if more > 0 else ""
    return table(head, rows[:ROWS_MAX]) + note


def section(head: str, inside: str) -> str:
    """A section with a heading; nothing if there is nothing inside."""
    return f"<section>\n{element('h2', head)}{inside}</section>" if inside else ""


def figure(drawing: Drawing, head: str, text: str = "") -> str:
    """A drawing with its caption."""
    words = element("figcaption", text) if text else ""
    title = element("h3", head) if head else ""
    return f"<figure>\n{title}{drawing.render()}\n{words}</figure>\n"


def panel(one: Panel | Steps | Bars) -> str:
    """A figure that has its caption with it."""
    return figure(one.drawing, one.head, one.text)


def pictures(figures: Iterable[str], columns: str) -> str:
    """Figures side by side as far as there is room; `columns` is "two", "three" or "four"."""
    inside = "".join(figures)
    return f'<div class="pictures {columns}">\n{inside}</div>\n' if inside else ""


def keys(entries: Sequence[tuple[Drawing, str]]) -> str:
    """A legend: small drawings with words."""
    items = "".join(f"<li>{icon.render()}{clean(words)}</li>" for icon, words in entries)
    return f'<ul class="keys">{items}</ul>\n' if entries else ""


def tiles(entries: Sequence[tuple[str, str]]) -> str:
    """Numbers with a line each: (number, meaning)."""
    inside = "".join(f"<div><b>{clean(n)}</b><span>{clean(m)}</span></div>" for n, m in entries)
    return f'<div class="tiles">{inside}</div>\n'


def table(head: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table; cells are HTML. Each column has a head, for who listens to the page."""
    assert all(head), head
    opening = f'<table class="{kind}">' if kind else "<table>"
    top = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>\n" for row in rows)
    return f'<div class="scroll" tabindex="0">{opening}<tr>{top}</tr>\n{body}</table></div>\n'


def details(head: str, inside: str) -> str:
    """Something to unfold; `inside` is HTML."""
    return f"<details><summary>{clean(head)}</summary>\n{inside}</details>\n"


def film_controls(cycle_s: float) -> str:
    """A pause button and a slider for the film in the same `.film`; it plays without them, too."""
    return (
        '<div class="controls"><button type="button">Pause</button>'
        '<input type="range" min="0" max="1000" value="0" aria-label="Time"></div>\n'
        f"<script>(cycle=>{{{_FILM}}})({cycle_s:g})</script>\n"
    )


# Who asked for less motion gets the film's end, at rest.
_FILM = """
const box=document.currentScript.parentElement,film=box.querySelector('svg');
const button=box.querySelector('button'),slider=box.querySelector('input');let on=true;
const set=v=>{on=v;v?film.unpauseAnimations():film.pauseAnimations();
button.textContent=v?'Pause':'Play'};
const go=t=>{film.setCurrentTime(t);slider.value=1000*(t%cycle)/cycle};
button.onclick=()=>set(!on);
slider.oninput=()=>{set(false);film.setCurrentTime(cycle*Math.min(slider.value/1000,.9999))};
setInterval(()=>{if(on)slider.value=1000*(film.getCurrentTime()%cycle)/cycle},100);
if(matchMedia('(prefers-reduced-motion: reduce)').matches){set(false);go(.9999*cycle)}
"""
