"""Write the generated tables of docs/ros2.md anew: topics, services and parameters."""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/ros2.md"


def main() -> None:
    """Replace what stands between the marks."""
    sys.path.insert(0, str(ROOT / "ros2_node"))
    from cablemodel_ros import interface, settings

    text = PAGE.read_text(encoding="utf-8")
    for mark, table in (
        ("topics", interface.document()),
        ("systems", interface.document_of_systems()),
        ("parameters", settings.document()),
    ):
        pattern = rf"(<!-- {mark}: generated -->\n).*?(<!-- end -->)"
        text = re.sub(pattern, lambda m, t=table: f"{m[1]}\n{t}\n{m[2]}", text, flags=re.DOTALL)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
