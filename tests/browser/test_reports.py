"""What a run's report looks like in a browser."""

import innervate
from innervate import Mesh
from tests.browser.servers import PHONE

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
