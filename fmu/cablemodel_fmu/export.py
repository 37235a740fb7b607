"""Pack a scene into an FMU: libraries, model, description, documentation. Needs no compiler."""

from __future__ import annotations

import hashlib
import os
import re
import time
import uuid
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import CableModelError, StaticsError
from cablemodel.scene import Scene
from cablemodel.solvers.direct.block import DirectBlock
from cablemodel.solvers.estimating import finer, step_in_halves
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start.frame import local
from cablemodel.solvers.finite_element.start.from_scene import build as build_block
from cablemodel.solvers.finite_element.start.scales import tension_scale
from cablemodel.solvers.finite_element.start.search import ITERATION
from cablemodel.solvers.finite_element.start.tables import facts_of
from cablemodel.solvers.finite_element.start.unstable_start import stays
from cablemodel.solvers.library import BINARIES, description, kernel_hash
from cablemodel.systems.lines import steady_velocity
from cablemodel.systems.model import SystemModel
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.tables import facts_of_system
from cablemodel_fmu.archive import write_archive
from cablemodel_fmu.description import INPUT_TIMING, VESSEL_INPUT, model_description
from cablemodel_fmu.documentation import (
    TOW_POINT,
    index_html,
    licences,
    osp_description,
    picture,
)
from cablemodel_fmu.model_file import ModelFile
from cablemodel_fmu.parts import coefficients as system_coefficients
from cablemodel_fmu.parts import (
    fastest_vessel,
    first_shape,
    is_movable,
    longest_arm,
    ports_of,
    section,
    signals_of,
)
from cablemodel_fmu.parts import lengths as system_lengths
from cablemodel_fmu.shared_numbers import VR_PARAMETER, VR_ZERO
from cablemodel_fmu.signals import (
    ROOM,
    Coefficient,
    Signal,
    coefficients,
    controls,
    inputs,
    is_level,
    is_settable,
    lengths,
    outputs,
    starts,
    with_nominals,
)
from cablemodel_fmu.system import export_system

DESKTOP = ("linux64", "win64", "darwin64")
"""What an FMU holds unless asked otherwise."""
# Importers on Linux on ARM look in linux64 too: an FMU is for one of the two.
_FOLDER = {name: name for name in DESKTOP} | {"aarch64-linux": "linux64"}
WHO_DRIVES = {
    "connected": "the scene's schedules drive what no input is set for",
    "scene": "the scene's schedules drive, inputs are ignored",
    "master": "inputs drive from the start",
}
"""What `use_scene_inputs` begins as, and what it means while it is true."""


class ExportError(CableModelError):
    """An FMU cannot be made as asked."""


@dataclass(frozen=True)
class Options:
    """What an FMU does where its master sets nothing, and what it says about itself.

    Raises:
        ExportError: a word that is not known.
    """

    stations: int = 11
    """Points along the cable whose position, tension and curvature are outputs: at least 2."""
    inputs: str = "connected"
    """One of WHO_DRIVES."""
    vessel_input: str = "velocity"
    """What `vessel.input` begins as: velocity, position, or position and velocity."""
    timing: str = "end"
    """What `input.timing` begins as: end, start."""
    author: str = ""

    def __post_init__(self) -> None:
        if not 2 <= self.stations <= 10000:
            raise ExportError(f"stations is {self.stations}: allowed are 2 to 10000")
        for name, value, allowed in (
            ("inputs", self.inputs, list(WHO_DRIVES)),
            ("vessel_input", self.vessel_input, [word for word, _ in VESSEL_INPUT]),
            ("timing", self.timing, [word for word, _ in INPUT_TIMING]),
        ):
            if value not in allowed:
                raise ExportError(f"{name} is {value!r}: allowed are {', '.join(allowed)}")

    def first_values(self, scene: Scene | SystemScene) -> tuple[bool, int, int]:
        """Start values of use_scene_inputs, vessel.input and input.timing."""
        scene_inputs = scheduled(scene) if self.inputs == "connected" else self.inputs == "scene"
        vessel = [word for word, _ in VESSEL_INPUT].index(self.vessel_input) + 1
        return scene_inputs, vessel, [word for word, _ in INPUT_TIMING].index(self.timing) + 1


@dataclass(frozen=True)
class Contents:
    """An FMU before it is packed."""

    name: str
    guid: str
    signals: list[Signal]
    model: bytes
    finer: bytes | None
    """The run by which errors are estimated, where the scene asks for that."""
    description: bytes
    start: SystemModel | None = None
    """Of a system: as it begins, for its picture."""


def export_fmu(
    scene: Scene | SystemScene,
    path: str | Path,
    *,
    platforms: Iterable[str] = DESKTOP,
    ssp: str | Path | None = None,
    progress: Callable[[str], None] = lambda line: None,
    **options: Any,
) -> Path:
    """Write the FMU of a scene or system, and its ports for the Open Simulation Platform beside it.

    Args:
        path: file to write, usually with the suffix .fmu.
        platforms: of linux64, win64, darwin64 (universal), or aarch64-linux alone.
        ssp: where to write a system of its vessels and this cable (SSP 1.0), if it is wanted.
        options: see Options.

    Its date is now, or that of the environment's SOURCE_DATE_EPOCH: with that, the same scene gives
    the same file.

    Raises:
        ExportError: unknown platforms or options, or too few stations.
        SceneError, StaticsError: as CableModel.
    """
    names = tuple(dict.fromkeys(platforms))
    unknown = [name for name in names if name not in _FOLDER]
    if unknown or not names:
        wanted = ", ".join(unknown) or "none"
        raise ExportError(f"platform {wanted}: there are {', '.join(_FOLDER)}")
    if len({_FOLDER[name] for name in names}) < len(names):
        raise ExportError(
            "linux64 and aarch64-linux share a folder in an FMU: export one for each of them"
        )
    if ssp is not None and isinstance(scene, SystemScene) and not scene.vessels:
        raise ExportError("ssp: the scene has no vessels to connect in a system of parts (SSP)")
    chosen = Options(**options)
    if ssp is not None and chosen.inputs == "scene":
        raise ExportError(
            "ssp: with inputs 'scene' the cable ignores the vessels it is connected to"
        )
    contents = contents_of(scene, chosen)
    libraries = _libraries(names, progress)
    target = Path(path)
    files = {
        "modelDescription.xml": contents.description,
        "model.png": picture(scene, contents.start),
        "resources/model.bin": contents.model,
        **({} if contents.finer is None else {"resources/finer.bin": contents.finer}),
        "resources/scene.yaml": scene.to_yaml().encode(),
        "documentation/index.html": index_html(scene, contents.signals).encode(),
        **{f"documentation/licenses/{name}": text for name, text in licences().items()},
        **libraries,
    }
    write_archive(target, files)
    ports = ports_of(scene) if isinstance(scene, SystemScene) else TOW_POINT
    ports_file(scene, target).write_bytes(osp_description(contents.signals, ports))
    if ssp is not None:
        libraries = _vessel_libraries(names)
        export_system(scene, target, Path(ssp), libraries, chosen.vessel_input)
    return target


def ports_file(scene: Scene | SystemScene, fmu: Path) -> Path:
    """Where the Open Simulation Platform looks for a model's ports: next to its FMU."""
    return fmu.with_name(f"{_model_name(scene)}_OspModelDescription.xml")


def _model_name(scene: Scene | SystemScene) -> str:
    """The scene's title as FMI allows it for a model."""
    return re.sub(r"\W+", "_", scene.title or "").strip("_") or "Cable"


def contents_of(scene: Scene | SystemScene, options: Options) -> Contents:
    """Model, variables and description of a scene's FMU."""
    if isinstance(scene, SystemScene):
        return _of_system(scene, options)
    return _of_line(scene, options)


def _of_line(scene: Scene, options: Options) -> Contents:
    block = block_of(scene)
    position, velocity, _ = scene.motion().evaluate(0.0)
    rate = float(scene.payout.rate[0].rate) if scene.payout.rate else 0.0
    first = [*map(float, velocity), *map(float, position), rate, 0.0, 0.0, 0.0]
    stations, values = options.stations, options.first_values(scene)
    in_elements = isinstance(block, Block)
    movable, level = in_elements and is_settable(scene), in_elements and is_level(scene)
    constants = _constants(scene, block)
    _check_room(constants)
    signals = [
        *controls(*values),
        *inputs(first),
        *(starts(first, movable=movable, level=level) if in_elements else []),
        *(item.signal for item in constants),
        *outputs(scene, block, stations),
    ]
    signals = with_nominals(signals, scene, tension_scale(scene), _fastest(scene))
    guid = _guid(scene, options)
    model = ModelFile(
        guid=guid,
        block=block,
        stations=stations,
        starts=first,
        frame=_frame(scene, block),
        facts=_facts(scene, block),
        coefficients=constants,
        scene_inputs=values[0],
        ignore=options.inputs == "scene",
        movable=movable,
        level=level,
        leaves=isinstance(block, Block) and not stays(block, scene),
        vessel_input=values[1],
        at_start=options.timing == "start",
        static=scene.initial.kind == "static",
        pinned=scene.vessel.connection.kind == "pinned",
        estimate=scene.solver.error_estimate,
    )
    description = "Ocean cable hung from a vessel"
    xml = _description(scene, options, guid, signals, description, derivatives=in_elements)
    beside = _beside(scene, model).to_bytes() if model.estimate else None
    return Contents(_model_name(scene), guid, signals, model.to_bytes(), beside, xml)


def _of_system(scene: SystemScene, options: Options) -> Contents:
    if scene.solver.method != "finite_element":
        raise ExportError(
            f"solver.method is {scene.solver.method!r}: a system is computed by finite_element"
        )
    start = SystemModel(scene)
    block = start.built.block
    values = options.first_values(scene)
    tension = float(block.scalars.tension_scale)
    speed = max(fastest_vessel(scene), _current_speed(scene))
    constants = system_coefficients(scene, start.built)
    constants += system_lengths(scene, start.built, len(constants))
    signals = signals_of(scene, options.stations, values, constants)
    signals = with_nominals(signals, scene, tension, speed, longest_arm(scene))
    guid = _guid(scene, options)
    shape, first = first_shape(scene)
    model = ModelFile(
        guid=guid,
        block=block,
        stations=options.stations,
        starts=[0.0] * 10,
        frame=steady_velocity(scene),
        facts=facts_of_system(scene),
        coefficients=constants,
        scene_inputs=values[0],
        ignore=options.inputs == "scene",
        movable=is_movable(scene),
        level=False,
        leaves=start.built.unstable,
        vessel_input=values[1],
        at_start=options.timing == "start",
        static=True,
        pinned=True,
        estimate=scene.solver.error_estimate,
        system=section(scene, start.built, values[1]),
        shape=shape,
        first=first,
        search=scene.solver.start_time_limit / ITERATION[1],
    )
    beside = _beside_system(start, model, values[1]) if model.estimate else None
    description = "Ocean cables between vessels and bodies"
    xml = _description(scene, options, guid, signals, description, derivatives=True)
    return Contents(_model_name(scene), guid, signals, model.to_bytes(), beside, xml, start)


def _check_room(constants: list[Coefficient]) -> None:
    if len(constants) > VR_ZERO - VR_PARAMETER:
        raise ExportError(
            f"the scene has {len(constants)} coefficients and lengths: an FMU has "
            f"{VR_ZERO - VR_PARAMETER} at most"
        )


def _guid(scene: Scene | SystemScene, options: Options) -> str:
    import cablemodel

    text = f"{scene.to_yaml()}\n{options}\n{kernel_hash()}\n{cablemodel.__version__}"
    return "{" + str(uuid.UUID(bytes=hashlib.sha256(text.encode()).digest()[:16])) + "}"


def _description(
    scene: Scene | SystemScene,
    options: Options,
    guid: str,
    signals: list[Signal],
    description: str,
    *,
    derivatives: bool,
) -> bytes:
    import cablemodel

    return model_description(
        name=_model_name(scene),
        guid=guid,
        description=f"{description}: {scene.title or 'untitled scene'}",
        version=cablemodel.__version__,
        signals=signals,
        step=scene.run.output_interval,
        stop=scene.run.duration,
        tolerance=scene.solver.tolerance,
        date=_date(),
        author=options.author,
        derivatives=derivatives,
    )


def _beside(scene: Scene, model: ModelFile) -> ModelFile:
    """Of the run that the errors of a scene's own are estimated by."""
    judge = finer(scene)
    try:
        block = build_block(judge, room=ROOM)
    except StaticsError as error:
        raise ExportError(
            f"solver.error_estimate: the run at a tolerance of {judge.solver.tolerance:g} that "
            f"errors are estimated by has no start: {error}"
        ) from error
    step_in_halves(block)
    return replace(
        model,
        block=block,
        frame=_frame(judge, block),
        facts=_facts(judge, block),
        coefficients=_constants(judge, block),
        estimate=False,
    )


def _beside_system(start: SystemModel, model: ModelFile, by: int) -> bytes:
    """The same of a system. by: what `NAME.input` begins as."""
    if start.finer is None:
        raise ExportError(
            "solver.error_estimate: the run at a quarter of the tolerance that errors are "
            "estimated by has no start"
        )
    built = start.finer.built
    shape, first = first_shape(built.scene)
    beside = replace(
        model,
        block=built.block,
        system=section(built.scene, built, by),
        estimate=False,
        shape=shape,
        first=first,
    )
    return beside.to_bytes()


def block_of(scene: Scene) -> Block | DirectBlock:
    """The scene's block at its initial state, of the solver that it asks for."""
    if scene.solver.method == "direct_integration":
        from cablemodel.solvers.direct.build import build as build_direct_block

        return build_direct_block(scene)
    return build_block(scene, room=ROOM)


def _constants(scene: Scene, block: Block | DirectBlock) -> list[Coefficient]:
    """Coefficients, and lengths where they may be set."""
    constants = coefficients(scene, block)
    if isinstance(block, Block):  # the direct solver's nodes are those of its lengths
        constants += lengths(scene, len(constants))
    return constants


def _frame(scene: Scene, block: Block | DirectBlock) -> NDArray[np.float64]:
    """Velocity of the static equilibrium in the block's coordinates [m/s]."""
    if scene.initial.kind == "static" and isinstance(block, Block):
        return local(block, scene.motion().evaluate(0.0)[1], point=False)
    return np.zeros(3)


def _facts(scene: Scene, block: Block | DirectBlock) -> NDArray[np.float64]:
    """What the kernels measure the line by; nothing for the direct solver."""
    if isinstance(block, Block):
        return facts_of(scene, tension_scale(scene))
    return np.zeros(0)


def _date() -> str:
    """Of the export; see export_fmu."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    seconds = time.time() if given is None else float(given)
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))


def _fastest(scene: Scene) -> float:
    """The largest speed in a scene, of vessel, current or pay-out [m/s]."""
    speeds = [float(np.linalg.norm(v)) for v in scene.motion().typical_velocities()]
    speeds.append(_current_speed(scene))
    speeds += [abs(row.rate) for row in scene.payout.rate]
    return max(speeds)


def _current_speed(scene: Scene | SystemScene) -> float:
    """The largest one of the current [m/s]."""
    current = scene.environment.current
    return 0.0 if current is None else float(np.max(np.linalg.norm(current.velocity, axis=-1)))


def scheduled(scene: Scene | SystemScene) -> bool:
    """Whether the scene says how a vessel moves or a drum turns."""
    if isinstance(scene, SystemScene):
        turns = any(row.rate != 0.0 for winch in scene.winches.values() for row in winch.rate)
        return turns or fastest_vessel(scene) > 0.0
    moves = len(scene.motion().pieces) > 1 or bool(np.any(scene.motion().evaluate(0.0)[1] != 0.0))
    return moves or any(row.rate != 0.0 for row in scene.payout.rate)


def _vessel_libraries(names: tuple[str, ...]) -> dict[str, bytes]:
    """Of the platforms, for its FMU; the cable's are there, and so are these."""
    found = {}
    for name in names:
        known = description(name)
        assert known is not None
        file = "vessel" + Path(known["file"]).suffix
        found[f"binaries/{_FOLDER[name]}/{file}"] = (BINARIES / name / file).read_bytes()
    return found


def _libraries(names: tuple[str, ...], progress: Callable[[str], None]) -> dict[str, bytes]:
    """The platforms' libraries; built here only in a source tree that has none that fit."""
    stale = [
        name
        for name in names
        if (found := description(name)) is None or found["kernels"] != kernel_hash()
    ]
    if stale:
        if find_spec("ziglang") is None:
            rest = ",".join(name for name in names if name not in stale)
            raise ExportError(
                f"there is no library for {', '.join(stale)} that fits the kernels: "
                "pip install 'cablemodel[fmu]' brings the compiler that makes them, once"
                + (f"; or leave them out: --platform {rest}" if rest else "")
            )
        try:
            from cablemodel_fmu.build import build

            build(stale, progress=progress)
        except (ImportError, RuntimeError) as error:
            raise ExportError(
                f"there is no library for {', '.join(stale)} that fits the kernels, and building "
                f"one failed: {error}"
            ) from error
    found_files = {}
    for name in names:
        found = description(name)
        assert found is not None
        data = (BINARIES / name / found["file"]).read_bytes()
        found_files[f"binaries/{_FOLDER[name]}/{found['file']}"] = data
    return found_files
