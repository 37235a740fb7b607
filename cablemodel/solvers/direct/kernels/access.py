"""The direct solver's own records in kernels; shared/access.py has those of both."""

from cablemodel.solvers.shared.compile import record_at, record_in, row_of

from .layout import (
    AssemblyWork,
    DrumRow,
    EliminatedRows,
    EliminationWork,
    Material,
    NodePlace,
    NodeRates,
    NodeStrain,
    NodeUnknowns,
    NodeWater,
    OwnHeader,
    OwnScalars,
    PartialSolutions,
    RigidBody,
    Section,
    SlotShape,
    SlotSides,
    SuperpositionWork,
)

own_header = record_in(OwnHeader)
"""own_header(I): sizes, switches, counters, and the words where arrays start."""

own_scalars = record_in(OwnScalars)
"""own_scalars(M): the numbers that there is one of."""

section_of, section_at = row_of(Section, OwnHeader.sections), record_at(Section)
material_row, material_at = row_of(Material, OwnHeader.materials), record_at(Material)
rigid_body_of, rigid_body_at = row_of(RigidBody, OwnHeader.bodies), record_at(RigidBody)
drum_row_of, drum_row_at = row_of(DrumRow, OwnHeader.drum), record_at(DrumRow)

unknowns_of = row_of(NodeUnknowns, OwnHeader.unknowns)
start_of = row_of(NodeUnknowns, OwnHeader.start)
change_of = row_of(NodeUnknowns, OwnHeader.delta)
"""change_of(I, M, 2 * node + side): changes of a node's unknowns for a right-hand side."""

rates_of, past_of = row_of(NodeRates, OwnHeader.rate), row_of(NodeRates, OwnHeader.past)
place_of = row_of(NodePlace, OwnHeader.place)
strain_of = row_of(NodeStrain, OwnHeader.strains)
water_of = row_of(NodeWater, OwnHeader.currents)
"""water_of(I, M, node): its velocity; water_of(I, M, capacity + node): its acceleration, while
`surge` is not 0."""

shape_of = row_of(SlotShape, OwnHeader.shape)
sides_of = row_of(SlotSides, OwnHeader.rhs)
partial_solutions_of = row_of(PartialSolutions, OwnHeader.sweep)
eliminated_of = row_of(EliminatedRows, OwnHeader.sweep)
assembly_work = row_of(AssemblyWork, OwnHeader.work)
superposition_work = row_of(SuperpositionWork, OwnHeader.work)
elimination_work = row_of(EliminationWork, OwnHeader.work)
"""elimination_work(I, M, 0), and so for the others: the scratch memory by its user's names."""
