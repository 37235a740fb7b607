"""The direct solver's own records in kernels; shared/access.py has those of both."""

from cablemodel.solvers.shared.compile import record_at, record_in, row_of

from .layout import (
    DrumRow,
    Material,
    OwnHeader,
    OwnScalars,
    PartialSolutions,
    RigidBody,
    Section,
)

own_header = record_in(OwnHeader)
"""own_header(I): sizes, switches, counters, and the words where arrays start."""

own_scalars = record_in(OwnScalars)
"""own_scalars(M): the numbers that there is one of."""

section_of, section_at = row_of(Section, OwnHeader.sections), record_at(Section)
material_row, material_at = row_of(Material, OwnHeader.materials), record_at(Material)
rigid_body_of, rigid_body_at = row_of(RigidBody, OwnHeader.bodies), record_at(RigidBody)
partial_solutions_at = record_at(PartialSolutions)
drum_row_of, drum_row_at = row_of(DrumRow, OwnHeader.drum), record_at(DrumRow)
