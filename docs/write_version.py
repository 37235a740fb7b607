"""Write a version wherever one stands, and head the changelog's entries with it and today's date:
`make release VERSION=1.0.0` does, before it tests, builds the wheel, commits and tags."""

from __future__ import annotations

import re
import sys
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLACES = {
    "pyproject.toml": r'^version = "(.+)"$',
    "CITATION.cff": r"^version: (.+)$",
    "ros2_node/package.xml": r"^  <version>(.+)</version>$",
    "ros2_node/setup.py": r'^    version="(.+)",$',
}
"""Files, and the line of each that has the version."""


def versions(root: Path) -> dict[str, list[str]]:
    """By file, what stands there."""
    return {
        name: re.findall(line, (root / name).read_text(encoding="utf-8"), flags=re.MULTILINE)
        for name, line in PLACES.items()
    }


def write(root: Path, version: str) -> None:
    """Write it into all files."""
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise SystemExit(f"{version!r} is no version; allowed: three numbers, as 1.0.0")

    def changed(found: re.Match[str]) -> str:
        whole, start = found[0], found.start(0)
        return whole[: found.start(1) - start] + version + whole[found.end(1) - start :]

    for name, line in PLACES.items():
        text = (root / name).read_text(encoding="utf-8")
        (root / name).write_text(re.sub(line, changed, text, flags=re.MULTILINE), encoding="utf-8")
    changes = root / "CHANGELOG.md"
    text = changes.read_text(encoding="utf-8")
    heading = f"## Unreleased\n\n## {version} - {datetime.now(UTC):%Y-%m-%d}\n"
    changes.write_text(text.replace("## Unreleased\n", heading, 1), encoding="utf-8")


if __name__ == "__main__":
    write(ROOT, sys.argv[1] if len(sys.argv) > 1 else "")
