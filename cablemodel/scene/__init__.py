"""Scenes: what is simulated, read from YAML, checked, and kept in SI."""

from __future__ import annotations

from cablemodel.scene.load import apply_overrides, load_scene, scene_json_schema, unit_at
from cablemodel.scene.motion import VesselMotion
from cablemodel.scene.schema import Scene

__all__ = [
    "Scene", "VesselMotion", "apply_overrides", "load_scene", "scene_json_schema", "unit_at",
]  # fmt: skip
