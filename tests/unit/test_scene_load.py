"""Scenes are read as they are meant, from every source, and written so that they read the same."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from scene_examples import full, minimal

import cablemodel as cm
from cablemodel.scene import apply_overrides

SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.yaml"))


def test_minimal_scene_has_the_documented_defaults() -> None:
    scene = cm.load_scene(minimal())
    assert scene.environment.gravity == 9.80665
    assert scene.environment.water_density == 1025
    assert scene.environment.current is None
    assert scene.environment.waves is None
    assert scene.environment.floor is None
    assert scene.end.kind == "free"
    assert scene.end.position is None
    assert scene.initial.kind == "static"
    assert scene.vessel.connection.kind == "pinned"
    assert scene.line[0].cable is not None
    assert scene.line[0].cable.model == "hybrid"
    assert scene.solver.method == "finite_element"
    assert scene.solver.tolerance == 1e-3
    assert scene.line_length == 30


def test_full_scene_has_every_value_in_si() -> None:
    scene = cm.load_scene(full())
    assert scene.environment.current is not None
    assert scene.environment.current.z.tolist() == [-50, 0]
    assert scene.environment.current.t.tolist() == [0, 100]
    assert scene.environment.current.velocity[0, 1].tolist() == [1, 0, 0]
    assert scene.environment.current.velocity[1, 0].tolist() == [0, 0.5, 0]
    assert scene.environment.waves is not None
    assert scene.environment.waves.jonswap is not None
    assert scene.environment.waves.jonswap.direction == pytest.approx(math.pi / 6, rel=1e-15)
    assert scene.environment.floor is not None
    assert scene.environment.floor.height(15, 3) == pytest.approx(-69.9)
    assert scene.cable_types["rope"].diameter == 0.012
    assert scene.cable_types["rope"].strain_coefficients == (1e-5, -1e-10)
    assert scene.cable_types["K"].strain_coefficients == (1e-6,)
    assert [body.name for body in scene.bodies] == ["sonar"]
    assert scene.line_length == 30
    assert scene.end.kind == "anchor"
    assert scene.end.position == (0, 0, -31)
    assert scene.end.connection.direction == (0, 0, -1)
    assert scene.initial.kind == "points"
    assert scene.initial.points == ((0, 0, 0), (0, 1, -15), (0, 0, -31))
    assert scene.vessel.connection.kind == "clamped"
    assert scene.vessel.connection.direction == pytest.approx((0, 2**-0.5, -(2**-0.5)))
    assert scene.vessel.velocity is not None
    assert scene.vessel.velocity[1].velocity[0] == pytest.approx(1852 / 3600)
    assert scene.payout.rate[1].rate == 0.7
    assert scene.payout.drum[0].cable is not None
    assert scene.run.duration == 120


@pytest.mark.parametrize("data", [minimal(), full()], ids=["minimal", "full"])
def test_written_scene_reads_the_same(data: dict[str, Any]) -> None:
    scene = cm.load_scene(data)
    assert cm.load_scene(scene.to_dict()) == scene
    assert cm.load_scene(scene.to_yaml()) == scene
    assert cm.load_scene(scene.to_yaml()).to_yaml() == scene.to_yaml()


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_ready_scenes_load_and_keep_their_source(path: Path) -> None:
    scene = cm.load_scene(path)
    assert scene.title
    assert scene.source_path == str(path)
    assert scene.source_text == path.read_text(encoding="utf-8")
    assert cm.load_scene(scene.to_yaml()) == scene


def test_there_are_ready_scenes() -> None:
    assert {path.stem for path in SCENES} >= {
        "towed_cable",
        "turn",
        "release_in_water",
        "whip",
    }


def test_submerged_weight_defaults_to_mass_less_displaced_water() -> None:
    data = minimal()
    data["environment"] = {"water_density": 1000, "gravity": 10}
    weight = cm.load_scene(data).cable_types["K"].submerged_weight
    assert weight == pytest.approx((0.4613 - 1000 * math.pi / 4 * 0.01666**2) * 10, rel=1e-14)
    data["cable_types"]["K"]["submerged_weight"] = -1.5
    assert cm.load_scene(data).cable_types["K"].submerged_weight == -1.5


def test_short_forms_mean_their_tables() -> None:
    data = minimal()
    data["environment"] = {"current": ["1 kn", 0, 0], "waves": "none"}
    data["vessel"] = {"velocity": [2, 0, 0]}
    data["payout"] = {"rate": "-0.5 m/s"}
    scene = cm.load_scene(data)
    assert scene.environment.current is not None
    assert scene.environment.current.velocity.shape == (1, 1, 3)
    assert scene.vessel.velocity is not None
    assert [row.velocity for row in scene.vessel.velocity] == [(2, 0, 0)]
    assert [row.rate for row in scene.payout.rate] == [-0.5]


def test_a_scene_cannot_be_changed() -> None:
    scene = cm.load_scene(minimal())
    with pytest.raises(ValueError, match="frozen"):
        scene.title = "other"  # type: ignore[misc]
    data = minimal() | {"environment": {"current": [1, 0, 0]}}
    current = cm.load_scene(data).environment.current
    assert current is not None
    with pytest.raises(ValueError, match="read-only"):
        current.velocity[0, 0, 0] = 2


def test_loading_leaves_the_given_data_alone() -> None:
    data = full()
    cm.load_scene(data, ["line.0.cable.length=11", "environment.waves=null"])
    assert data == full()


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e6", 1e6),
        ("1E6", 1e6),
        ("+1.e3", 1e3),
        (".5e2", 50),
        ("010", 10),
        ("30", 30),
        ("'30'", 30),
        ("30 m", 30),
        ("0.03 km", 30),
        ("1e3 mm", 1),
        ("6 ft", 1.8288),
        ("1 nmi", 1852),
    ],
)
def test_numbers_are_read_as_people_mean_them(text: str, value: float) -> None:
    scene = cm.load_scene(minimal(), [f"line.0.cable.length={text}"])
    assert scene.line_length == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("path", "text", "value"),
    [
        ("cable_types.K.axial_stiffness", "2 MN", 2e6),
        ("cable_types.K.bending_stiffness", "1 kN m2", 1e3),
        ("cable_types.K.bending_stiffness", "1 N*m^2", 1),
        ("cable_types.K.mass", "2 lb/ft", 2 * 0.45359237 / 0.3048),
        ("environment.water_density", "1.025 t/m3", 1025),
        ("environment.water_density", "1.025 g/cm**3", 1025),
        ("environment.gravity", "981 cm/s^2", 9.81),
        ("environment.floor", "{z: -1 km, friction: 30 %}", None),
        ("run.duration", "1 h", 3600),
    ],
)
def test_units_of_every_dimension_convert(path: str, text: str, value: float | None) -> None:
    scene: Any = cm.load_scene(minimal(), [f"{path}={text}"])
    if value is None:
        assert (scene.environment.floor.z, scene.environment.floor.friction) == (-1000, 0.3)
        return
    for part in path.split("."):
        scene = scene[part] if isinstance(scene, dict) else getattr(scene, part)
    assert scene == pytest.approx(value, rel=1e-12)


def test_tension_strain_coefficients_take_units() -> None:
    data = minimal()
    data["cable_types"]["K"] = {
        "diameter": 0.01,
        "mass": 0.1,
        "tension_strain": ["1 1/MN", "2 1/kN2"],
    }
    with pytest.raises(cm.SceneError):  # "1 1/MN" is two numbers
        cm.load_scene(data)
    data["cable_types"]["K"]["tension_strain"] = ["1 /MN", "2 /kN2"]
    coefficients = cm.load_scene(data).cable_types["K"].strain_coefficients
    assert coefficients == pytest.approx((1e-6, 2e-6))


def test_overrides_make_what_is_missing_and_keep_the_rest() -> None:
    data = minimal()
    changed = apply_overrides(
        data,
        [
            "line.0.cable.length=50",
            "environment.current.table=[{z: 0, velocity: [1, 0, 0]}]",
            "end={anchor: [1, 2, 3]}",
        ],
    )
    assert changed["line"][0]["cable"] == {"type": "K", "length": 50}
    assert changed["environment"]["current"]["table"][0]["velocity"] == [1, 0, 0]
    assert changed["end"] == {"anchor": [1, 2, 3]}
    assert data == minimal()


def test_overridden_scene_does_not_claim_the_text_as_its_source() -> None:
    path = SCENES[0]
    assert cm.load_scene(path, ["title=other"]).source_text is None
    assert cm.load_scene(path, ["title=other"]).title == "other"


@pytest.mark.parametrize(
    ("override", "path"),
    [
        ("line.1.cable.length=5", "line.1"),
        ("line.x=5", "line.x"),
        ("cable_types.K.mass.unit=5", "cable_types.K.mass.unit"),
        ("no value", ""),
        ("=5", ""),
        ("title=[", ""),
    ],
)
def test_overrides_that_have_no_place_are_refused(override: str, path: str) -> None:
    with pytest.raises(cm.SceneError) as caught:
        apply_overrides(minimal(), [override])
    assert caught.value.path == path


def test_merge_keys_and_anchors_work() -> None:
    scene = cm.load_scene(
        """
        cable_types:
          K: &K {diameter: 0.01, mass: 0.1, axial_stiffness: 1e6}
          heavy: &heavy {<<: *K, mass: 0.5}
          heavier: {<<: *heavy, mass: 0.9}
        line: [{cable: {type: heavy, length: 3}}]
        """
    )
    assert [kind.mass for kind in scene.cable_types.values()] == [0.1, 0.5, 0.9]
    assert scene.cable_types["heavier"].diameter == 0.01


def test_a_single_override_may_stand_alone() -> None:
    scene = cm.load_scene(minimal(), "line.0.cable.length=7")
    assert scene.line_length == 7.0


@pytest.mark.parametrize(
    ("overrides", "words"),
    [(5, "5 are no overrides"), ([5], "5 is no override"), ([("a", 1)], "is no override")],
)
def test_what_is_no_override_is_said(overrides: Any, words: str) -> None:
    with pytest.raises(cm.SceneError, match=words) as refused:
        cm.load_scene(minimal(), overrides)
    assert "allowed: texts" in str(refused.value)
