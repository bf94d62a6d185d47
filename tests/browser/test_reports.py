"""What a run's report looks like in a browser."""

import innervate
from innervate import Mesh
from innervate.papers import output
from tests.browser.servers import PHONE, WIDE

PLACES = [(0, 0), (20, 0), (20, 20), (0, 20)]


def test_a_phone_has_the_whole_map_of_a_mesh(browser, tmp_path):
    nodes = [Mesh.Node(x_m=float(x), y_m=float(y)) for x, y in PLACES]
    innervate.run(Mesh(node=nodes, duration_s=1.0), plain=True).write(tmp_path / "run")
    page = browser.new_page(viewport=PHONE)
    page.goto((tmp_path / "run" / "report.html").as_uri())
    box = page.locator("svg[aria-label='The field']").bounding_box()
    page.close()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= PHONE["width"]
    assert box["width"] > 0.8 * PHONE["width"]


def test_both_columns_of_a_papers_contents_begin_at_the_same_height(browser):
    entries = "".join(f"<li>figure {i}</li>" for i in range(8))
    page = browser.new_page(viewport=WIDE)
    page.set_content(f'{output._LAYOUT}<ul class="contents">{entries}</ul>')
    boxes = [entry.bounding_box() for entry in page.locator("li").all()]
    page.close()
    columns = {box["x"] for box in boxes}
    tops = {min(box["y"] for box in boxes if box["x"] == x) for x in columns}
    assert (len(columns), len(tops)) == (2, 1)
