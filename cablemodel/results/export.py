"""Write a run to files of other formats: NetCDF, CSV, Parquet."""

from __future__ import annotations

import csv
import math
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from cablemodel.errors import CableModelError
from cablemodel.extras import require
from cablemodel.results.columns import Column, input_columns, output_columns, state_columns

if TYPE_CHECKING:
    from cablemodel.results.run import Run

Table = Literal["outputs", "states", "inputs"]

FORMATS = (".nc", ".csv", ".parquet")

_COLUMNS = {"outputs": output_columns, "states": state_columns, "inputs": input_columns}


def export(run: Run, path: str | PathLike[str], *, table: Table = "outputs") -> None:
    """Write a run to a file, by its ending.

    - ``.nc``: NetCDF 4, everything: what :meth:`~cablemodel.Run.to_xarray` gives.
    - ``.csv``: one table, a header of names and units, numbers that read back to the last bit;
      empty where there is no number.
    - ``.parquet``: one table; unit and description are metadata of each column.

    Args:
        run: what to write.
        path: file to write; an existing one is replaced.
        table: of a file that has only one: outputs over time, a row for every node of every exact
            state, or the applied inputs of every step.

    Raises:
        CableModelError: no such format, or a package is missing that it needs.
        OSError: the file cannot be written.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending == ".nc":
        _write_netcdf(run, path)
    elif ending == ".csv":
        _write_csv(_COLUMNS[table](run), path)
    elif ending == ".parquet":
        _write_parquet(_COLUMNS[table](run), path, run.scene.title or "")
    else:
        raise CableModelError(f"{path} must end in {', '.join(FORMATS)}")


def _write_netcdf(run: Run, path: Path) -> None:
    for package in ("h5netcdf", "h5py"):
        require(package, extra="export", what="NetCDF")
    data = run.to_xarray()
    packed = {
        name: {"zlib": True, "complevel": 4}
        for name, values in data.data_vars.items()
        if values.size and values.dtype.kind == "f"
    }
    data.to_netcdf(path, engine="h5netcdf", encoding=packed)


def _write_csv(columns: list[Column], path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow([c.name if c.unit == "1" else f"{c.name} [{c.unit}]" for c in columns])
        for row in zip(*(c.values.tolist() for c in columns), strict=True):
            writer.writerow([_cell(value) for value in row])


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else repr(value)


def _write_parquet(columns: list[Column], path: Path, title: str) -> None:
    pyarrow: Any = require("pyarrow", extra="export", what="Parquet")
    parquet: Any = require("pyarrow.parquet", extra="export", what="Parquet")
    fields = [
        pyarrow.field(
            c.name,
            pyarrow.string() if c.values.dtype.kind == "U" else pyarrow.float64(),
            metadata={"unit": c.unit, "description": c.quantity},
        )
        for c in columns
    ]
    schema = pyarrow.schema(fields, metadata={"title": title})
    arrays = [pyarrow.array(c.values) for c in columns]
    parquet.write_table(pyarrow.table(arrays, schema=schema), path, compression="zstd")
