"""Scenes with long tables: written as JSON, read as a whole, no row one by one."""

from __future__ import annotations

import gc
import itertools
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from pydantic_core import PydanticCustomError

import cablemodel as cm
from cablemodel.scene import text
from cablemodel.scene.text import LONG_TABLE, SceneDumper, SceneLoader, parse_yaml
from cablemodel.scene.units import Quantity, Vector

ROWS = 2 * LONG_TABLE
SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.yaml"))


def table(rows: int) -> list[dict[str, Any]]:
    way = np.random.default_rng(3).normal(size=(rows, 3)) * 0.1
    return [{"t": 0.1 * n, "velocity": row} for n, row in enumerate(way.tolist())]


def scene_of(rows: Any) -> dict[str, Any]:
    return {
        "title": 'A "long" table: å, \\, #',
        "cable_types": {"c": {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 5e6}},
        "line": [{"cable": {"type": "c", "length": 20.0}}],
        "vessel": {"velocity": rows},
        "run": {"duration": 1.0, "output_interval": 0.5},
    }


def as_before(scene: cm.Scene) -> str:
    return yaml.dump(scene.to_dict(), Dumper=SceneDumper, sort_keys=False, default_flow_style=None)


def test_scenes_without_long_tables_are_written_as_before() -> None:
    scenes = [cm.load_scene(path) for path in SCENES]
    scenes.append(cm.load_scene(scene_of(table(LONG_TABLE))))
    for scene in scenes:
        assert scene.to_yaml() == as_before(scene)
        assert not scene.to_yaml().startswith("{")


def test_a_long_table_is_json_which_yaml_reads_as_the_same() -> None:
    scene = cm.load_scene(scene_of(table(LONG_TABLE + 1)))
    written = scene.to_yaml()
    assert json.loads(written) == scene.to_dict()
    assert yaml.load(written, Loader=SceneLoader) == scene.to_dict()
    assert cm.load_scene(written) == scene
    assert cm.load_scene(written).title == scene_of([])["title"]


def test_neither_yaml_nor_rows_one_by_one(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """From a file of values to the log of a run, and back."""
    lines = [",".join(map(repr, [row["t"], *row["velocity"]])) for row in table(ROWS)]
    (tmp_path / "motion.csv").write_text("\n".join(["t,vx,vy,vz", *lines]))
    scene = cm.load_scene(scene_of({"file": "motion.csv"}), folder=tmp_path)
    assert scene.to_dict()["vessel"]["velocity"] == table(ROWS)

    def never(*_: Any, **__: Any) -> Any:
        raise AssertionError("YAML takes minutes")

    asked = []
    number = Quantity.__call__

    def counted(self: Quantity, value: Any) -> float:
        asked.append(value)
        return number(self, value)

    monkeypatch.setattr(text.yaml, "dump", never)
    monkeypatch.setattr(text, "SceneLoader", never)
    monkeypatch.setattr(Quantity, "__call__", counted)
    log = tmp_path / "run.mcap"
    ran = cm.simulate(scene, log=log)
    found = cm.open_run(log)
    assert found.scene == scene
    np.testing.assert_array_equal(found.top_tension, ran.top_tension)
    assert cm.load_scene(scene.to_yaml()) == scene
    assert 0 < len(asked) < ROWS


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"velocity": [0.0, "fast", 0.0]}, r"vessel\.velocity\.1500\.velocity\.1.*'fast'"),
        ({"velocity": [0.0, 0.0]}, r"vessel\.velocity\.1500\.velocity.*3 numbers"),
        ({"velocity": [0.0, math.nan, 0.0]}, r"vessel\.velocity\.1500\.velocity\.1.*not a finite"),
        ({"t": True}, r"vessel\.velocity\.1500\.t.*not a number"),
        ({"t": 10**400}, r"vessel\.velocity\.1500\.t.*not a finite"),
        ({"t": None}, r"vessel\.velocity\.1500\.t"),
        ({"speed": 1.0}, r"vessel\.velocity\.1500\.speed"),
        ({"t": 1.0}, r"vessel\.velocity\.1500\.t: out of order"),
    ],
)
def test_what_is_wrong_in_a_long_table_is_named(change: dict[str, Any], words: str) -> None:
    rows = table(ROWS)
    rows[1500] |= change
    with pytest.raises(cm.SceneError) as refused:
        cm.load_scene(scene_of(rows))
    assert len(refused.value.problems) == 1
    assert re.search(words, str(refused.value)), refused.value


def test_units_and_short_forms_in_a_long_table_are_read() -> None:
    rows = table(ROWS)
    expected = cm.load_scene(scene_of(rows)).to_dict()
    rows[7]["t"] = f"{rows[7]['t'] * 1000!r} ms"
    rows[8]["velocity"] = np.array(rows[8]["velocity"])
    rows[9]["velocity"] = tuple(rows[9]["velocity"])
    found = cm.load_scene(scene_of(rows)).to_dict()
    assert found["vessel"]["velocity"][8:] == expected["vessel"]["velocity"][8:]
    assert found["vessel"]["velocity"][7]["t"] == pytest.approx(0.7)


BOUNDS = [{}, {"above": 0}, {"at_least": 0}, {"below": 1.0}, {"at_most": 1.0}, {"above": -1.0}]
VALUES = [
    0, 0.0, -0.0, 1, 1.0, -1, -1.0, 0.5, 1e-31, 1e-30, -1e-31, 1e30, 1.1e30, -1.1e30, 2**70,
    10**400, math.inf, -math.inf, math.nan, True, None, "1", "1 m", [1.0], np.float64(0.5),
]  # fmt: skip


@pytest.mark.parametrize("bounds", BOUNDS)
def test_a_column_takes_what_is_taken_one_by_one(bounds: dict[str, float]) -> None:
    """And nothing else; what it leaves to the other may be text with a unit."""
    rule = Quantity("m", **bounds)
    taken = 0
    for value in VALUES:
        try:
            alone: float | None = rule(value)
        except PydanticCustomError:
            alone = None
        column = rule.column([0.75, value])
        if column is not None:
            taken += 1
            assert column.tolist() == [0.75, alone]
        elif alone is not None:
            assert type(value) not in (int, float)
    assert taken > 2


def test_vectors_in_a_column() -> None:
    rule = Vector("m/s")
    good = [[1.0, 2, 3.0], (4.0, 5.0, 6.0)]
    found = rule.column(good)
    assert found is not None
    assert found.tolist() == [list(rule(value)) for value in good]
    for bad in ([1.0, 2.0], [1.0, 2.0, True], [1.0, 2.0, math.nan], "abc", 3.0, [[1], [2], [3]]):
        assert rule.column([*good, bad]) is None


TEXTS = [
    "{}", '{"a": 1}', "{a: 1}", '{"a": 1,}', '{"a": [1, 2.5, -3e5, 1E400, -0, 1e-7]}',
    '{"a": NaN}', '{"a": Infinity}', '{"a": -Infinity}', '{"a": null, "b": true, "c": false}',
    '{"a": 1, "a": 2}', '{"a": {"b": 1, "b": 2}}',
    f'{{"a": {"9" * 301}}}', f'{{"a": {"9" * 5000}}}',
    '{"a": "\\u00e5 \\n \\\\ \\" #"}', '{"<<": {"b": 1}}', '{"a": "1e6", "b": "yes", "c": "012"}',
    '{"a": 1} # comment', '{"a": 1}\n{"b": 2}', '{"a": [1, 2}', "{" * 3000, '{"a": ' * 3000,
    '{"1": 2}', '{"a": .5}', '{"a": +1}', '{"a": 012}', '{"a": 1_000}', '{"": 1}', "{",
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(TEXTS)))
def test_json_means_what_it_means_as_yaml(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def meaning(given: str | bytes) -> str:
        try:
            return repr(parse_yaml(given))
        except cm.SceneError as error:
            return str(error)

    given = TEXTS[number]
    found = [meaning(given), meaning(given.encode())]

    def refuse(_: Any) -> Any:
        raise ValueError

    monkeypatch.setattr(text, "_parse_json", refuse)
    assert found == [meaning(given), meaning(given.encode())]


def test_garbage_collection_is_as_it_was() -> None:
    for wanted, given in itertools.product((True, False), ('{"a": 1}', '{"a": 1')):
        (gc.enable if wanted else gc.disable)()
        try:
            try:
                parse_yaml(given)
            except cm.SceneError:
                assert given == '{"a": 1'
            assert gc.isenabled() == wanted
        finally:
            gc.enable()
