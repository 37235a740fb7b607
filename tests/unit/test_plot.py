"""Figures: what they show is what the run holds."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.results.states import States

matplotlib = pytest.importorskip("matplotlib")

from cablemodel.views.plot import draw, save_figure  # noqa: E402


def swing(
    plane: float = 0.0, travel: float = 0.0, out_of_plane: float = 0.0, length: float = 30.0
) -> Any:
    """A run of a straight cable that swings in a vertical plane at an angle from x."""
    time = np.linspace(0.0, 10.0, 41)
    s = np.linspace(0.0, length, 5)
    matrices = []
    for t in time:
        angle = 0.1 * t
        tangent = np.array(
            [
                np.cos(plane) * np.sin(angle),
                np.sin(plane) * np.sin(angle),
                -np.cos(angle),
            ]
        )
        position = s[:, None] * tangent + [travel * t, 0.0, 0.0]
        position[:, 1] += out_of_plane * np.sin(t) * s / length
        rows = np.zeros((14, 5))
        rows[0] = s
        rows[1:4] = position.T
        rows[4:7] = tangent[:, None]
        rows[10] = 100.0 - s + t
        matrices.append(rows)
    tension = 100.0 + time
    states = States(time, matrices)
    return SimpleNamespace(
        states=states,
        shapes={"": states},
        time=time,
        top_tension=tension,
        tension_max=tension,
        names=(),
        scene=SimpleNamespace(environment=SimpleNamespace(floor=None)),
    )


def lines(axes: Any) -> list[Any]:
    return [line for line in axes.get_lines() if line.get_linestyle() == "-"]


def test_a_plane_run_has_three_panels_labelled_with_units() -> None:
    figure = draw(swing())
    side, top, along = figure.axes
    assert (side.get_xlabel(), side.get_ylabel()) == ("x [m]", "z [m]")
    assert (top.get_xlabel(), top.get_ylabel()) == ("time [s]", "top tension [N]")
    assert along.get_xlabel() == "arc length from the vessel [m]"
    assert along.get_ylabel() == "tension [N]"
    assert side.get_aspect() == 1.0
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["time:", "0 s", "2 s", "4 s", "6 s", "8 s", "10 s"]


def test_the_curves_are_the_values_of_the_run() -> None:
    run = swing()
    side, top, along = draw(run).axes
    shapes = lines(side)
    assert len(shapes) == 6
    assert shapes[-1].get_xdata()[-1] == pytest.approx(30 * np.sin(1.0))
    assert shapes[-1].get_ydata()[-1] == pytest.approx(-30 * np.cos(1.0))
    assert np.array_equal(lines(top)[0].get_ydata(), run.top_tension)
    assert np.array_equal(lines(along)[-1].get_ydata(), run.states[-1].tension)


def test_a_run_out_of_plane_has_a_plan() -> None:
    axes = draw(swing(out_of_plane=2.0)).axes
    assert len(axes) == 4
    assert [a.get_ylabel() for a in axes[:2]] == ["z [m]", "y [m]"]


@pytest.mark.parametrize(
    ("plane", "label"),
    [(0.0, "x [m]"), (90.0, "y [m]"), (30.0, "distance along 30° from x [m]")],
)
def test_a_plane_is_seen_from_the_side_wherever_it_stands(plane: float, label: str) -> None:
    side = draw(swing(plane=np.radians(plane))).axes[0]
    assert side.get_xlabel() == label
    assert lines(side)[-1].get_xdata()[-1] == pytest.approx(30 * np.sin(1.0))


def test_the_sea_floor_bodies_and_touchdown_are_drawn() -> None:
    run = swing()
    run.scene.environment.floor = SimpleNamespace(z=-28.0, slope=(0.0, 0.0))
    run.names = ("bodies.position", "touchdown_position")
    places = {
        "bodies.position": np.full((41, 2, 3), np.nan),
        "touchdown_position": np.full((41, 3), np.nan),
    }
    places["bodies.position"][-1, 1] = [1.0, 0.0, -2.0]
    places["touchdown_position"][-1] = [3.0, 0.0, -28.0]
    with_columns = type("Fake", (SimpleNamespace,), {"__getitem__": lambda _, name: places[name]})
    side = draw(with_columns(**vars(run))).axes[0]
    assert any(np.allclose(line.get_ydata(), -28.0) for line in lines(side))
    for marker, place in (("o", [1.0, -2.0]), ("^", [3.0, -28.0])):
        drawn = [line.get_xydata() for line in side.get_lines() if line.get_color() != "0.15"
                 and line.get_marker() == marker]  # fmt: skip
        assert np.concatenate(drawn).tolist() == [place]
    key = [text.get_text() for text in side.figure.legends[0].get_texts()]
    assert key[-2:] == ["body", "touchdown"]


def test_a_cable_that_travels_far_is_drawn_from_the_tow_point() -> None:
    side = draw(swing(travel=10.0)).axes[0]
    assert side.get_xlabel() == "x from the tow point [m]"
    assert lines(side)[-1].get_xdata()[0] == 0.0


def test_high_tensions_are_in_kilonewtons() -> None:
    run = swing()
    run.top_tension = 1e3 * run.top_tension
    run.tension_max = run.top_tension
    top = draw(run).axes[1]
    assert top.get_ylabel() == "top tension [kN]"
    assert lines(top)[0].get_ydata()[0] == 100.0


def test_a_cable_at_rest_is_drawn_once() -> None:
    run = swing()
    run.shapes = {"": States(run.time, [run.states._matrices[0]] * len(run.time))}
    assert len(lines(draw(run).axes[0])) == 1


@pytest.mark.parametrize(
    ("ending", "start"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")]
)
def test_formats(tmp_path: Path, ending: str, start: bytes) -> None:
    path = tmp_path / f"figure.{ending}"
    save_figure(swing(), path)
    assert path.read_bytes().startswith(start)


def test_an_unknown_format_is_a_clear_error(tmp_path: Path) -> None:
    with pytest.raises(cm.CableModelError, match="not supported"):
        save_figure(swing(), tmp_path / "figure.xyz")


def test_no_states_are_a_clear_error() -> None:
    with pytest.raises(cm.CableModelError, match="no states"):
        draw(SimpleNamespace(shapes={"": States(np.empty(0), [])}))  # type: ignore[arg-type]


def test_without_matplotlib_the_error_says_what_to_install() -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "import cablemodel.views.plot as plot\n"
        "try:\n    plot.draw(None)\n"
        "except plot.CableModelError as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "cablemodel[plot]" in done.stdout


def test_a_long_key_stays_within_the_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Six times, bodies, vessels' points and slack take two rows."""
    monkeypatch.setattr("cablemodel.views.plot.slack_spans", lambda run: [(0.0, 1.0)])
    scene = {
        "cable_types": {"wire": {"diameter": 0.01, "mass": 0.4, "axial_stiffness": 1e6}},
        "vessels": {"ship": {"points": {"hook": [0, 0, 0]}, "velocity": [1, 0, 0]}},
        "bodies": {
            "load": {
                "mass": 100, "submerged_weight": 800, "inertia": 10, "points": {"eye": [0, 0, 1]}
            }
        },
        "lines": {
            "wire": {
                "from": "ship.hook", "to": "load.eye",
                "items": [{"cable": {"type": "wire", "length": 20}}],
            }
        },
    }  # fmt: skip
    figure = draw(cm.simulate(scene, until=20.0))
    (key,) = figure.legends
    assert len(key.get_texts()) >= 9
    assert key.get_window_extent().width <= figure.bbox.width
