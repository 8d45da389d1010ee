"""Tests of the pages in a browser: scripts run without errors, pictures load, and controls do what they say.

Screenshots stay in build/screenshots."""

import functools
import html
import http.server
import json
import pathlib
import re
import shutil
import subprocess
import threading

import pytest

from conftest import page_data
from documents import SOURCE
import fitting
from test_fit import ROUGH, folder  # noqa: F401, a fixture
from test_report import HOSTILE, data_set  # noqa: F401, a fixture
from test_run import DEMO

SCREENSHOTS = SOURCE / "build" / "screenshots"
# Lines that the site's search prints if it is ready before the browser ends.
NEWS = ("All search scripts loaded, building Lunr index", "Lunr index built, search ready")
# Runs the test's own script in the loaded page and leaves its result there. sizes() loads lazy images.
PROBE = """
<script>
const find = selector => [...document.querySelectorAll(selector)];
const sizes = async () => {
  document.querySelectorAll("img").forEach(image => { image.loading = "eager"; });
  await Promise.all(find("img").map(image => image.complete || new Promise(done => {
    image.addEventListener("load", done);
    image.addEventListener("error", done);
  })));
  return find("img").map(image => [image.getAttribute("src"), image.naturalWidth]);
};
const change = (element, value) => {
  element.value = value;
  element.dispatchEvent(new Event(element.type === "range" ? "input" : "change"));
};
addEventListener("load", async () => {
  const found = await (async () => { %s })();
  const answer = document.createElement("pre");
  answer.id = "answer";
  answer.hidden = true;
  answer.textContent = JSON.stringify(found);
  document.body.append(answer);
});
</script>
</body>"""


@pytest.fixture(name="look")
def fixture_look(tmp_path):
    """Opens a page in the browser and returns the script's result. Nothing may appear on the console."""
    browser = shutil.which("chromium")
    if not browser:
        pytest.skip("chromium is not installed")

    def look(page, script, name, size=(1300, 1800), host=None):
        probe = page.with_name("probe.html")
        probe.write_text(page.read_text(encoding="utf-8").replace("</body>", PROBE % script), encoding="utf-8")

        def run(*options):
            return subprocess.run(
                [browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--enable-logging=stderr",
                 f"--user-data-dir={tmp_path / 'browser'}", f"--window-size={size[0]},{size[1]}",
                 "--virtual-time-budget=20000", *options, f"{host}/{probe.name}" if host else probe.resolve().as_uri()],
                capture_output=True, text=True, timeout=300, check=True)

        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        answer = run("--dump-dom")
        told = [line for line in answer.stderr.splitlines() if "CONSOLE" in line and not any(news in line for news in NEWS)]
        assert not told, told
        run(f"--screenshot={SCREENSHOTS / name}.png")
        assert (SCREENSHOTS / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        probe.unlink()
        (found,) = re.findall(r'<pre id="answer"[^>]*>(.*?)</pre>', answer.stdout, re.S)
        return json.loads(html.unescape(found))

    return look


def test_errors_are_seen(look, tmp_path):
    """A missing picture has no width, and an error in a script fails the check."""
    page = tmp_path / "page.html"
    page.write_text('<!DOCTYPE html>\n<body><img src="nowhere.png"></body>')
    assert look(page, "return sizes();", "broken") == [["nowhere.png", 0]]
    page.write_text("<!DOCTYPE html>\n<body><script>fail();</script></body>")
    with pytest.raises(AssertionError, match="fail is not defined"):
        look(page, "return 1;", "broken")
    (SCREENSHOTS / "broken.png").unlink(missing_ok=True)


def test_the_page_of_a_run(sonject, tmp_path, look):
    sonject.done("run", DEMO, "-o", "demo", "--set", f"objects[0].name={json.dumps(HOSTILE)}",
                 "--set", "injection.order_energies=true", "--set", "injection.interactions=2")
    found = look(tmp_path / "demo" / "report.html", """
        const slider = find("input[type=range]")[0], [, after, difference] = find(".layer");
        const picture = find(".picture")[0], edges = picture.getBoundingClientRect();
        picture.dispatchEvent(new PointerEvent("pointermove", {clientX: edges.left + edges.width / 2, clientY: edges.top + edges.height / 2}));
        const place = picture.nextSibling.textContent;
        change(slider, 25);
        const boxes = find("input[type=checkbox]"), wasHidden = difference.hidden;
        boxes.filter(box => !box.checked).forEach(box => box.click());
        const layers = [find(".layer").length, wasHidden, difference.hidden];
        boxes[0].click();
        boxes[4].click();
        return {sizes: await sizes(), place, clip: after.style.clipPath, layers, head: find("th").slice(1, 4).map(cell => cell.textContent),
                rows: Object.fromEntries(find("tbody tr").map(row => [...row.cells].map(cell => cell.textContent)).map(([first, ...rest]) => [first, rest])),
                links: find("a").map(link => link.getAttribute("href")), boxes: find(".box").map(box => box.title), bold: find("b").length};
    """, "run")
    masks = [f"{name}.png" for name in ("highlight", "shadow", "labels", "influence")]
    assert [name for name, _ in found["sizes"]] == ["quicklook.png"] * 3 + masks
    assert all(width > 0 for _, width in found["sizes"])
    assert found["clip"] == "inset(0px 0px 0px 25%)" and found["layers"] == [7, True, False]
    truth = page_data(tmp_path / "demo")["truth"]
    names = [each["name"] for each in truth["objects"]]
    assert names[0] == HOSTILE and found["boxes"] == names and found["bold"] == 0
    assert found["head"] == [f"{each['id']}: {each['name']}" for each in truth["objects"]]
    for text, key, digits in (("slant range, m", "slant_range_m", 2), ("target strength, dB", "target_strength_db", 1)):
        assert found["rows"][text] == [f"{each[key]:.{digits}f}" for each in truth["objects"]]
    assert found["rows"]["class"] == [each["class"] for each in truth["objects"]]
    assert found["rows"]["altitude_m"] == ["10", "scene"] and len(found["rows"]["2"]) == 3  # the row of two interactions
    row, column = (truth["patch"][side] / 2 for side in ("rows", "columns"))
    row_there, column_there = map(float, re.match(r"row ([\d.]+), column ([\d.]+), along track ", found["place"]).groups())
    assert abs(row_there - row) <= 2 and abs(column_there - column) <= 2
    assert all((tmp_path / "demo" / name).is_file() for name in found["links"]) and len(found["links"]) > 12


def test_the_page_of_a_data_set(data_set, look):  # noqa: F811
    data = page_data(data_set)
    found = look(data_set / "report.html", """
        const [split, kind, which] = find("select"), count = () => find("figure").length;
        const all = {sizes: await sizes(), boxes: find(".gallery .box").length, heads: find("h3").map(head => head.textContent)};
        const counts = [];
        for (const [element, values] of [[split, ["0", "1", ""]], [kind, ["0", "1", "2", "none", ""]], [which, ["unseen", "anew", ""]]])
          for (const value of values) { change(element, value); counts.push(count()); }
        return {...all, counts, links: find("a").map(link => decodeURIComponent(link.getAttribute("href"))), options: [...kind.options].map(option => option.text),
                captions: find("figcaption").map(caption => caption.textContent), bars: find("svg.bars").length};
    """, "data_set", (1300, 2600))
    assert all(width > 0 for _, width in found["sizes"]) and len(found["sizes"]) == 12
    assert all((data_set / name).is_file() for name in found["links"]) and len(found["links"]) == 2 + 3 * 10
    objects = {row[0]: [dict(zip(data["columns"], each)) for each in row[4]] for row in data["rows"]}
    assert found["boxes"] == sum(each["rows"] is not None for image in objects.values() for each in image)
    assert found["heads"] == [*[split["name"] for split in data["splits"]], "swath0.png, boxes to avoid"] and found["bars"] == len(data["histograms"])
    assert found["options"] == ["anything", *data["classes"], "no object"] and HOSTILE in found["options"]
    with_class = [sum(any(each["class"] == name for each in image) for image in objects.values()) for name in data["classes"]]
    unseen = sum(not all(each["visible"] for each in image) for image in objects.values())
    anew = sum(row[3] is not None for row in data["rows"])
    assert found["counts"] == [5, 5, 10, *with_class, sum(not image for image in objects.values()), 10, unseen, anew, 10]
    for caption, row in zip(found["captions"], data["rows"]):
        assert caption.startswith(f"{row[0]} truth")
        assert all(f"{each['slant_range_m']:.1f} m, level {each['over_seabed_db']:.1f} dB" in caption for each in objects[row[0]])


def test_images_that_no_browser_shows_are_drawn(sonject, tmp_path, look):
    """The page draws TIFF images by itself, at most 60 at once."""
    sonject.done("seabed", "-o", "seabed.tif", "--rows", "300", "--columns", "400")
    sonject.done("campaign", SOURCE / "tools" / "campaigns" / "minefield.yaml", "-o", "set", "--set", "images=70",
                 "--set", "swaths=[{path: seabed.tif}]", "--set", "splits={all: 1}", "--set", "clutter.number=0")
    page = tmp_path / "set" / "report.html"
    found = look(page, """
        const counts = [], pieces = () => find(".chip div").map(piece => piece.style.background).filter(Boolean).length;
        const [back, next] = find("button");
        for (const button of [null, next, back]) { if (button) button.click(); counts.push([find("figure").length, pieces(), back.disabled, next.disabled]); }
        return {sizes: await sizes(), counts};
    """, "tiff")
    assert found["counts"] == [[60, 60, True, False], [10, 10, False, True], [60, 60, True, False]]
    ((sheet, width),) = found["sizes"]
    assert sheet == "contact_sheet.png" and width > 1000
    assert sorted(path.name for path in (tmp_path / "set" / "chips").iterdir()) == ["0.png", "1.png"]


def test_the_page_of_a_fit(sonject, folder, look):  # noqa: F811
    (folder / "hidden.yaml").write_text(fitting.campaign(fitting.HIDDEN, 40, 11, 64, 96, more=ROUGH))
    sonject.done("campaign", "hidden.yaml", "-o", "contacts", "--quiet")
    sonject.done("fit", "start.yaml", "contacts/all/coco.json", "-o", "fitted.yaml", "--quiet")
    data = page_data(folder, "fitted.html")
    found = look(folder / "fitted.html", """
        return {sizes: await sizes(), bars: find("svg.bars").length, lines: find("svg.bars path").length, heads: find("h1, h2").map(head => head.textContent),
                rows: find("tbody tr").map(row => [...row.cells].map(cell => cell.textContent)), kept: find("li").map(item => item.textContent)};
    """, "fit", (1300, 2200))
    ((chips, width),) = found["sizes"]
    assert chips == "fitted.png" and width > 1000
    assert found["heads"][0] == "A campaign fitted to 40 contacts" and found["heads"][-2:] == ["Draws", "Chips"]
    shown = [extent for extent in data["fit"] if extent]
    assert found["bars"] == len(shown) > 5 and found["lines"] == 2 * len(shown)
    assert found["rows"] == [[draw["key"], ", ".join(draw["before"]), ", ".join(draw["after"])] for draw in data["draws"]]
    assert found["kept"][-2:] == ["draw.objects[].heading", "draw.objects[].burial.fraction"]


def test_the_site_has_no_dead_links_and_is_shown(look):
    answer = subprocess.run(["sh", SOURCE / "tools" / "site.sh"], check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    start = pathlib.Path(answer.stdout.splitlines()[-1])
    # the site's search is a worker, which a page opened as a file may not start
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=start.parent)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        host = f"http://127.0.0.1:{server.server_port}"
        for page, folder, picture in ((start, "", "docs/demo.png"), (start.parent / "docs" / "gallery.html", "/docs", "gallery/")):
            found = look(page, "return {sizes: await sizes(), head: find('h1')[0].textContent, nav: find('nav a').length};",
                         page.stem, host=host + folder)
            assert found["nav"] > 15 and found["head"]
            assert found["sizes"] and all(width > 0 for _, width in found["sizes"])
            assert any(picture in name for name, _ in found["sizes"])
        server.shutdown()
