"""Zip files that are the same, byte for byte, whenever they are written."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

_EPOCH = (2020, 1, 1, 0, 0, 0)


def write_archive(target: Path, files: Mapping[str, bytes]) -> Path:
    """Write files by their paths in the archive; it is never there in part."""
    partial = target.with_name(target.name + ".part")
    with zipfile.ZipFile(partial, "w") as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED, compresslevel=9)
    partial.replace(target)
    return target
