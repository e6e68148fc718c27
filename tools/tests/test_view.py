"""The page in a real browser: what it draws is what the log says."""

from __future__ import annotations

import csv
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from browser import Browser
from logs import clustered_run, program, simulated, small_run, targets_run, write_log
from PIL import Image

from motehound_tools.view.colours import CLUSTER, MAP, SINK, TARGETS, TRACK

TOOLS = Path(__file__).resolve().parents[1]
OWN_NETWORK = "MOTEHOUND_OWN_NETWORK"


class Served:
    """tools/view as its user starts it."""

    def __init__(self, *arguments: str) -> None:
        call = [sys.executable, "-m", "motehound_tools", "view", *arguments, "--port", "0"]
        environment = {**os.environ, "PYTHONPATH": str(TOOLS)}
        self.process = subprocess.Popen(
            call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
        )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        assert self.url.startswith("http://localhost:"), self.process.stderr.read() if self.process.stderr else ""

    def __enter__(self) -> Served:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        _, errors = self.process.communicate(timeout=10)
        assert errors == ""


needs_browser = pytest.mark.browser


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulated(tmp_path_factory.mktemp("run") / "exp1", "--set", "metrics.mote_interval_s=2")


@pytest.fixture(scope="module")
def served(log: Path) -> Iterator[Served]:
    with Served(str(log)) as one:
        yield one


@pytest.fixture(scope="module")
def shared_browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("browser")) as one:
        yield one


@pytest.fixture
def browser(shared_browser: Browser) -> Iterator[Browser]:
    yield shared_browser
    assert shared_browser.errors == []
    shared_browser.open("about:blank")


def opened(browser: Browser, url: str) -> None:
    browser.open(url)
    browser.until(
        "window.Bokeh?.documents.length && /\\d+ motes/.test(document.title) && !model('status').text", define=MODEL
    )


MODEL = "window.model = (name) => Bokeh.documents[0].get_model_by_name(name);"


def length(browser: Browser, source: str) -> int:
    return browser.evaluate(f"model('{source}').get_length()")


def title(browser: Browser) -> tuple[float, int, int]:
    """Time, motes and frames, as the page says."""
    found = re.search(r"· ([\d.]+) s · (\d+) motes · (\d+) frames", browser.evaluate("document.title"))
    assert found
    return float(found[1]), int(found[2]), int(found[3])


def rows(log: Path, name: str) -> list[dict[str, str]]:
    with (log.parent / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


def pixels(path: Path, colour: str, tolerance: int = 12) -> int:
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    image = np.asarray(Image.open(path).convert("RGB")).astype(int)
    return int((np.abs(image - wanted).max(axis=2) <= tolerance).sum())


@needs_browser
def test_page_shows_the_run(browser: Browser, served: Served, log: Path) -> None:
    opened(browser, f"{served.url}?time=60.1&play=0&theme=dark&shade=sent")
    browser.until("document.title.includes('60.1 s')")
    nodes, tracks = rows(log, "nodes.csv"), rows(log, "track.csv")
    motes = [length(browser, "motes"), title(browser)[1]]
    assert motes == [len(nodes), len(nodes)]
    seen = [row for row in tracks if float(row["time_s"]) <= 60.1]
    assert browser.evaluate("model('paths').data.xs[0].length") == len(seen)
    head = browser.evaluate("[model('heads').data.x[0], model('heads').data.y[0]]")
    assert head == pytest.approx([float(seen[-1]["x_m"]), float(seen[-1]["y_m"])])
    assert length(browser, "ellipses") == 1
    assert length(browser, "arcs") == length(browser, "pulses") > 5
    shot = browser.screenshot("dark.png")
    assert pixels(shot, TRACK) > 300
    assert pixels(shot, "#151c26") > 200_000  # the dark cards
    assert pixels(shot, MAP[0], 25) > 500

    browser.evaluate("document.getElementById('theme').click()")
    light = browser.screenshot("light.png")
    assert pixels(light, "#ffffff") > 200_000 and pixels(light, "#151c26") < 10_000
    if kept := os.environ.get("MOTEHOUND_SCREENSHOTS"):
        shutil.copy(shot, kept)


@needs_browser
def test_frames_of_the_whole_run_are_counted(browser: Browser, served: Served, log: Path) -> None:
    opened(browser, f"{served.url}?time=1000&play=0")
    sent = int(float(rows(log, "runs.csv")[0]["frames_sent"]))
    browser.until(f"document.title.includes(' {sent} frames')")
    assert "Totals of the run" in browser.evaluate("model('counters').text")
    assert "Skipped" not in browser.evaluate("model('counters').text")


@needs_browser
def test_slider_play_and_keys_move_the_time(browser: Browser, served: Served) -> None:
    opened(browser, f"{served.url}?play=0")
    assert title(browser)[0] == 0.0
    browser.evaluate("model('slider').value = 30; 0")
    browser.until("document.title.includes(' 30.0 s')")
    browser.do("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight")
    browser.until("document.title.includes(' 31.0 s')")
    browser.do("Input.dispatchKeyEvent", type="keyDown", key=" ")
    browser.until("model('slider').value > 32")
    browser.do("Input.dispatchKeyEvent", type="keyDown", key=" ")
    time.sleep(1.0)
    paused = browser.evaluate("model('slider').value")
    time.sleep(0.5)
    assert browser.evaluate("model('slider').value") == paused < 60.0
    browser.evaluate("model('speed').value = '50.0'; model('play').active = true; 0")
    browser.until("!model('play').active", 10)  # at the end
    assert browser.evaluate("model('slider').value") == pytest.approx(browser.evaluate("model('slider').end"), abs=0.02)


@needs_browser
def test_mouse_hovers_and_zooms_and_the_layers_agree(browser: Browser, served: Served) -> None:
    opened(browser, f"{served.url}?time=40&play=0")
    legend = "document.querySelector('[data-layer=track]')"
    hidden = "model('over').renderers.filter((one) => one.glyph.tags == 'track').map((one) => one.visible).join()"
    browser.evaluate(f"{legend}.click()")
    assert browser.evaluate(hidden) == "false,false,false,false"
    browser.evaluate(f"{legend}.click()")
    assert browser.evaluate(hidden) == "true,true,true,true"
    frame = """(name) => { const box = Bokeh.index.get_by_id(model(name).id).frame.bbox;
        return [box.left, box.top, box.width, box.height] }"""
    assert browser.evaluate(f"({frame})('map')") == browser.evaluate(f"({frame})('over')")
    ranges = "['map', 'over'].map((name) => [model(name).x_range.start, model(name).y_range.end])"
    before = browser.evaluate(ranges)
    browser.do("Input.dispatchMouseEvent", type="mouseMoved", x=500, y=300)
    browser.do("Input.dispatchMouseEvent", type="mouseWheel", x=500, y=300, deltaX=0, deltaY=-300)
    time.sleep(0.5)
    after = browser.evaluate(ranges)
    assert after[0] == pytest.approx(after[1]) and after[0] != pytest.approx(before[0])
    place = """(() => { const view = Bokeh.index.get_by_id(model('map').id), data = model('motes').data;
        const box = view.canvas_view.el.getBoundingClientRect();
        const at = [...data.x.keys()].find((i) => Math.hypot(data.x[i] - 40, data.y[i] - 40) < 5);
        return [box.x + view.frame.x_scale.compute(data.x[at]), box.y + view.frame.y_scale.compute(data.y[at])] })()"""
    x, y = browser.evaluate(place)
    for shift in (3, 0):
        browser.do("Input.dispatchMouseEvent", type="mouseMoved", x=x + shift, y=y)
    browser.until("model('motes').inspected.indices.length > 0", 5)


@needs_browser
def test_clusters_are_shown(browser: Browser, tmp_path: Path) -> None:
    with Served(str(write_log(tmp_path / "events.lcm", clustered_run()))) as one:
        opened(browser, f"{one.url}?time=12&play=0")
        browser.until("document.title.includes('12.0 s')")
        assert [length(browser, name) for name in ("head", "members", "spokes", "sink")] == [1, 2, 2, 1]
        shot = browser.screenshot("clusters.png")
        assert pixels(shot, CLUSTER) > 100 and pixels(shot, SINK) > 50
        assert "members now" in browser.evaluate("model('counters').text")


@needs_browser
def test_several_targets_are_shown(browser: Browser, tmp_path: Path) -> None:
    with Served(str(write_log(tmp_path / "events.lcm", targets_run()))) as one:
        opened(browser, f"{one.url}?time=12.9&play=0&theme=light")
        browser.until("document.title.includes('12.9 s')")
        names = ("truth", "here", "heads", "extents", "watch_heads", "princes", "areas", "expected")
        assert [length(browser, name) for name in names] == [3, 3, 2, 1, 2, 2, 2, 2]
        shot = browser.screenshot("targets.png")
        assert all(pixels(shot, colour) > 100 for colour in TARGETS[:3]), "each in its colour"
        counters = browser.evaluate("model('counters').text")
        assert "group of 2: 16, 33" in counters and "head 90, prince 91" in counters


@needs_browser
def test_runs_can_be_chosen_and_damage_is_told(browser: Browser, tmp_path: Path) -> None:
    path = write_log(tmp_path / "two.lcm", [*small_run(0), *small_run(1, nodes=16), ("OTHER", b"0123456789")])
    path.write_bytes(path.read_bytes() + b"\xed\xa1\xda\x01 cut off")
    with Served(str(path)) as served:
        opened(browser, f"{served.url}?run=1&play=0")
        assert title(browser)[1] == 16
        browser.evaluate("model('runs').value = '0'; 0")
        browser.until("document.title.includes('9 motes')")
        browser.until("model('counters').text.includes('broken events')")
        assert "events of other types" in browser.evaluate("model('counters').text")


@needs_browser
def test_many_motes_and_odd_requests(browser: Browser, tmp_path: Path) -> None:
    path = write_log(tmp_path / "many.lcm", small_run(nodes=141 * 141, seconds=3))
    with Served(str(path)) as served:
        for odd in ("?time=nan&run=99", "?time=-4&run=x&shade=none", "?time=1e308"):
            opened(browser, served.url + odd)
            assert title(browser)[1] == 141 * 141


@pytest.mark.parametrize(
    "arguments, expected",
    [
        (["no.lcm"], r"no.lcm: cannot read: No such file or directory"),
        ([str(TOOLS / "view")], r"view: expected an LCM event log, found no event in its \d+ bytes"),
        (["--bus", "nowhere://"], r"--bus nowhere://: expected a URL that LCM serves, .*"),
        (["no.lcm", "--port", "70000"], r"--port 70000: expected 0 to 65535"),
    ],
)
def test_what_is_wrong_takes_one_line(arguments: list[str], expected: str) -> None:
    call = [sys.executable, "-m", "motehound_tools", "view", *arguments]
    done = subprocess.run(call, capture_output=True, text=True, cwd=TOOLS)
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(rf"motehound_tools: (.*/)?{expected}\n", done.stderr), done.stderr


def test_port_in_use(tmp_path: Path) -> None:
    path = write_log(tmp_path / "a.lcm", small_run())
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        call = [sys.executable, "-m", "motehound_tools", "view", str(path), "--port", str(port)]
        done = subprocess.run(call, capture_output=True, text=True, cwd=TOOLS)
    assert done.returncode == 1
    assert (
        done.stderr
        == f"motehound_tools: port {port}: cannot listen on it: Address already in use; --port names another\n"
    )


@needs_browser
def test_running_simulation(tmp_path: Path) -> None:
    """In a network of its own, as the tests of the bus."""
    if OWN_NETWORK in os.environ:
        follow_simulation(tmp_path)
        return
    alone = ["unshare", "-n"] if os.geteuid() == 0 else ["unshare", "-rn"]
    setup = "ip link set lo up && ip route add 224.0.0.0/4 dev lo"
    if subprocess.run([*alone, "sh", "-c", setup], capture_output=True).returncode:
        pytest.skip("no network namespace may be made")
    inside = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-rs",
        "-p",
        "no:cacheprovider",
        f"{__file__}::test_running_simulation",
    ]
    call = [*alone, "sh", "-c", f'{setup} && exec "$@"', "sh", *inside]
    environment = {**os.environ, OWN_NETWORK: "1", "MOTEHOUND": str(program()), "PYTHONPATH": str(TOOLS)}
    done = subprocess.run(call, env=environment, capture_output=True, text=True, cwd=TOOLS)
    if "skipped" in done.stdout and "passed" not in done.stdout:
        pytest.skip(done.stdout.strip().splitlines()[0])
    assert done.returncode == 0, done.stdout


def follow_simulation(tmp_path: Path) -> None:
    bus = "udpm://239.255.76.67:7667?ttl=0"
    call = [str(program()), "run", "luo_exp1", "--set", "tracker.name=luo", "--set", "network.nodes=400", "--bus", bus]
    call += ["--set", "radio.range_m=20", "--runs", "2", "--out", str(tmp_path / "out")]
    with Browser(tmp_path) as browser, Served("--bus", bus) as served:
        browser.open(served.url)
        browser.until(
            "window.Bokeh?.documents.length && model('status').text === 'Waiting for a run on the bus'", define=MODEL
        )
        subprocess.run(call, check=True, stdout=subprocess.DEVNULL)
        browser.until(
            "/run 1 · 9\\d\\.\\d s · 401 motes/.test(document.title)", 20
        )  # it follows to the end of the newest run
        assert length(browser, "traffic") == 240 and length(browser, "paths") == 1
        browser.evaluate("model('slider').value = 20; 0")  # and goes back
        browser.until("/ 20\\.\\d s /.test(document.title) && !model('follow').active")
        browser.evaluate("model('runs').value = '0'; 0")
        browser.until("document.title.includes('run 0')")
        assert browser.errors == []
