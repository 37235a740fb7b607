"""Whatever comes in, a scene loads or is refused with a SceneError; what loads, round-trips."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from scene_examples import full, minimal

import cablemodel as cm
from cablemodel.scene import apply_overrides

# The same examples every time: a check must not fail by chance in somebody else's work. To search
# anew, take derandomize out and raise max_examples (6,000 of each took five minutes, none failed).
patient = settings(
    max_examples=150,
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)

scalars = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.sampled_from(
        ["5 kg", "3 m", "1 / 0 m", "m", "1e6", "nan", "-inf", "1e400 m", "2 degC", "free", "1 m^9"]
    ),
    st.just(10**400),
    st.binary(max_size=5),
)
anything = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.text(max_size=8) | st.integers(), inner, max_size=4)
        | st.tuples(inner, inner)
    ),
    max_leaves=8,
)


def assert_loads_or_is_refused(source: Any) -> cm.Scene | None:
    try:
        scene = cm.load_scene(source)
    except cm.SceneError as error:
        str(error)  # the message must come out, whatever the value
        return None
    assert cm.load_scene(scene.to_dict()) == scene
    assert cm.load_scene(scene.to_yaml()) == scene
    scene.motion()
    return scene


def places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths of all values in plain data."""
    found = [path] if path else []
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in items:
        if isinstance(value, (dict, list)):
            found += places(value, (*path, key))
        else:
            found.append((*path, key))
    return found


@patient
@given(st.sampled_from(places(full())), anything)
def test_any_value_replaced_by_anything(place: tuple[Any, ...], value: Any) -> None:
    data: Any = copy.deepcopy(full())
    here = data
    for key in place[:-1]:
        here = here[key]
    here[place[-1]] = value
    assert_loads_or_is_refused(data)


@patient
@given(st.sampled_from(places(full())), st.text(max_size=8) | st.integers(), anything)
def test_any_mapping_with_anything_more(place: tuple[Any, ...], key: Any, value: Any) -> None:
    data: Any = copy.deepcopy(full())
    here = data
    for part in place:
        if isinstance(here[part], (dict, list)):
            here = here[part]
    if isinstance(here, dict):
        here[key] = value
    assert_loads_or_is_refused(data)


@patient
@given(st.dictionaries(st.sampled_from([*full(), "other"]), anything))
def test_anything_in_every_part(data: dict[str, Any]) -> None:
    assert_loads_or_is_refused(data)
    assert_loads_or_is_refused(minimal() | data)


@patient
@given(st.text(alphabet=st.sampled_from("ab{}[]:,-?&*!|>'\"%@`# \n\t0x"), max_size=40))
@example("a: 0x\n")
@example("\n=")
def test_any_text(text: str) -> None:
    assert_loads_or_is_refused("\n" + text)


@patient
@given(st.text(max_size=30))
def test_any_unit_text(text: str) -> None:
    data = minimal()
    data["line"][0]["cable"]["length"] = text
    assert_loads_or_is_refused(data)


@patient
@given(st.from_regex(r"[0-9]{1,3}\.?[0-9]{0,2} ?[a-zA-Zµ°%]{1,6}([*/ ][a-z]{1,3})?([\^]?-?[0-9])?"))
def test_any_quantity_text(text: str) -> None:
    data = minimal()
    data["line"][0]["cable"]["length"] = text
    assert_loads_or_is_refused(data)


@patient
@given(st.text(max_size=20), st.text(max_size=20))
def test_any_override(path: str, value: str) -> None:
    for override in (f"{path}={value}", f"line.0.cable.{path}={value}", path):
        try:
            apply_overrides(full(), [override])
        except cm.SceneError as error:
            str(error)


numbers = st.floats(1e-6, 1e6)
vectors = st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3)
directions = vectors.filter(lambda v: max(map(abs, v)) > 1e-3)


@st.composite
def scenes(draw: st.DrawFn) -> dict[str, Any]:
    """Scenes that must load."""
    kind = {"diameter": draw(numbers), "mass": draw(numbers)}
    if draw(st.booleans()):
        kind["axial_stiffness"] = draw(numbers)
    else:
        kind["tension_strain"] = [draw(numbers), *draw(st.lists(st.floats(-1, 1), max_size=4))]
    rows = draw(st.lists(st.tuples(numbers, vectors), min_size=1, max_size=6))
    time, velocity = draw(st.floats(-10, 10)), []
    for step, vector in rows:
        time += step
        velocity.append({"t": time, "velocity": vector})
    initial: Any = draw(st.just("static") | st.builds(lambda d: {"straight": d}, directions))
    return {
        "title": draw(st.text()),
        "cable_types": {draw(st.text(min_size=1).filter(str.isidentifier)): kind},
        "line": [],
        "initial": initial,
        "vessel": {
            "position": draw(vectors),
            "connection": draw(st.just("pinned") | st.builds(lambda d: {"clamped": d}, directions)),
            "velocity": velocity,
            "interpolation": draw(st.sampled_from(["linear", "cubic"])),
        },
        "environment": {
            "gravity": draw(st.floats(0, 100)),
            "water_density": draw(st.floats(0, 2000)),
            "current": draw(st.none() | vectors),
        },
    }


@patient
@given(scenes(), numbers)
def test_what_loads_round_trips_exactly(data: dict[str, Any], length: float) -> None:
    name = next(iter(data["cable_types"]))
    data["line"] = [{"cable": {"type": name, "length": length}}]
    scene = assert_loads_or_is_refused(data)
    if scene is None:
        pytest.fail("refused")
    assert scene.line_length == length
    assert scene.title == data["title"]
