"""The direct solver's instance block: its words after those that both solvers share.

    shared header | shared scalars | header | scalars | tables | state || workspace

The first two are those of cablemodel/solvers/shared/layout.py: identity, vessel motion, current,
pay-out, counters and time stand where the shared kernels look for them. Nodes are numbered from the
vessel outwards; a line is a chain of sections, each with nodes of its own, so that the two sides of
a joint are two nodes at one place.
"""

from cablemodel.solvers.shared.layout import HEADER_WORDS, SCALAR_WORDS
from cablemodel.solvers.shared.record import Record, integer, integers, real, reals, spare

MAGIC = 0x5443455249444243  # "CBDIRECT", little endian
VERSION = 5


class OwnHeader(Record, first=HEADER_WORDS + SCALAR_WORDS):
    """Sizes, switches and counters of the direct solver, and the words where its arrays start."""

    section_count = integer("sections of the line")
    section_capacity = integer("sections that there is room for")
    planar = integer("1: four and six unknowns a node in a vertical plane; 0: six and ten")
    method = integer("SUPERPOSITION or ELIMINATION: how linear systems are solved")
    joint = integer("PAPER or MOMENT_FREE: joint of the hybrid")
    end = integer("what holds the far end: END_...")
    clamped = integer("bit 0: clamped at the vessel, bit 1: at the anchor")
    floor = integer("1 where there is a sea floor")
    restart = integer("1: the next step is backward Euler, for the rates are not those of the past")
    body_count = integer("bodies")
    drum_count = integer("rows of the drum table")
    drum_used = integer("how many of them have passed the tow point")
    most_iterations = integer("most iterations that a step has taken")
    sticks = integer("1 while friction holds the touchdown point")
    meeting = integer("slot at which the two sweeps of a superposition meet")
    right_sides = integer("1, or 2 where the line ends on the floor")
    turned = integer("how often the frame was turned away from its singularity")
    material_count = integer("materials")
    drum_capacity = integer("rows that the drum table has room for")
    _spare_1 = spare(11)

    # Words where arrays start.
    sections = integer("sections (Section)")
    materials = integer("materials (Material)")
    bodies = integer("bodies (RigidBody)")
    drum = integer("what passes the tow point (DrumRow)")
    _spare_2 = spare(1)
    unknowns = integer("of the nodes (NodeUnknowns)")
    rate = integer("rates of what eq. 38 differentiates (NodeRates)")
    length = integer("unstretched length of the interval behind each node [m]")
    flow = integer("current and its like at each node")
    share = integer("of the strain at each node")
    place = integer("place of each node (NodePlace)")
    past = integer("what eq. 38 keeps of the past (NodeRates)")
    start = integer("unknowns at the start of the step (NodeUnknowns)")
    currents = integer("velocity of the water at each node (NodeWater), then its acceleration")
    strains = integer("strain and its slope at each node (NodeStrain)")
    left = integer("blocks of each slot's unknowns on its left (slots, WIDTH, WIDTH)")
    right = integer("the same on its right")
    rhs = integer("right-hand sides of each slot and the scales of its rows (SlotSides)")
    shape = integer("rows and unknowns of each slot (SlotShape)")
    sweep = integer(
        "what the linear solver keeps of each node (PartialSolutions) or slot (EliminatedRows)"
    )
    work = integer("scratch memory: AssemblyWork, SuperpositionWork or EliminationWork")
    delta = integer("changes of the unknowns, two rows a node, one for each side (NodeUnknowns)")
    _spare_3 = spare(1)
    old_length = integer("`length` at the start of the step [m]")
    _spare_4 = spare(10)


OWN_WORDS = OwnHeader.WORDS


class OwnScalars(Record, first=OwnHeader.FIRST + OWN_WORDS):
    """Numbers of the direct solver that there is one of."""

    time_step = real("longest step", "s")
    spacing = real("of nodes", "m")
    alpha = real("of eq. 38")
    tolerance = real("of Newton's method")
    beta = real("1/(alpha dt) of the step that is being made; 0 in a steady state", "1/s")
    memory = real("gamma of eq. 38 in that step")
    dt = real("that step", "s")
    share = real("of the flow (tow speed and current) in a steady state: continuation")
    rate = real("pay-out rate at the end of the step", "m/s")
    laid = real("cable that lies on the floor behind the touchdown point", "m")
    flow_end = real("cable that passes the touchdown point", "m/s")
    reaction = real("of the floor on the line's end, normal to the floor", "N")
    vessel = reals(6, "tow point, its velocity, in the paper's axes at the end of the step")
    scale = reals(10, "size of each unknown")
    _spare_1 = spare(1)
    floor = reals(4, "unit normal n (paper's axes), and n.x of the plane")
    friction = real("Coulomb coefficient")
    clamp = reals(4, "phi, theta of a clamp at the vessel, at the anchor", "rad")
    anchor = reals(3, "place of the anchor, earth frame", "m")
    drift = real("how far a held end may drift", "m")
    friction_force = real("at the touchdown point", "N")
    _spare_2 = spare(2)
    lowest = real("tension below which a flexible section counts as slack", "N")
    _spare_3 = spare(1)
    paid_in_step = real("cable paid out within the step", "m")
    start = reals(2, "`flow_end` and `reaction` at the start of the step")
    _spare_4 = spare(14)


FIRST_FREE = OwnScalars.FIRST + OwnScalars.WORDS


class NodeUnknowns(Record):
    """A node's unknowns, in the paper's order."""

    v1 = real("velocity of the material along a1", "m/s")
    v2 = real("along a2", "m/s")
    v3 = real("along a3", "m/s")
    phi = real("Euler angle", "rad")
    theta = real("Euler angle", "rad")
    f1 = real("internal force along a1", "N")
    f2 = real("along a2", "N")
    f3 = real("along a3: the tension", "N")
    k1 = real("curvature about a1; of a rigid body the moment", "1/m")
    k2 = real("about a2", "1/m")


WIDTH = NodeUnknowns.WORDS
V1, V2, V3, PHI, THETA, F1, F2, F3, K1, K2 = (f.word for f in NodeUnknowns.FIELDS.values())
"""Numbers of the unknowns: columns of a matrix, and the rows of the conditions that stand in for
them."""


class NodeRates(Record):
    """Of a node, what eq. 38 differentiates in time: its rates, or what is kept of the past."""

    v1 = real("of the velocity along a1")
    v2 = real("along a2")
    v3 = real("along a3")
    phi = real("of the Euler angles")
    theta = real("of the other one")
    strain = real("of the strain")


RATES = NodeRates.WORDS


class NodePlace(Record):
    """Where a node is, earth frame."""

    x = real("east", "m")
    y = real("north", "m")
    z = real("up", "m")


PLACE_WORDS = NodePlace.WORDS


class NodeWater(Record):
    """Velocity or acceleration of the water at a node, along the paper's axes."""

    e1 = real("down")
    e2 = real("horizontal")
    e3 = real("horizontal, across e2")


WATER_WORDS = NodeWater.WORDS


class NodeStrain(Record):
    """Of the cable at a node, by its tension."""

    strain = real("by which it is longer")
    slope = real("derivative of that by the tension", "1/N")


STRAIN_WORDS = NodeStrain.WORDS


class Section(Record):
    """A section of the line, all in integers."""

    first = integer("its first node")
    count = integer("how many nodes it has")
    kind = integer("CABLE, ELASTICA or RIGID")
    material = integer("row of the material")
    body = integer("row of the body of finite length that it is")
    point = integer("row of the point body at its start, -1: none")
    hinge = integer("1: the joint at its start is a hinge even between two elasticas")
    item = integer("which cable of line and drum it belongs to")
    _spare = spare(2)


SECTION_WORDS = Section.WORDS
CABLE, ELASTICA, RIGID = 0, 1, 2


class Material(Record):
    """A kind of cable."""

    mass = real("in air", "kg/m")
    added_mass = real("across the cable", "kg/m")
    weight = real("in water", "N/m")
    normal = real("1/2 rho Cdn d", "kg/m2")
    tangential = real("1/2 rho Cdt pi d", "kg/m2")
    bending = real("bending stiffness", "N m2")
    terms = real("number of coefficients of the strain curve")
    offset = real("their place in the table of strain curves")
    low = real("tension below which the curve is continued by its tangent", "N")
    high = real("tension above which it is", "N")
    displaced = real("mass of the water that it displaces", "kg/m")
    _spare = spare(1)


MATERIAL_WORDS = Material.WORDS
BODY_STATES = 5


class RigidBody(Record):
    """A body, with what eq. 38 needs of its past: of BODY_STATES velocities, of the centre of
    gravity (3) and of turning (2)."""

    mass = real("in air", "kg")
    weight = real("in water", "N")
    added_mass = real("across its axis", "kg")
    added_mass_axial = real("along its axis", "kg")
    drag = real("1/2 rho CdA across its axis", "kg/m")
    drag_axial = real("1/2 rho CdA along its axis", "kg/m")
    half = real("half of its length; 0: a point body", "m")
    offset = real("of the centre of gravity from the middle, in half lengths")
    inertia = real("rotary, about the centre of gravity", "kg m2")
    buoyancy = real("weight of what it displaces", "N")
    item = real("its place in line and drum")
    state = reals(5, "velocities")
    state_rate = reals(5, "their rates")
    past = reals(5, "what eq. 38 keeps of them")
    start = reals(5, "`state` at the start of the step")
    _spare = spare(1)


BODY_WORDS = RigidBody.WORDS


class DrumRow(Record):
    """What passes the tow point, in order; integers but for `leaves`."""

    material = integer("row of the material")
    kind = integer("CABLE, ELASTICA or RIGID")
    point = integer("row of the point body at its outer end, -1: none")
    item = integer("its place in line and drum")
    leaves = real("pay-out at which its outer end passes the tow point", "m")
    hinge = integer("1: the joint at its outer end is a hinge")
    rigid = integer("row of the body of finite length that it is")
    _spare = spare(1)


DRUM_WORDS = DrumRow.WORDS

END_FREE, END_ANCHOR, END_CONTACT, END_TOUCHDOWN = 0, 1, 2, 3

BLOCK = WIDTH * WIDTH
HALF = WIDTH // 2
"""Coefficients of a node's partial solutions, at most."""
ELIMINATED = 2 * WIDTH + 2
"""Words of a row in elimination: unknowns on the left and on the right, two right-hand sides."""
SUPERPOSED = 2 * WIDTH + 4
"""Words of a row in superposition."""


class PartialSolutions(Record, within=OwnHeader.sweep):
    """Of a node, y0 + Y z (superposition.py), for two right-hand sides."""

    particular = reals(2 * WIDTH, "y0 of each side")
    complementary = reals(WIDTH * HALF, "Y by rows, of one for each coefficient")
    mix = reals(HALF * HALF, "T by rows: Y before it was made orthonormal is Y T")
    shift = reals(2 * HALF, "S of each side: y0 before that is y0 + Y S")
    known = reals(2 * HALF, "a of each side: coefficients before a joint are a + B z")
    cross = reals(HALF * HALF, "B by rows")


class EliminatedRows(Record, within=OwnHeader.sweep):
    """Of a slot, what elimination keeps in the same words for the way back (elimination.py)."""

    rows = reals(WIDTH * ELIMINATED, "by rows: those from which the unknowns on its left follow")


SWEEP_WORDS = max(PartialSolutions.WORDS, EliminatedRows.WORDS)


class SlotShape(Record):
    """How large the matrices of a slot are, all in integers."""

    rows = integer("equations")
    left = integer("unknowns on its left")
    right = integer("unknowns on its right")
    interval = integer("1: an interval, an initial value problem; 0: a joint or an end")


SHAPE_WORDS = SlotShape.WORDS


class SlotSides(Record):
    """The right-hand sides of a slot."""

    sides = reals(2 * WIDTH, "two of them, one after the other")
    scales = reals(WIDTH, "what its rows have been divided by")


RHS_WORDS = SlotSides.WORDS


# Users of the scratch memory at `work`, one at a time.


class AssemblyWork(Record, within=OwnHeader.work):
    """Of the assembly of the linear system: assembly.py."""

    residual = reals(WIDTH, "rows of a slot at the iterate")
    other_residual = reals(WIDTH, "the same where one unknown has changed")
    by_middle = reals(BLOCK, "derivatives of the residual by the values at an interval's middle")
    by_difference = reals(BLOCK, "by their differences over its length")
    by_stretch = reals(WIDTH, "by the stretch at its middle")
    by_stretch_slope = reals(WIDTH, "by the difference of stretch over its length")


class SuperpositionWork(Record, within=OwnHeader.work):
    """Of the solution by superposition: superposition.py."""

    solution = reals(2 * WIDTH, "z of both sides of slot C, the left one's first, of each side")
    coefficients = reals(2 * WIDTH, "z at a node, of each right-hand side")
    before = reals(HALF, "z at the node before a joint")
    rows = reals(WIDTH * SUPERPOSED, "equations of a slot by rows, their right-hand sides behind")
    pivot_row = integers(HALF + WIDTH, "row whose pivot a column holds, -1: none")


class EliminationWork(Record, within=OwnHeader.work):
    """Of the solution by elimination: elimination.py."""

    rows = reals(2 * WIDTH * ELIMINATED, "those that are left over and those of a slot")


WORK_WORDS = 800
"""Room for any of them, and more than that: saved states count on it."""

# Tasks of the entry point `work`.
TASK_STEP, TASK_EQUILIBRIUM, TASK_ASSEMBLE, TASK_SOLVE = 0, 1, 2, 3

SUPERPOSITION, ELIMINATION = 0, 1
PAPER, MOMENT_FREE = 0, 1

# Status codes beyond those of cablemodel/solvers/shared/layout.py.
SLACK, SINGULAR_ANGLE, DRIFT, BODY_ON_FLOOR, SHORT_SECTION = 20, 21, 22, 23, 24
USED_UP, OVERSHOT = 25, 26
