"""Films: they are what they should be, and a missing writer is said."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.views.animate import _Film
from cablemodel.views.plot import FLOOR_COLOUR

pytest.importorskip("matplotlib")

ROOT = Path(__file__).parents[2]


def animate(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, ["animate", *map(str, arguments)])


@pytest.fixture
def log(tmp_path: Path, full_scene: Any, swinging_cable: Any) -> Path:
    path = tmp_path / "run.mcap"
    cm.simulate(full_scene, log=path, model=swinging_cable(full_scene))
    return path


def test_a_gif_has_the_pictures_asked_for_and_they_move(log: Path) -> None:
    from PIL import Image

    path = log.with_suffix(".gif")
    result = animate(log, "-o", path, "--seconds", "1", "--fps", "8")
    assert result.exit_code == 0, result.output
    assert str(path) in result.stdout
    with Image.open(path) as film:
        assert film.n_frames == 8
        first = np.asarray(film.convert("RGB"), int)
        film.seek(7)
        last = np.asarray(film.convert("RGB"), int)
    assert np.count_nonzero(np.abs(first - last).sum(axis=-1) > 100) > 200


def test_bodies_touchdown_and_floor_are_in_the_picture(log: Path) -> None:
    film = _Film(cm.open_run(log))
    side = film._panels[0].axes
    film.picture(float(cm.open_run(log).states.time[-1]))
    shown = {line.get_marker(): line.get_xydata() for line in side.get_lines()}
    run = cm.open_run(log)
    along = film._view.horizontal(run["bodies.position"][-1] - film._view.origin[-1])[0]
    assert shown["o"][:, 0].tolist() == along.tolist()
    assert np.isfinite(shown["^"]).all() == np.isfinite(run["touchdown_position"][-1]).all()
    assert any(line.get_color() == FLOOR_COLOUR for line in side.get_lines())


def test_an_mp4_plays_on_phones(log: Path) -> None:
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    assert animate(log, "--seconds", "1", "--fps", "10").exit_code == 0
    film = str(log.with_suffix(".mp4"))
    done = subprocess.run(
        [imageio_ffmpeg.get_ffmpeg_exe(), "-i", film, "-f", "null", "-"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert re.search(r"Video: h264.*yuv420p.* 10 fps", done.stderr)
    assert re.findall(r"frame= *(\d+)", done.stderr)[-1] == "10"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "film.avi"], ".mp4"),
        (["-o", "no/such/film.gif"], "no folder"),
        (["--seconds", "0"], "--seconds"),
        (["--seconds", "nan"], "--seconds"),
        (["--fps", "0"], "--fps"),
    ],
)
def test_bad_options_are_bad_input(log: Path, arguments: list[str], words: str) -> None:
    result = animate(log, *arguments)
    assert result.exit_code == 2, result.output
    assert words in result.stderr


def test_without_ffmpeg_the_error_says_what_to_do(
    log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    result = animate(log)
    assert result.exit_code == 1
    assert "cablemodel[plot]" in result.stderr
    assert "GIF" in result.stderr


def test_without_matplotlib_the_error_names_the_extra() -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "from cablemodel.views.animate import CableModelError, save_animation\n"
        "try:\n    save_animation(None, 'film.gif')\n"
        "except CableModelError as error:\n    print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert "cablemodel[plot]" in done.stdout
