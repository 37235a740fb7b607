"""Start a package's launch file: `python run.py cablemodel_ros cable.launch.py namespace:=tug`.

Starts what is installed, and writes one line of JSON with the command of every node.
"""

from __future__ import annotations

import importlib.util
import json
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.actions import DeclareLaunchArgument


def main(package: str, file: str, *words: str) -> int:
    path = Path(get_package_share_directory(package)) / "launch" / file
    spec = importlib.util.spec_from_file_location("launch_file", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    entities = module.generate_launch_description().entities
    declared = [item for item in entities if isinstance(item, DeclareLaunchArgument)]
    given = {item.name: item.default for item in declared}
    for word in words:
        name, _, text = word.partition(":=")
        assert name in given, f"no argument {name}"
        given[name] = text
    nodes = [item for item in entities if item not in declared and item.wanted(given)]
    commands = [[node.package, node.executable, *node.command(given)] for node in nodes]
    sys.stdout.write(json.dumps(commands) + "\n")
    sys.stdout.flush()
    for name, executable, *arguments in commands:
        if name == package:
            program = Path(get_package_prefix(package)) / "lib" / package / executable
            os.execv(program, [str(program), *arguments])
    return 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
