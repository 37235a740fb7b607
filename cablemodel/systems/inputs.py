"""What drives a system's step: arguments by the user's names, and their words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel import variables
from cablemodel.errors import StepError
from cablemodel.solvers.shared import layout as at
from cablemodel.systems.scene import SystemScene

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class VesselInput:
    """Where a vessel or driven end is to be at the end of a step, how fast, or both.

    Attitudes are roll, pitch and yaw [rad], their rates [rad/s]. Of place and attitude, what is
    not given follows the scene.
    """

    position: ArrayLike | None = None
    velocity: ArrayLike | None = None
    attitude: ArrayLike | None = None
    attitude_rate: ArrayLike | None = None


class SystemInputs(TypedDict, total=False):
    """Arguments of a system's step. Each is the value reached at its end, from the present one."""

    vessels: Mapping[str, VesselInput] | None
    """Motion of vessels and driven ends by name; others follow the scene."""
    forces: Mapping[str, ArrayLike] | None
    """Outside force and torque about the origin of bodies by name, (6,) [N, N m], earth frame; a
    body that is not named has none."""
    deflections: Mapping[str, float] | None
    """Of foils, by ``BODY.FOIL`` [rad]; those not named stay."""
    rates: Mapping[str, float] | None
    """Of winches by name, positive out [m/s]; those not named follow the scene."""
    cuts: Iterable[str]
    """Names of those that are made now, at the beginning of the step; one may stand alone."""


def names_of(cuts: Iterable[str] | str | None) -> list[str]:
    """Names of cuts that a step is given: any number of them, or one by itself."""
    return [cuts] if isinstance(cuts, str) else list(cuts or ())


@dataclass(frozen=True)
class Drive:
    """The words of kernels/entry.drive."""

    motion: FloatArray
    forces: FloatArray
    angles: FloatArray
    rates: FloatArray
    orders: FloatArray

    @property
    def arrays(self) -> tuple[FloatArray, ...]:
        """In the order of the entry point."""
        return self.motion.ravel(), self.forces.ravel(), self.angles, self.rates, self.orders


class InputNames:
    """The inputs of a system by the names of its scene."""

    def __init__(self, scene: SystemScene) -> None:
        self._scene = scene
        self.foils = [
            f"{name}.{foil}" for name, body in scene.bodies.items() for foil in body.foils
        ]
        self.first_angles: FloatArray = np.array(
            [foil.deflection for body in scene.bodies.values() for foil in body.foils.values()]
        )

    def drive(self, given: SystemInputs, angles: FloatArray, time: float) -> Drive:
        """Words of a step. angles: present deflections; time: for messages [s].

        Raises:
            StepError: a name or a value is wrong.
        """
        scene = self._scene
        unknown = given.keys() - SystemInputs.__annotations__.keys()
        if unknown:
            raise TypeError(
                f"a step of a system takes {', '.join(SystemInputs.__annotations__)}, "
                f"not {', '.join(sorted(unknown))}"
            )
        table = _Table(time)
        motion = np.zeros((len(scene.vessels), at.FRAME_INPUTS))
        for number, name, wanted in table.rows("vessels", given.get("vessels"), scene.vessels):
            if not isinstance(wanted, VesselInput):
                allowed = "a VesselInput, as VesselInput(velocity=[2, 0, 0])"
                raise table.wrong(f"vessels[{name!r}]", wanted, allowed)
            row = motion[number]
            for key, bit in _GIVEN:
                value = getattr(wanted, key)
                if value is not None:
                    row[at.FrameInput.given] += bit
                    row[at.FrameInput.FIELDS[key].span] = table.vector(f"{name}.{key}", value, 3)
        forces = np.zeros((len(scene.bodies), 6))
        for number, name, value in table.rows("forces", given.get("forces"), scene.bodies):
            forces[number] = table.vector(f"forces.{name}", value, 6, ", a force and a torque")
        angles = angles.copy()
        for number, name, value in table.rows("deflections", given.get("deflections"), self.foils):
            angles[number] = table.vector(f"deflections.{name}", [value], 1)[0]
        rates = np.zeros((len(scene.winches), 2))
        for number, name, value in table.rows("rates", given.get("rates"), scene.winches):
            rates[number] = 1.0, table.vector(f"rates.{name}", [value], 1)[0]
        orders = np.zeros(len(scene.cuts))
        named = dict.fromkeys(names_of(given.get("cuts")), True)
        for number, _name, _value in table.rows("cuts", named, scene.cuts):
            orders[number] = 1.0
        return Drive(motion, forces, angles, rates.ravel(), orders)

    def row(self, given: Mapping[str, Any]) -> list[FloatArray]:
        """What was given, in the order of ``variables.input_labels``; NaN: nothing."""
        row = []
        for name, item in variables.inputs_of_system(self._scene):
            value = _value(given, name, item.python)
            row.append(np.full(max((1, *item.shape)), np.nan if value is None else value))
        return row

    def given_by(self, row: FloatArray) -> SystemInputs:
        """The arguments of a step that made such a row."""
        scene = self._scene
        vessels: dict[str, dict[str, FloatArray]] = {}
        forces: dict[str, FloatArray] = {}
        deflections: dict[str, float] = {}
        rates: dict[str, float] = {}
        cuts: list[str] = []
        place = 0
        for name, item in variables.inputs_of_system(scene):
            size = max((1, *item.shape))
            value, place = row[place : place + size], place + size
            if np.isnan(value).any():
                continue
            if name in scene.vessels:
                vessels.setdefault(name, {})[item.python] = value
            elif name in scene.bodies:
                forces.setdefault(name, np.zeros(6))[_HALVES[item.python]] = value
            elif name in scene.cuts:
                cuts.append(name)
            elif name in scene.winches:
                rates[name] = float(value[0])
            else:
                deflections[name] = float(value[0])
        return SystemInputs(
            vessels={name: VesselInput(**fields) for name, fields in vessels.items()},
            forces=forces,
            deflections=deflections,
            rates=rates,
            cuts=cuts,
        )


class _Table:
    """Reads mappings by name, with messages that name place and value."""

    def __init__(self, time: float) -> None:
        self._time = time

    def wrong(self, name: str, value: Any, allowed: str) -> StepError:
        return StepError(f"{name} is {value!r}", time=self._time, advice=f"give {allowed}")

    def rows(
        self, kind: str, given: Mapping[str, Any] | None, names: Iterable[str]
    ) -> list[tuple[int, str, Any]]:
        """Number, name and value of each that is given."""
        known = {name: number for number, name in enumerate(names)}
        found = []
        if given is not None and not isinstance(given, Mapping):
            raise self.wrong(kind, given, f"a mapping by the names of {', '.join(known) or 'none'}")
        for name, value in (given or {}).items():
            if name not in known:
                raise self.wrong(kind, name, f"one of {', '.join(known) or 'none'}")
            found.append((known[name], name, value))
        return found

    def vector(self, name: str, value: ArrayLike, size: int, what: str = "") -> FloatArray:
        """Finite numbers; what they are, in words."""
        try:
            vector = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            vector = np.empty(0)
        if vector.shape != (size,) or not np.isfinite(vector).all():
            raise self.wrong(name, value, f"{size} finite numbers{what}")
        return vector


def motion_given(row: FloatArray) -> dict[str, FloatArray]:
    """The fields of VesselInput that made a frame's words of `Drive.motion`."""
    return {
        key: row[at.FrameInput.FIELDS[key].span].copy()
        for key, bit in _GIVEN
        if int(row[at.FrameInput.given]) & bit
    }


def _value(given: Mapping[str, Any], name: str, field: str) -> Any:
    """The value of one input among the arguments of a step; None: not given."""
    if field == "cut":
        return 1.0 if name in (given.get("cuts") or ()) else None
    if field in _NAMED:
        return (given.get(_NAMED[field]) or {}).get(name)
    if field in _HALVES:
        wrench = (given.get("forces") or {}).get(name)
        return None if wrench is None else np.asarray(wrench, float)[_HALVES[field]]
    wanted = (given.get("vessels") or {}).get(name)
    return None if wanted is None else getattr(wanted, field)


_GIVEN = (
    ("position", at.GIVEN_POSITION),
    ("attitude", at.GIVEN_ATTITUDE),
    ("velocity", at.GIVEN_VELOCITY),
    ("attitude_rate", at.GIVEN_RATE),
)
"""Fields of VesselInput and of FrameInput, and their bits."""

_HALVES = {"force": slice(0, 3), "torque": slice(3, 6)}
_NAMED = {"deflection": "deflections", "rate": "rates"}
"""Arguments of a step by the field of an input that has a number for each name."""
