"""Systems: several lines between vessels, bodies with six degrees of freedom, anchors, branches."""

from cablemodel.systems.inputs import VesselInput
from cablemodel.systems.model import SystemModel, load_system, read_scene
from cablemodel.systems.scene import SystemScene

__all__ = ["SystemModel", "SystemScene", "VesselInput", "load_system", "read_scene"]
