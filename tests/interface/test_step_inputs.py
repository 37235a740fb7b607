"""What a step takes: numbers of any kind, and neither text nor truths."""

from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cablemodel as cm

SCENE = Path(__file__).parents[2] / "scenes" / "towed_cable.yaml"


@pytest.fixture(scope="module")
def model() -> cm.CableModel:
    return cm.CableModel(SCENE)


@pytest.mark.parametrize("value", [True, "0.2", b"1", np.True_, np.str_("1"), "3 m/s", [1.0]])
def test_text_and_truths_are_no_numbers(model: cm.CableModel, value: Any) -> None:
    before = model.snapshot()
    with pytest.raises(cm.StepError, match=r"dt is .*, not a number; give a number"):
        model.step(value)
    with pytest.raises(cm.StepError, match=r"time is .*, not a number; give a number"):
        model.step_to(value)
    with pytest.raises(cm.StepError, match=r"payout_rate is .*, not a number; give a number"):
        model.step(0.1, payout_rate=value)
    assert model.snapshot() == before


@pytest.mark.parametrize(
    "value",
    [
        "3 m/s",
        ("1", "0", "0"),
        [1.0, "0", 0],
        (True, 0.0, 0.0),
        [True, False, False],
        np.array([True, False, False]),
        np.array(["1", "0", "0"]),
        np.array(["1", 0, 0], dtype=object),
        (1j, 0, 0),
        0.5,
        (0.0, 0.0),
        {"x": 1.0},
    ],
)
@pytest.mark.parametrize("name", ["vessel_velocity", "vessel_position", "current"])
def test_text_and_truths_are_no_vectors(model: cm.CableModel, name: str, value: Any) -> None:
    before = model.snapshot()
    with pytest.raises(cm.StepError, match=f"{name} is .*; give three numbers"):
        model.step(0.1, **{name: value})
    assert model.snapshot() == before


def test_numbers_of_any_kind_are_the_same(model: cm.CableModel) -> None:
    start = model.snapshot()
    found = []
    for vector, number in (
        ((1.0, 0.0, 0.0), 0.5),
        ([1, 0, 0], np.float32(0.5)),
        (np.array([1, 0, 0]), np.float64(0.5)),
        (np.array([1, 0, 0], dtype=np.float32), Decimal("0.5")),
        (np.array([1.0, 0.0, 0.0]), 0.5),
        ((Decimal(1), 0, 0), np.array(0.5)),
    ):
        model.restore(start)
        model.step(number, vessel_velocity=vector)  # type: ignore[arg-type]
        found.append(model.snapshot())
    assert all(each == found[0] for each in found)
