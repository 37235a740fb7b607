"""A parameter sweep: one scene simulated for every combination of some of its values.

The runs are spread over processes by dask.distributed, on this machine or on a cluster. A run that
fails is a row of the result like any other, with the error's text.
"""

from __future__ import annotations

import copy
import hashlib
import itertools
import json
import logging
import math
import os
import re
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cablemodel import variables
from cablemodel.errors import CableModelError, ConvergenceError, SceneError, shown
from cablemodel.extras import require

if TYPE_CHECKING:
    import pandas
    import xarray
    from distributed import Client

    from cablemodel.results.run import Run
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemScene

MOST_POINTS = 1_000_000
"""Combinations at most: more are a slip in a count."""
PROBES = 32
"""Runs that are tasks of their own, and say how many go together after them."""
TOGETHER, MOST_TOGETHER = 0.5, 32
"""For how long a task may take [s], by those; and how many runs it may be."""
PAUSE = 0.02
"""Between two looks for runs that have ended [s]."""
RESULTS = {
    "time": "end of the run [s]",
    "top_tension": "top tension at the end [N]",
    "highest_tension": "highest tension of the run [N]",
    "lowest_tension": "lowest tension of the run [N]",
    "slack_time": "time for which some of the cable was slack [s]",
    "max_curvature": "largest curvature of the run [1/m]",
    "tip_x": "x of the far end at the end [m]",
    "tip_y": "y of the far end at the end [m]",
    "tip_z": "z of the far end at the end [m]",
    "line_length": "cable out at the end [m]",
    "wall_time": "computing time [s]",
    "steps": "steps",
    "elements": "elements",
    "tolerance": "tolerance",
    "error_share": "estimated error, of what is allowed",
}
"""Columns of a result, after those of the values swept over, and what they are; ``error`` is the
last. See `results_of`."""
_ONE_LINE = ("top_tension", "slack_time", "tip_x", "tip_y", "tip_z", "line_length")
"""Those that a system has not."""
_OF_PARTS: tuple[tuple[str, tuple[variables.Variable, ...], dict[str, str]], ...] = (
    ("lines", variables.LINE_OUTPUTS, {
        "start_tension": "at the end", "end_tension": "at the end",
        "tension_min": "of the run", "tension_max": "of the run",
        "slack_time": "at the end",
    }),
    ("bodies", variables.BODY_OUTPUTS, {"position": "at the end", "attitude": "at the end"}),
    ("vessels", variables.VESSEL_OUTPUTS, {"force": "at the end", "moment": "at the end"}),
)  # fmt: skip
"""What a system has instead: kind of its parts, and the outputs and when, as `Run.summary`."""

_NUMBER = (
    r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    r"\s*(?P<unit>[^\d\s:,\[\]{}\"'][^:]*?)?\s*"
)
_RANGE = re.compile(r"\s*\d[\d.]*(?:\s*(?:-|to|\.\.)|[^:]*:)\s*\d[\d.]*\s*[A-Za-z/]*\s*")
"""A range without a count."""


@dataclass(frozen=True)
class Axis:
    """A value of the scene, and what it is to be."""

    path: str
    """Its place: ``cable_types.K.diameter``."""
    values: tuple[Any, ...]
    """As YAML would give them, without the unit."""
    unit: str = ""
    """That of all values; empty: SI, or no numbers."""

    @property
    def column(self) -> str:
        """Its column in the table of results."""
        return f"{self.path} [{self.unit}]" if self.unit else self.path

    def override(self, value: Any) -> str:
        """The value put in place, as `load_scene` takes it."""
        given = f"{value!r} {self.unit}" if self.unit else value
        return f"{self.path}={json.dumps(given)}"

    @classmethod
    def parse(cls, text: str) -> Axis:
        """``path=start:stop:count`` (both ends included) or ``path=value,value,...``.

        Numbers may have a unit, one for the whole axis: ``10 mm:30 mm:5``.

        Raises:
            SceneError: neither of the two.
        """
        path, equals, given = text.partition("=")
        allowed = "path=start:stop:count or path=value,value,..."
        if not equals or not path.strip() or not given.strip():
            raise SceneError.at("", text, f"{shown(text)} is nothing to sweep over", allowed)
        path = path.strip()
        parts = given.split(":")
        if len(parts) == 3 and all(re.fullmatch(_NUMBER, part) for part in parts[:2]):
            return cls._range(path, *parts)
        from cablemodel.scene.text import parse_yaml

        values = parse_yaml(f"[{given}]", source=text)
        for value in values:
            if isinstance(value, str) and _RANGE.fullmatch(value):
                raise SceneError.at(path, value, f"{shown(value)} says not how many", allowed)
        numbers = [re.fullmatch(_NUMBER, v) if isinstance(v, str) else None for v in values]
        units = {match["unit"] for match in numbers if match}
        if all(numbers) and len(units) == 1 and None not in units:
            return cls(path, tuple(float(m["number"]) for m in numbers if m), units.pop())
        return cls(path, tuple(values))

    @classmethod
    def _range(cls, path: str, start: str, stop: str, count: str) -> Axis:
        first, last = re.fullmatch(_NUMBER, start), re.fullmatch(_NUMBER, stop)
        assert first is not None  # the caller has looked
        assert last is not None
        if (first["unit"] or "") != (last["unit"] or ""):
            problem = f"{start.strip()} and {stop.strip()} have not the same unit"
            raise SceneError.at(path, f"{start}:{stop}", problem, "10 mm:30 mm:5")
        if not re.fullmatch(r"\s*\d+\s*", count) or not 2 <= int(count) <= MOST_POINTS:
            problem = f"{count.strip()} is no number of values"
            allowed = f"start:stop:count with a count from 2 to {MOST_POINTS:,}"
            raise SceneError.at(path, count, problem, allowed)
        import numpy as np

        values = np.linspace(float(first["number"]), float(last["number"]), int(count))
        # 0.02 instead of 0.019999999999999997: people read and look up these.
        return cls(path, tuple(float(f"{value:.12g}") for value in values), first["unit"] or "")


def sweep(
    scene: Scene | SystemScene | str | os.PathLike[str] | Mapping[str, Any],
    over: Mapping[str, Sequence[Any]] | Sequence[Axis],
    *,
    overrides: str | Iterable[str] = (),
    until: float | str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    converge: bool = False,
    done: pandas.DataFrame | None = None,
    finished: Callable[[int, pandas.DataFrame], None] | None = None,
) -> pandas.DataFrame:
    """Simulate a scene for every combination of values.

    Args:
        scene: what `load_scene` or `load_system` takes, or a scene.
        over: values by their paths in the scene: ``{"cable_types.K.diameter": [0.01, 0.02]}``.
            The last varies fastest.
        overrides: other changes, the same for all runs: ``"run.duration=100"``.
        until: end of the runs instead of the scene's duration: seconds, or text with a unit.
        scheduler: address of a dask scheduler, ``tcp://host:8786``; by default processes of this
            machine. Its workers need cablemodel, and the files that the scene names.
        workers: processes on this machine; by default one for each processor.
        converge: make every run by `converge`, at the tolerance that keeps what is asked of it.
        done: the table of the same sweep, interrupted: its runs are not made again, but for those
            that failed (`read_table`).
        finished: called with the number of finished runs and the table so far, about once a second
            and at the end, also when the sweep is interrupted.

    Returns:
        A row for every finished run, in the order of the combinations (the index): the values, the
        results (`RESULTS`, of a system `results_of`: of the end of the run, and its extremes),
        ``error``, empty where all went well, and ``sweep``, by which a table of another scene,
        end or other changes is told.

    Raises:
        SceneError: nothing to sweep over, no combination is a scene, or what is done is of another
            sweep.
        CableModelError: dask or pandas is not installed, or the scheduler does not answer.
    """
    require("distributed", extra="sweep", what="a sweep")
    require("pandas", extra="sweep", what="a sweep")
    from cablemodel.scene.load import listed
    from cablemodel.scene.units import seconds

    axes = _axes(over)
    if until is not None:
        until = seconds("until", until)
    count = math.prod(len(axis.values) for axis in axes)
    if count > MOST_POINTS:
        raise SceneError.at("", count, f"{count:,} combinations", f"at most {MOST_POINTS:,}")
    text, folder, results = _scene_text(scene)
    fixed = listed(overrides)
    points = list(itertools.product(*(axis.values for axis in axes)))
    changes = [
        (*fixed, *(axis.override(value) for axis, value in zip(axes, point, strict=True)))
        for point in points
    ]
    _refuse_if_none_loads(text, folder, changes)
    same = _fingerprint(text, fixed, until, converge)

    def table() -> pandas.DataFrame:
        return _table(axes, points, rows, results).assign(sweep=same)

    rows: dict[int, dict[str, Any]] = {}
    if done is not None:
        rows = _rows_of(done, table(), axes, points, same)

    def report() -> None:
        if finished is not None:
            finished(len(rows), table())

    simulate = partial(simulate_point, text, folder, until=until, converge=converge)
    left = {index: change for index, change in enumerate(changes) if index not in rows}
    if not left:
        report()
        return table()
    with _client(scheduler, workers, len(left)) as client:
        try:
            _collect(client, simulate, left, rows, report)
        finally:
            report()
    return table()


def _fingerprint(
    text: str, overrides: Sequence[str], until: float | str | None, converge: bool
) -> str:
    """Of what the runs of a sweep have in common: no table of another one is gone on with."""
    common = [_data_of(text), list(overrides), until, converge]
    return hashlib.sha256(json.dumps(common, sort_keys=True, default=str).encode()).hexdigest()[:12]


def _simulate_points(
    simulate: Callable[[Sequence[str]], dict[str, Any]], points: Sequence[Sequence[str]]
) -> list[dict[str, Any]]:
    """Several runs of a sweep, one after the other. Runs in a worker."""
    return [simulate(overrides) for overrides in points]


@lru_cache(maxsize=4)
def _data_of(text: str) -> Any:
    """The data of a scene's text: half of what a short run takes, once for all of a worker's."""
    from cablemodel.scene.text import parse_yaml

    return parse_yaml(text)


def simulate_point(
    text: str,
    folder: str,
    overrides: Sequence[str],
    until: float | str | None = None,
    converge: bool = False,
) -> dict[str, Any]:
    """One run of a sweep: its results by `results_of`, and ``error``. Runs in a worker."""
    from cablemodel.accuracy.converge import converge as run_until_converged
    from cablemodel.results.simulate import simulate
    from cablemodel.systems import read_scene

    problem, make = "", run_until_converged if converge else simulate
    try:
        try:
            scene = read_scene(copy.deepcopy(_data_of(text)), overrides, folder=folder)
        except SceneError:
            scene = read_scene(text, overrides, folder=folder)  # which says the line
        run = make(scene, until=until)
    except CableModelError as error:
        problem = " ".join(str(error).split())
        if not isinstance(error, ConvergenceError) or error.run is None:
            return {"error": problem}
        run = error.run
    return {**_values_of(run), "error": problem}


def results_of(scene: Scene | SystemScene) -> dict[str, str]:
    """Columns of the results of a sweep over a scene, and what they are. Those of a system are
    named by its parts: ``port.start_tension``, ``plate.position.x``, ``tug.force.z``."""
    if not variables.is_system(scene):
        return RESULTS
    found = {name: text for name, text in RESULTS.items() if name not in _ONE_LINE}
    for kind, rows, whens in _OF_PARTS:
        for name in getattr(scene, kind):
            found |= _results_of_part(name, rows, whens)
    return found


def _results_of_part(
    name: str, rows: Iterable[variables.Variable], whens: Mapping[str, str]
) -> dict[str, str]:
    """Columns of a part of a system, and what they are."""
    found = {}
    for row in (row.of_part(name) for row in rows):
        when = whens.get(row.python.removeprefix(f"{name}."))
        if when is not None and row.shape:
            for axis in "xyz":
                found[f"{row.python}.{axis}"] = f"{row.quantity}, {axis}, {when} [{row.unit}]"
        elif when is not None:
            found[row.python] = f"{row.quantity}, {when} [{row.unit}]"
    return found


def result_label(column: str) -> str:
    """What a column of results is, for an axis of a picture."""
    if column in RESULTS:
        return RESULTS[column]
    for _kind, rows, whens in _OF_PARTS:
        for key in whens:
            part = column.removesuffix(f".{key}") if column.endswith(f".{key}") else ""
            for axis in "xyz":
                if column.endswith(f".{key}.{axis}"):
                    part = column.removesuffix(f".{key}.{axis}")
            if part:
                return _results_of_part(part, rows, whens)[column]
    return column


def _values_of(run: Run) -> dict[str, Any]:
    """The results of a run by `results_of`."""
    summary = run.summary()
    found: dict[str, Any] = {
        "highest_tension": float(run.tension_max.max()),
        "lowest_tension": float(run.tension_min.min()),
        **{name: summary[name] for name in RESULTS if name in summary},
    }
    if not variables.is_system(run.scene):
        tip = dict(zip(("tip_x", "tip_y", "tip_z"), summary["tip_position"], strict=True))
        return {**found, **tip, "line_length": float(run["line_length"][-1])}
    for kind, _rows, whens in _OF_PARTS:
        for name, values in summary[kind].items():
            for key in whens:
                if isinstance(values[key], list):
                    components = zip("xyz", values[key], strict=True)
                    found |= {f"{name}.{key}.{axis}": value for axis, value in components}
                else:
                    found[f"{name}.{key}"] = values[key]
    return found


def _axes(over: Mapping[str, Sequence[Any]] | Sequence[Axis]) -> list[Axis]:
    if isinstance(over, Mapping):
        axes = [Axis(path, _values(path, values)) for path, values in over.items()]
    elif isinstance(over, Sequence) and all(isinstance(axis, Axis) for axis in over):
        axes = list(over)
    else:
        problem = f"{shown(over)} is nothing to sweep over"
        raise SceneError.at("", over, problem, "{path: [value, value, ...]}, or a list of Axis")
    paths = [axis.path for axis in axes]
    if not axes or not all(axis.values for axis in axes):
        raise SceneError.at("", paths, "there is nothing to sweep over", "values for every path")
    for path in paths:
        if paths.count(path) > 1:
            raise SceneError.at(path, None, "it is swept over twice", "every path once")
    return axes


def _values(path: str, values: Any) -> tuple[Any, ...]:
    """The values of an axis: of a list or an array, not the letters of a text."""
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        problem = f"{shown(values)} is no list of values"
        raise SceneError.at(path, values, problem, "a list such as [0.01, 0.02]")
    return tuple(values)


def _scene_text(
    scene: Scene | SystemScene | str | os.PathLike[str] | Mapping[str, Any],
) -> tuple[str, str, dict[str, str]]:
    """A scene as YAML text, which travels to workers, the folder of the files it names, and what
    its results are."""
    from cablemodel.systems import read_scene

    read = read_scene(scene)  # a wrong one is said by its own name and lines
    if isinstance(scene, (str, os.PathLike)) and "\n" not in os.fspath(scene):
        path = Path(scene)
        text, folder = path.read_text(encoding="utf-8-sig") + "\n", path.resolve().parent
    else:
        text, folder = scene if isinstance(scene, str) else read.to_yaml() + "\n", Path.cwd()
    return text, str(folder), results_of(read)


def _refuse_if_none_loads(text: str, folder: str, changes: Iterable[Sequence[str]]) -> None:
    """A misspelt path is an error, not a table of errors; a value out of range is a row."""
    from cablemodel.systems import read_scene

    first: SceneError | None = None
    for overrides in changes:
        try:
            read_scene(text, overrides, folder=folder)
        except SceneError as error:
            first = first or error
        else:
            return
    if first is not None:
        raise first


@contextmanager
def _client(scheduler: str | None, workers: int | None, count: int) -> Iterator[Client]:
    """A dask client: of the scheduler at an address, or of processes started here."""
    from distributed import Client, LocalCluster

    if scheduler is not None:
        try:
            client = Client(scheduler, timeout="10s", set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            raise CableModelError(f"no dask scheduler answers at {scheduler}: {error}") from error
        with client:
            yield client
        return
    # Processes started here leave Ctrl-C, which reaches all of a terminal's, to this one.
    with _on_interrupt(signal.SIG_IGN):
        # One thread a process: much of a short run is Python, for one thread at a time.
        cluster = LocalCluster(
            n_workers=min(workers or os.cpu_count() or 1, count),
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        )
    with cluster, Client(cluster, set_as_default=False) as client:
        yield client


@contextmanager
def _on_interrupt(handler: Callable[[int, object], None] | signal.Handlers) -> Iterator[None]:
    """Ctrl-C goes to a handler for a while; signals reach the main thread only."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _collect(
    client: Client,
    simulate: Callable[[Sequence[str]], dict[str, Any]],
    changes: Mapping[int, Sequence[str]],
    rows: dict[int, dict[str, Any]],
    report: Callable[[], None],
) -> None:
    """Run everything, and put each row into ``rows`` when its run ends."""
    from distributed import Future, as_completed

    pressed: list[int] = []

    def note(number: int, _frame: object) -> None:
        # Raised wherever the main thread happens to be, in a destructor of dask's or with one of
        # its locks in hand, an interruption may be lost, or wait for ever. A second is not held.
        if pressed:
            raise KeyboardInterrupt
        pressed.append(number)

    def submit(groups: Sequence[Sequence[int]]) -> list[Future]:
        # Not pure: two sweeps on one cluster are two sweeps, whatever dask remembers.
        runs = [[changes[index] for index in group] for group in groups]
        futures: list[Future] = client.map(
            partial(_simulate_points, simulate), runs, pure=False, retries=0
        )
        places.update((future.key, group) for group, future in zip(groups, futures, strict=True))
        return futures

    places: dict[str, Sequence[int]] = {}
    left = list(changes)
    first, left = left[:PROBES], left[PROBES:]
    with _on_interrupt(note):
        ended = as_completed(submit([[index] for index in first]), loop=client.loop)
        begin = last = time.monotonic()
        wanted = len(rows) + len(changes)
        before = len(rows)
        while len(rows) < wanted:
            batch = ended.next_batch(block=False)
            for future in batch:
                group = places[future.key]
                if future.status == "finished":
                    rows.update(zip(group, future.result(), strict=True))
                elif len(group) > 1:  # one of them is to blame
                    ended.update(submit([[index] for index in group]))
                else:  # an unexpected error, or a worker that died
                    error = future.exception()
                    rows[group[0]] = {"error": f"{type(error).__name__}: {error}"}
            if left and len(rows) - before >= len(first):
                # Short runs go together: a task costs dask some milliseconds.
                each = (time.monotonic() - begin) / len(first)
                together = min(MOST_TOGETHER, max(1, int(TOGETHER / each)))
                ended.update(
                    submit([left[k : k + together] for k in range(0, len(left), together)])
                )
                left = []
            if pressed:
                raise KeyboardInterrupt
            if time.monotonic() - last >= 1.0:
                report()
                last = time.monotonic()
            if not batch:
                time.sleep(PAUSE)


def _table(
    axes: Sequence[Axis],
    points: Sequence[Sequence[Any]],
    rows: Mapping[int, dict[str, Any]],
    results: Iterable[str],
) -> pandas.DataFrame:
    """Finished runs in the order of the points."""
    import pandas

    order = sorted(rows)
    columns: dict[str, Any] = {
        axis.column: [_cell(points[index][k]) for index in order] for k, axis in enumerate(axes)
    }
    for name in results:
        kind = "Int64" if name in ("steps", "elements") else "float64"
        columns[name] = pandas.Series([rows[i].get(name) for i in order], index=order, dtype=kind)
    columns["error"] = [rows[index]["error"] for index in order]
    return pandas.DataFrame(columns, index=pandas.Index(order, name="run"))


def _rows_of(
    done: pandas.DataFrame,
    empty: pandas.DataFrame,
    axes: Sequence[Axis],
    points: Sequence[Sequence[Any]],
    same: str,
) -> dict[int, dict[str, Any]]:
    """Rows of the runs of an earlier table that ended well, by their place among the points.

    empty: a table of this sweep without runs. same: its fingerprint.

    Raises:
        SceneError: the table is not of this sweep.
    """
    import pandas

    if list(done.columns) != list(empty.columns):
        other = [str(name) for name in done.columns if name not in empty.columns]
        problem = f"the table has other columns: {', '.join(other) or 'fewer'}"
        raise SceneError.at("", list(done.columns), problem, ", ".join(map(str, empty.columns)))
    if any(done["sweep"] != same):
        problem = (
            "the table is of a sweep over another scene, or with other --set, --until, --converge"
        )
        raise SceneError.at(
            "", done["sweep"].iloc[0], problem, "a table of this sweep, or a new one"
        )
    rows = {}
    for index, row in zip(done.index, done.to_dict("records"), strict=True):
        if not 0 <= index < len(points):
            allowed = f"runs 0 to {len(points) - 1}"
            raise SceneError.at("", index, f"the table has a run {index}", allowed)
        for axis, value in zip(axes, points[index], strict=True):
            if row[axis.column] != _cell(value):
                problem = f"run {index} of the table has {shown(row[axis.column])}"
                raise SceneError.at(axis.path, row[axis.column], problem, f"{shown(_cell(value))}")
        if row["error"] == "":
            kept = {name: None if pandas.isna(value) else value for name, value in row.items()}
            rows[int(index)] = kept | {"error": ""}
    return rows


def _cell(value: Any) -> Any:
    """Lists and mappings as text: a cell holds one value."""
    return value if isinstance(value, (int, float, str)) else json.dumps(value)


def swept_columns(table: pandas.DataFrame) -> list[str]:
    """Columns of the values swept over: those before the results."""
    return [str(name) for name in table.columns[: table.columns.get_loc("time")]]


def grid_of(table: pandas.DataFrame) -> xarray.Dataset:
    """The result of a sweep with the values swept over as dimensions; runs that are not finished
    are NaN, and ``error`` says so. The table may be one that pandas has read from a file.

    Raises:
        CableModelError: xarray is not installed.
    """
    require("xarray", extra="export", what="xarray")
    if "run" in table.columns:
        table = table.set_index("run")
    made = table["sweep"].dropna().unique() if "sweep" in table.columns else []
    table = table.drop(columns="sweep", errors="ignore")
    # Pandas reads the empty text of a file as none.
    errors = table["error"].astype(object).where(table["error"].notna() | table["time"].isna(), "")
    grid: xarray.Dataset = table.assign(error=errors).set_index(swept_columns(table)).to_xarray()
    grid["error"] = grid["error"].fillna("not finished").astype(str)
    return grid.assign_attrs(sweep=str(made[0])) if len(made) == 1 else grid


def read_table(path: str | os.PathLike[str]) -> pandas.DataFrame:
    """The table of a sweep that `write_table` wrote as .csv or .parquet, for `sweep` to go on.

    Raises:
        CableModelError: it has another ending, or is none of a sweep; or a package is missing.
        OSError: the file cannot be read.
    """
    import pandas

    path = Path(path)
    ending = path.suffix.lower()
    if ending == ".csv":
        table = pandas.read_csv(path, keep_default_na=False)
        if not {"run", "time", "error"} <= set(table.columns):
            raise CableModelError(f"{path} is not the table of a sweep")
        table = table.set_index("run")
        numbers = table.columns[table.columns.get_loc("time") : table.columns.get_loc("error")]
        table[numbers] = table[numbers].apply(pandas.to_numeric)
    elif ending == ".parquet":
        require("pyarrow", extra="export", what="Parquet")
        table = pandas.read_parquet(path)
    else:
        raise CableModelError(f"{path}: a sweep goes on from a .csv or .parquet file")
    return table


def write_table(table: pandas.DataFrame, path: str | os.PathLike[str]) -> None:
    """Write the result of a sweep by the file's ending: .csv, .parquet or .nc.

    A .nc file has the values swept over as dimensions, runs that are not finished as NaN.

    Raises:
        CableModelError: a package is missing that the format needs.
        OSError: the file cannot be written.
    """
    path = Path(path)
    partial_file = path.with_name(f".{path.name}.part")  # a reader never sees half a table
    ending = path.suffix.lower()
    if ending == ".csv":
        table.to_csv(partial_file)
    elif ending == ".parquet":
        require("pyarrow", extra="export", what="Parquet")
        table.to_parquet(partial_file)
    elif ending == ".nc":
        require("h5netcdf", extra="export", what="NetCDF")
        grid_of(table).to_netcdf(partial_file, engine="h5netcdf")
    else:
        raise CableModelError(f"{path} must end in .csv, .parquet or .nc")
    partial_file.replace(path)
