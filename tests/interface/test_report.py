"""The report: what is in the page, and that browsers show it."""

import base64
import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.views.report.tables import number

pytest.importorskip("plotly")

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "towed_cable.yaml"


@pytest.fixture(scope="module")
def towed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Log of the whole towed-cable scene."""
    path = tmp_path_factory.mktemp("report") / "towed.mcap"
    cm.simulate(cm.load_scene(SCENE), log=path)
    return path


@pytest.fixture
def everything(tmp_path: Path, full_scene: Any, swinging_cable: Any) -> Path:
    """Log of a run with bodies, pay-out, a sloping floor and touchdown."""
    data = full_scene.to_dict()
    data["environment"]["floor"] = {"z": -24, "slope": [0.05, 0.02], "friction": 0.3}
    scene = cm.load_scene(data)
    path = tmp_path / "everything.mcap"
    cm.simulate(scene, log=path, model=swinging_cable(scene))
    return path


def made(log: Path) -> Path:
    result = CliRunner().invoke(app, ["report", str(log)])
    assert result.exit_code == 0, result.output
    page = log.with_suffix(".html")
    assert str(page) in result.stdout
    return page


def data_of(page: Path) -> Any:
    text = page.read_text(encoding="utf-8")
    found = re.search(r'<script type="application/json" id="run">(.*?)</script>', text)
    assert found is not None
    return json.loads(found[1])


def array(spec: Any) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(spec["bdata"]), f"<{spec['dtype']}")
    return values.reshape([int(length) for length in spec["shape"].split(",")])


def plain(figure: Any) -> Any:
    """A figure with its arrays as arrays."""
    if isinstance(figure, dict):
        if set(figure) == {"dtype", "bdata", "shape"}:
            return array(figure)
        return {key: plain(value) for key, value in figure.items()}
    return [plain(item) for item in figure] if isinstance(figure, list) else figure


def figures_of(data: Any, line: str = "") -> Any:
    """All figures of a page, with those of a line."""
    return plain({**data["figures"], **data["lines"][line]["figures"]})


def test_the_page_holds_what_the_run_holds(towed: Path) -> None:
    run, data = cm.open_run(towed), data_of(made(towed))
    figures = figures_of(data)
    assert np.array_equal(figures["top-tension"]["data"][0]["y"], run.top_tension)
    heat = figures["tension-map"]["data"][0]
    assert heat["z"].shape == (len(heat["y"]), len(heat["x"])) == (101, 401)
    assert heat["z"][0] == pytest.approx(run.top_tension, rel=1e-6)
    assert np.array_equal(
        figures["inputs"]["data"][0]["y"], run.applied_inputs["vessel_velocity.x"]
    )
    assert "touchdown" not in figures
    shape = plain(data["shape"])
    end = shape["position"][-1, -1] + [*shape["ground"][-1], 0.0]
    assert end == pytest.approx(run.tip_position[-1], abs=1e-4)


def test_axes_of_the_shape_have_one_scale(towed: Path, everything: Path) -> None:
    for log in (towed, everything):
        for view in data_of(made(log))["shape"]["views"].values():
            scale = [
                (view[f"{axis}axis"]["range"][1] - view[f"{axis}axis"]["range"][0])
                / view["aspectratio"][axis]
                for axis in "xyz"
            ]
            assert scale == pytest.approx([scale[0]] * 3)
            assert view["aspectmode"] == "manual"


def test_plotly_accepts_all_figures(towed: Path, everything: Path) -> None:
    import plotly.graph_objects as go

    for log in (towed, everything):
        for name, figure in figures_of(data_of(made(log))).items():
            assert go.Figure(figure).data, name


def test_a_scene_with_everything_has_all_charts(everything: Path) -> None:
    run, data = cm.open_run(everything), data_of(made(everything))
    figures = figures_of(data)
    reaction = figures["touchdown"]["data"][1]["y"]
    assert np.array_equal(reaction, run["floor_length"])
    assert len(figures["inputs"]["data"]) == 2
    bodies = plain(data["shape"])["marks"][1]
    ground = plain(data["shape"])["ground"][:, None, :]
    assert bodies[..., :2] + ground == pytest.approx(run["bodies.position"][..., :2], abs=1e-4)
    assert data["shape"]["floor"]["level"] is False
    # The heat map has no cable beyond its end, which is paid out.
    values = figures["tension-map"]["data"][0]["z"]
    assert np.isnan(values[-1, 0])
    assert np.isfinite(values[-1, -1])


def test_what_is_paid_out_is_told(towed: Path, everything: Path) -> None:
    """The length at the end too, where it is another; curves along the cable go up to there."""
    assert "30 m of K · far end free" in made(towed).read_text(encoding="utf-8")
    run, page = cm.open_run(everything), made(everything)
    start, end = (f"{length:.5g}" for length in run["line_length"][[0, -1]])
    kinds = f"{start} m of [^·<]* at the start, {end} m at the end · "
    assert re.search(kinds, page.read_text(encoding="utf-8"))
    data = data_of(page)
    ends = plain(data["lines"][""]["ends"])
    assert ends["s"] == pytest.approx(run["line_length"])
    assert ends["tension-along"][-1] == pytest.approx(run.states[-1].tension[-1])
    now = figures_of(data)["tension-along"]["data"][2]
    assert now["x"][-1] == pytest.approx(run["line_length"][0])
    assert len(now["x"]) == len(now["y"]) < 101


def test_extremes_are_those_of_all_outputs(towed: Path) -> None:
    text = made(towed).read_text(encoding="utf-8")
    lowest = cm.open_run(towed).tension_min.min()
    assert f"<h3>Tension, lowest</h3><p><b>{number(lowest, 100.0)}</b>" in text.replace("\n", "")
    largest = cm.open_run(towed).states.max_curvature
    assert f"<b>{largest:#.4g}</b>" in text
    assert "at t = 30 s, s = 0 m" in text


def test_bodies_are_called_by_their_names(
    tmp_path: Path, full_scene: Any, swinging_cable: Any
) -> None:
    """Else by their number."""
    data = full_scene.to_dict()
    bodies = [item["body"] for item in data["line"] if "body" in item]
    for body in bodies:
        body.pop("name", None)
    bodies[0]["name"] = "sonar"
    scene = cm.load_scene(data)
    path = tmp_path / "named.mcap"
    cm.simulate(scene, log=path, model=swinging_cable(scene))
    text = made(path).read_text(encoding="utf-8")
    assert "sonar, z" in text
    assert "body 1 from the vessel, z" not in text
    assert "body 2 from the vessel, z" in text


def test_what_never_moves_has_no_chart_of_it(tmp_path: Path) -> None:
    path = tmp_path / "still.mcap"
    scene = cm.load_scene(ROOT / "scenes" / "towed_cable.yaml", ["vessel.velocity=[0, 0, 0]"])
    cm.simulate(scene, until=1.0, log=path)
    assert "inputs" not in figures_of(data_of(made(path)))


def test_times_at_which_a_line_was_slack_are_told_and_shaded(everything: Path) -> None:
    """Half of every second, of which there are outputs at the end of each tenth."""
    run, page = cm.open_run(everything), made(everything)
    text = page.read_text(encoding="utf-8").replace("\n", "")
    assert f"<h3>Slack for</h3><p><b>{number(run['slack_time'][-1])}</b>" in text
    tension = figures_of(data_of(page))["top-tension"]
    shades = [(shade["x0"], shade["x1"]) for shade in tension["layout"]["shapes"]]
    grew = np.flatnonzero(np.diff(run["slack_time"]) > 0.0)
    assert shades[0][0] == run.time[grew[0]]
    assert shades[-1][1] == run.time[grew[-1] + 1]


def test_the_page_needs_no_network_and_is_small(towed: Path) -> None:
    page = made(towed)
    assert page.stat().st_size < 15e6
    text = page.read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    assert not re.search(r"<(script|link|img)[^>]*(src|href)=\"(?!data:)", text)


def test_text_of_a_scene_is_only_text(tmp_path: Path, simple_scene: Any) -> None:
    title = "</script><script>alert('1')</script> <!-- $title & co"
    scene = cm.load_scene({**simple_scene.to_dict(), "title": title})
    log = tmp_path / "run.mcap"
    cm.simulate(scene, log=log, until=0.6)
    text = made(log).read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert(&#x27;1&#x27;)&lt;/script&gt; &lt;!-- $title &amp; co" in text


def test_a_cut_run_says_so(towed: Path, tmp_path: Path) -> None:
    log = tmp_path / "cut.mcap"
    log.write_bytes(towed.read_bytes()[:-2000])
    assert "This run is not complete" in made(log).read_text(encoding="utf-8")


def test_a_run_of_one_instant_has_a_report(tmp_path: Path, simple_scene: Any) -> None:
    from cablemodel.results.log.writer import LogWriter

    log = tmp_path / "start.mcap"
    model = cm.CableModel(simple_scene)
    with LogWriter(log, simple_scene) as writer:
        writer.write_outputs(model, model.state())
        writer.close({})
    assert "inputs" not in data_of(made(log))["figures"]


@pytest.mark.parametrize(
    ("output", "words"), [("page.pdf", ".html"), ("no/such/page.html", "no folder")]
)
def test_a_wrong_output_is_bad_input(towed: Path, output: str, words: str) -> None:
    result = CliRunner().invoke(app, ["report", str(towed), "-o", output])
    assert result.exit_code == 2
    assert words in result.stderr


def test_without_plotly_the_error_names_the_extra() -> None:
    code = (
        "import sys; sys.modules['plotly'] = sys.modules['plotly.offline'] = None\n"
        "import cablemodel.views.report as report\n"
        "from cablemodel import CableModelError\n"
        "try:\n    report.report_html(None)\n"
        "except CableModelError as error:\n    print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert "cablemodel[plot]" in done.stdout


# ---- in a browser ----

_BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
_DRIVER = shutil.which("chromedriver")
_FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--disable-dev-shm-usage",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
)  # fmt: skip
SCREENS = {"laptop": (1440, 900, False), "phone": (390, 844, True)}


@pytest.fixture
def browser(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    """Chromium with the screen of a laptop or a phone."""
    webdriver = pytest.importorskip("selenium.webdriver")
    if _BROWSER is None or _DRIVER is None:
        pytest.skip("Chromium and its driver are not installed (`make browser` does it as root)")
    width, height, phone = SCREENS[request.param]
    options = webdriver.ChromeOptions()
    options.binary_location = _BROWSER
    for flag in (*_FLAGS, f"--user-data-dir={tmp_path / 'profile'}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    metrics = {"width": width, "height": height, "pixelRatio": 2 if phone else 1, "touch": phone}
    options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(_DRIVER))
    driver.set_page_load_timeout(120)
    driver.set_script_timeout(60)
    yield driver
    driver.quit()


def wait(driver: Any, script: str, seconds: float = 90.0) -> None:
    """Until a JavaScript expression is true."""
    end = time.monotonic() + seconds
    while not driver.execute_script(f"return Boolean({script})"):
        assert time.monotonic() < end, f"still not: {script}"
        time.sleep(0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("browser", "which"),
    [("laptop", "towed"), ("laptop", "everything"), ("phone", "everything")],
    indirect=["browser"],
)
def test_browsers_show_the_page(
    browser: Any, which: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    log = request.getfixturevalue(which)
    browser.get(made(log).as_uri())
    wait(browser, "document.body.dataset.ready")
    run = cm.open_run(log)

    # Nothing sticks out sideways, every figure is drawn, and nothing came over the network.
    assert browser.execute_script("return document.documentElement.scrollWidth - innerWidth") <= 0
    assert (
        browser.execute_script(
            "return [...document.querySelectorAll('.figure')].filter(f => f.offsetParent && "
            "!f.querySelector('.main-svg')).map(f => f.id)"
        )
        == []
    )
    assert browser.execute_script("return performance.getEntriesByType('resource').length") == 0

    # The time slider moves the shape, the profiles and the cursors.
    last = len(run.states) - 1
    browser.execute_script(
        "const s = document.getElementById('time'); s.value = arguments[0];"
        "s.dispatchEvent(new Event('input'))",
        last,
    )
    wait(browser, f"document.body.dataset.frame === '{last}'")
    length = "document.getElementById('tension-along').data[2].y"
    wait(browser, f"Math.abs({length}[0] - {run.top_tension[-1]}) < 1e-3 * {run.top_tension[-1]}")
    reached = browser.execute_script(
        "const x = document.getElementById('tension-along').data[2].x; return x[x.length - 1]"
    )
    assert reached == pytest.approx(run["line_length"][-1])
    height = browser.execute_script(
        "const z = document.getElementById('shape').data[0].z; return z[z.length - 1]"
    )
    assert height == pytest.approx(run.tip_position[-1, 2], abs=1e-4)
    assert browser.execute_script(
        "return [...document.querySelectorAll('.cursor')].every(c => c.offsetHeight > 50)"
    )

    # The cable is seen: the colours of its tension are in the picture of the shape.
    picture = browser.execute_async_script(
        "Plotly.toImage('shape', {format: 'png', width: 600, height: 400}).then(arguments[0])"
    )
    assert _purple(base64.b64decode(picture.partition(",")[2])) > 50

    # Play begins anew from the end, and plays to the end.
    browser.execute_script(
        "const s = document.getElementById('speed'); s.selectedIndex = s.options.length - 1;"
        "window.seen = []; new MutationObserver(() => seen.push(document.body.dataset.frame))"
        ".observe(document.body, {attributeFilter: ['data-frame']})"
    )
    browser.find_element("id", "play").click()
    wait(browser, f"window.seen.includes('0') && window.seen.at(-1) === '{last}'")
    assert browser.find_element("id", "play").get_attribute("aria-label") == "Play"

    if which == "towed":
        browser.find_element("css selector", "[data-view=map]").click()
        wait(browser, "document.getElementById('shape').data[0].x[0] > 100")

    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert severe == []


def _purple(png: bytes) -> int:
    """Number of pixels in the colours of the cable, which nothing else in the shape has."""
    from io import BytesIO

    from PIL import Image

    pixels = np.asarray(Image.open(BytesIO(png)).convert("RGB"), int)[80:]
    red, green, blue = np.moveaxis(pixels, -1, 0)
    return int(np.count_nonzero((blue > green + 60) & (red > green + 20)))
