"""Numbers, vectors and directions of a scene: read with or without a unit, kept in SI.

The classes here stand in ``Annotated`` types of the schema, for example
``Annotated[float, Quantity("m", above=0)]``. They do the whole validation themselves, so that one
place decides what is a number and how a refusal is worded.
"""

from __future__ import annotations

import hashlib
import math
import platform
import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import chain
from numbers import Integral, Real
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from cablemodel.cache import cache_root
from cablemodel.errors import SceneError, SceneProblem, shown

if TYPE_CHECKING:
    from pint import UnitRegistry

FloatArray = NDArray[np.float64]

_NUMBER = r"[-+]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_FACTOR = r"(?:[A-Za-z_µμΩ°%]+)(?:\s*(?:\*\*|\^)?\s*-?[1-9])?"
_QUANTITY = re.compile(
    rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>(?:/\s*)?{_FACTOR}(?:\s*[*/·]?\s*{_FACTOR})*)\s*"
)
_EXPONENT = re.compile(r"(?<=[A-Za-z_µμΩ°%])\s*(?:\*\*|\^)?\s*(-?[1-9])")
_LONGEST_TEXT = 80
_SLIPS = {
    ("m", "s"): "m is the metre, min the minute",
    ("kn", "N"): "kn is the knot, kN the kilonewton",
    ("kN", "m/s"): "kN is the kilonewton, kn the knot",
    ("kg", "N"): "kg is a mass; kgf is its weight",
    ("t", "N"): "t is a mass; tf is its weight",
    ("N", "kg"): "N is a force; kg is a mass",
    ("kN", "kg"): "kN is a force; kg is a mass",
    ("N/m", "kg/m"): "N/m is a weight; kg/m is a mass",
}
"""What is often taken for another unit: by the one given and the one asked for."""

# Numbers outside this range overflow in a product or quotient of a few; no cable has them.
_LARGEST = 1e30
_SMALLEST = 1e-30


def rejection(
    problem: str, allowed: str, value: Any = None, at: tuple[str | int, ...] = ()
) -> PydanticCustomError:
    """The error that a validator raises; `cablemodel.scene.problems` turns it into a SceneError.

    ``at`` is the place below the validated value; ``value`` is what stands there.
    """
    context = {"problem": problem, "allowed": allowed, "value": value, "at": at}
    return PydanticCustomError("scene", "not allowed", context)


def not_one_of(mapping: Any, one: str, other: str) -> PydanticCustomError:
    """As `rejection`, where neither of two keys is given, or both are."""
    neither = getattr(mapping, one) is None
    problem = f"neither {one} nor {other} is" if neither else f"both {one} and {other} are"
    return rejection(f"{problem} given", f"either {one} or {other}")


def several(problems: list[SceneProblem]) -> PydanticCustomError:
    """As `rejection`, for problems that stand in different places of the scene."""
    return PydanticCustomError("scenes", "not allowed", {"problems": problems})


def plain_unit(unit: str) -> str:
    """A unit as naval architects write it: ``N m2`` for ``N*m**2``."""
    return unit.replace("**", "").replace("*", " ")


@dataclass(frozen=True)
class Quantity:
    """A finite number with a unit and bounds; text with a unit is converted to ``unit``."""

    unit: str = ""
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None

    def __call__(self, value: Any) -> float:
        """The number in ``unit``, or a rejection."""
        number = self._number(value)
        if not math.isfinite(number):
            raise rejection(f"{shown(value)} is not a finite number", self.allowed, value)
        if abs(number) > _LARGEST or (self.above == 0 and 0 < number < _SMALLEST):
            problem = f"{shown(value)} is beyond all reason"
            raise rejection(problem, self.allowed, value)
        if (
            (self.above is not None and not number > self.above)
            or (self.at_least is not None and not number >= self.at_least)
            or (self.below is not None and not number < self.below)
            or (self.at_most is not None and not number <= self.at_most)
        ):
            raise rejection(f"{shown(value)} is out of range", self.allowed, value)
        return number

    def column(self, values: Sequence[Any]) -> FloatArray | None:
        """Many values at once, (n,): None where one is no plain number, or not allowed."""
        if not set(map(type, values)) <= {float, int}:
            return None
        try:
            numbers = np.array(values, dtype=np.float64)
        except OverflowError:
            return None
        wrong = ~(np.abs(numbers) <= _LARGEST)  # NaN, too
        if self.above is not None:
            wrong |= ~(numbers > self.above)
        if self.above == 0:
            wrong |= numbers < _SMALLEST
        if self.at_least is not None:
            wrong |= ~(numbers >= self.at_least)
        if self.below is not None:
            wrong |= ~(numbers < self.below)
        if self.at_most is not None:
            wrong |= ~(numbers <= self.at_most)
        return None if wrong.any() else numbers

    @property
    def allowed(self) -> str:
        """What may stand here, in words."""
        bounds = [
            f"{word} {bound:g}"
            for word, bound in (
                ("above", self.above),
                ("at least", self.at_least),
                ("below", self.below),
                ("at most", self.at_most),
            )
            if bound is not None
        ]
        limits = (" " + " and ".join(bounds)) if bounds else ""
        unit = f" in {plain_unit(self.unit)}, or text with a unit" if self.unit else ""
        return f"a number{limits}{unit}"

    def _number(self, value: Any) -> float:
        if isinstance(value, bool):
            raise rejection(f"{shown(value)} is not a number", self.allowed, value)
        if isinstance(value, Real):
            try:
                return float(value)
            except (OverflowError, ValueError, TypeError):
                problem = f"{shown(value)} is not a finite number"
                raise rejection(problem, self.allowed, value) from None
        if isinstance(value, str):
            return self._parsed(value)
        raise rejection(f"{shown(value)} is not a number", self.allowed, value)

    def _parsed(self, text: str) -> float:
        try:
            return float(text)
        except ValueError:
            pass
        # The grammar keeps arithmetic away from pint: "9**9**9**9 m" would compute for ever.
        match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST_TEXT else None
        if match is None:
            raise rejection(f"{shown(text)} is not a number with a unit", self.allowed, text)
        return self._converted(text, float(match["number"]), match["unit"])

    def _converted(self, text: str, number: float, unit: str) -> float:
        from pint.errors import PintError

        units = _registry()
        spelled = _EXPONENT.sub(r"**\1", unit.replace("·", "*"))
        if spelled.startswith("/"):
            spelled = "1" + spelled
        try:
            given = units.parse_units(spelled)
        except (PintError, ValueError, TypeError, KeyError):
            problem = f"{shown(text)}: unknown unit {shown(unit)}"
            raise rejection(problem, self.allowed, text) from None
        try:
            converted = units.Quantity(number, given).to(self.unit or "dimensionless").magnitude
        except (PintError, ArithmeticError, KeyError):
            target = plain_unit(self.unit) or "a plain number"
            hint = _SLIPS.get((unit, self.unit), "")
            problem = f"{shown(text)} cannot be converted to {target}{hint and ': '}{hint}"
            raise rejection(problem, self.allowed, text) from None
        return float(converted)

    def number_schema(self) -> dict[str, Any]:
        """JSON schema of the plain number."""
        bounds = {
            "exclusiveMinimum": self.above,
            "minimum": self.at_least,
            "exclusiveMaximum": self.below,
            "maximum": self.at_most,
        }
        given = {keyword: bound for keyword, bound in bounds.items() if bound is not None}
        return {"type": "number", **given}

    def json_schema(self) -> dict[str, Any]:
        """JSON schema: a number, or text with a unit."""
        schema: dict[str, Any] = {"anyOf": [self.number_schema(), {"type": "string"}]}
        if self.unit:
            schema["unit"] = plain_unit(self.unit)
        return schema

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return _plain(self)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return self.json_schema()


def seconds(name: str, value: Any) -> float:
    """A time above 0 [s] that an argument gives, as a scene would: a number, or text with a unit.

    Raises:
        SceneError: something else; it is a ValueError.
    """
    try:
        return Quantity("s", above=0)(value)
    except PydanticCustomError as error:
        context = error.context or {}
        raise SceneError.at(name, value, context["problem"], context["allowed"]) from None


@dataclass(frozen=True)
class Count:
    """A whole number within bounds."""

    at_least: int
    at_most: int

    def __call__(self, value: Any) -> int:
        """The number, or a rejection."""
        if isinstance(value, bool) or not isinstance(value, (Integral, float)) or value % 1 != 0:
            raise rejection(f"{shown(value)} is not a whole number", self.allowed, value)
        number = int(value)
        if not self.at_least <= number <= self.at_most:
            raise rejection(f"{shown(value)} is out of range", self.allowed, value)
        return number

    @property
    def allowed(self) -> str:
        """What may stand here, in words."""
        return f"a whole number from {self.at_least} to {self.at_most}"

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return _plain(self)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"type": "integer", "minimum": self.at_least, "maximum": self.at_most}


@dataclass(frozen=True)
class Vector:
    """A few numbers of one unit, such as a position [x, y, z]."""

    unit: str = ""
    components: str = "xyz"

    def __call__(self, value: Any) -> tuple[float, ...]:
        """The components in ``unit``, or a rejection that names the component."""
        numbers = _items(value)
        if numbers is None or len(numbers) != len(self.components):
            problem = f"{shown(value)} is not a list of {len(self.components)} numbers"
            raise rejection(problem, self.allowed, value)
        quantity = Quantity(self.unit)
        vector = []
        for index, number in enumerate(numbers):
            try:
                vector.append(quantity(number))
            except PydanticCustomError as error:
                context = error.context or {}
                problem, allowed = context["problem"], context["allowed"]
                raise rejection(problem, allowed, number, (index,)) from None
        return tuple(vector)

    def column(self, values: Sequence[Any]) -> FloatArray | None:
        """Many vectors at once, (n, k): None where one has no plain numbers, or is not allowed."""
        size = len(self.components)
        if not set(map(type, values)) <= {list, tuple} or not set(map(len, values)) <= {size}:
            return None
        numbers = Quantity(self.unit).column(list(chain.from_iterable(values)))
        return None if numbers is None else numbers.reshape(-1, size)

    @property
    def allowed(self) -> str:
        """What may stand here, in words."""
        unit = f" in {plain_unit(self.unit)}" if self.unit else ""
        return f"a list of numbers [{', '.join(self.components)}]{unit}"

    def json_schema(self) -> dict[str, Any]:
        """JSON schema: a list of numbers."""
        size = len(self.components)
        items = {"anyOf": [{"type": "number"}, {"type": "string"}]}
        schema: dict[str, Any] = {
            "type": "array",
            "items": items if self.unit else {"type": "number"},
            "minItems": size,
            "maxItems": size,
        }
        if self.unit:
            schema["unit"] = plain_unit(self.unit)
        return schema

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return _plain(self)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return self.json_schema()


@dataclass(frozen=True)
class Direction(Vector):
    """A vector whose length does not matter; kept with unit length."""

    def __call__(self, value: Any) -> tuple[float, ...]:
        """The unit vector, or a rejection."""
        vector = super().__call__(value)
        largest = max(abs(component) for component in vector)
        if largest == 0.0:
            raise rejection("a direction cannot be zero", self.allowed, value)
        length = math.hypot(*vector)
        # A unit vector stays as it is to the last bit: a scene written and read again is the same.
        if abs(length - 1.0) <= 1e-15:
            return vector
        scaled = [component / largest for component in vector]
        length = math.hypot(*scaled)
        return tuple(component / length for component in scaled)

    def column(self, values: Sequence[Any]) -> FloatArray | None:
        """None: they are scaled one by one."""
        return None

    @property
    def allowed(self) -> str:
        """What may stand here, in words."""
        return "a direction [x, y, z], not zero"


def _items(value: Any) -> list[Any] | None:
    """The items of a list-like value (list, tuple, one-dimensional array); None for others."""
    if hasattr(value, "tolist") and not isinstance(value, (str, bytes, Mapping)):
        value = value.tolist()
    return list(value) if isinstance(value, (list, tuple)) else None


def _plain(validate: Callable[[Any], Any]) -> CoreSchema:
    return core_schema.no_info_plain_validator_function(validate)


@cache
def _registry() -> UnitRegistry[Any]:
    """Pint's registry: half a second, so only for scenes that spell units."""
    import pint

    # Pint keeps the place of its own files, and names what it keeps by Python's patch version.
    made_by = f"{pint.__version__} {pint.__file__} {platform.python_version()}"
    name = hashlib.sha256(made_by.encode()).hexdigest()[:16]
    units = kept_registry(cache_root() / f"pint-{name}")
    if "kn" not in units:  # pint before 0.25 knows only knot and kt
        units.define("@alias knot = kn")
    if "te" not in units:
        units.define("@alias tonne = te")  # as OrcaFlex writes it
    return units


def kept_registry(folder: Path) -> UnitRegistry[Any]:
    """The registry from what pint keeps of it in a folder, a tenth of the time; made when missing.

    Pint writes its files in place, where another process may read them half done: they are made
    beside the folder, which then appears as a whole. What cannot be read is made anew; where
    nothing can be written, nothing is kept.
    """
    import pint

    if folder.is_dir():
        with suppress(Exception):  # spoilt files raise whatever they like
            return pint.UnitRegistry(cache_folder=folder)
        shutil.rmtree(folder, ignore_errors=True)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=folder.parent, ignore_cleanup_errors=True) as own:
            made = Path(own) / folder.name
            made.mkdir()
            units: UnitRegistry[Any] = pint.UnitRegistry(cache_folder=made)
            with suppress(OSError):  # another process was first
                made.rename(folder)
        return units
    except OSError:
        return pint.UnitRegistry()
