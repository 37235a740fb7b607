"""How a system comes to rest from where its nodes are: without friction, at once or on floors that
harden, and again on shorter elements where it bends, and where it meets the floor.

Who looks for the start (systems/equilibrium.py, the FMU's system_start.c) finds the equilibria
between.
"""

from cablemodel.solvers.finite_element.kernels.element.stabilisation import stabilise
from cablemodel.solvers.finite_element.kernels.mesh.bending_mesh import halve_bent
from cablemodel.solvers.finite_element.kernels.mesh.lengths import (
    SHORTEST_PIECE,
    forget_stabilisation,
)
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import follow_floor
from cablemodel.solvers.finite_element.kernels.start.at_rest import set_friction, stand_at_rest
from cablemodel.solvers.finite_element.kernels.time.begin import ROW_BENT, bends, restore_bending
from cablemodel.solvers.shared.access import (
    cable_of,
    edge_of,
    header,
    scalars,
    settling_at,
    spare_row,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    AT_BENDS,
    AT_FLOOR,
    FLOOR_FAR,
    FLOOR_NONE,
    JOINT_NONE,
    NO_CAPACITY,
    NOTHING,
    OK,
    SEARCH,
    SETTLED,
)
from cablemodel.solvers.shared.numbers import (
    HARDENING,
    LARGEST_STATIC_MESH,
    REFINEMENT_BENT,
    REFINEMENT_ROUNDS,
)


@outlined
def keep(I, M, kept, place):
    """Copy the block's image: 0 that from which an equilibrium is sought, 1 that at rest."""
    words = header(I).image_words
    for n in range(words):
        kept[place * words + n] = M[n]


@outlined
def give_back(I, M, kept, place):
    """The image that was kept."""
    words = header(I).image_words
    for n in range(words):
        M[n] = kept[place * words + n]


@outlined
def begin(I, M, at):
    """An equilibrium is sought from where nodes are. Returns SEARCH."""
    at.begins = 1.0
    at.way = at.floor = at.stabilised = 0.0
    at.friction = scalars(M).friction
    at.depth = scalars(M).floor_depth
    set_friction(I, M, 0.0, 0.0)
    return SEARCH


@kernel
def try_next_way(I, M, at, kept, status):
    """On floors that harden, from the same place. SEARCH, or the status where none is left."""
    give_back(I, M, kept, 0)
    while at.way > 0.0 and HARDENING[int(at.floor)] != 1.0:
        at.floor += 1.0
    if at.way > 0.0:
        at.floor += 1.0
    at.way += 1.0
    if header(I).floor_kind == FLOOR_NONE or at.floor >= len(HARDENING):
        return status
    scalars(M).floor_depth = HARDENING[int(at.floor)] * at.depth
    return SEARCH


@outlined
def refine(I, M, at):
    """Shorter elements at the present stage, once: NOTHING, CHANGED or NO_CAPACITY."""
    head = header(I)
    if at.stage == AT_BENDS:
        if head.nodes > LARGEST_STATIC_MESH:
            return NOTHING
        bent = view(M, spare_row(I, ROW_BENT), head.nodes)
        bends(I, M, bent)
        return halve_bent(I, M, bent, REFINEMENT_BENT)
    if head.floor_kind == FLOOR_NONE or head.floor_state == FLOOR_FAR:
        return NOTHING
    return follow_floor(I, M, True, 0)


@outlined
def size_cables(I, M):
    """Elements in which cables pass winches, as long as those that are out after some were halved:
    on the mean of their cable, or, where none of it is out, of their line."""
    head = header(I)
    for index in range(head.cable_count):
        cable = cable_of(I, M, index)
        own = 0.0
        count = 0
        all_own = 0.0
        all_count = 0
        for node in range(1, head.nodes):
            if I[head.joint + node] != JOINT_NONE:
                continue
            edge = edge_of(I, M, node)
            if int(edge.segment) == index:
                own += edge.length
                count += 1
            if cable_of(I, M, int(edge.segment)).row == cable.row:
                all_own += edge.length
                all_count += 1
        if cable.nominal == 0.0 or (count == 0 and cable.counted != 0.0):
            continue
        cable.nominal = own / count if count > 0 else all_own / all_count
        cable.edge.nominal = cable.nominal
        cable.shortest = min(cable.shortest, SHORTEST_PIECE * cable.nominal)
    for n in range(head.winch_count):
        winch = winch_of(I, M, n)
        node = int(winch.node)
        top = edge_of(I, M, node + 1 if winch.way > 0.0 else node)
        winch.start = top.start if winch.way > 0.0 else top.start + top.length
        winch.top_length = top.length


@outlined
def go_on_refining(I, M, at, kept):
    """On shorter elements where some are too long. SEARCH, NO_CAPACITY, or OK: none is."""
    while at.stage < SETTLED:
        if at.rounds < REFINEMENT_ROUNDS:
            keep(I, M, kept, 1)
            found = refine(I, M, at)
            if found == NO_CAPACITY:
                give_back(I, M, kept, 1)
                return NO_CAPACITY
            if found != NOTHING:
                at.rounds += 1.0
                if at.stage == AT_BENDS:
                    size_cables(I, M)
                    forget_stabilisation(I, M)
                    restore_bending(I, M)
                return begin(I, M, at)
        at.stage += 1.0
        at.rounds = 0.0
    return OK


@kernel
def waiting(I, M, kept, status):
    """Keep the place from which an equilibrium is sought; the status."""
    if status == SEARCH:
        keep(I, M, kept, 0)
    return status


@kernel
def go_on_settling(I, M, status, words, kept):
    """Come to rest, from one equilibrium to the next.

    SEARCH: an equilibrium is to be found next, and this to be called again with its status (OK at
    first). NO_CAPACITY: the block must grow, with room for two larger images, and this be called
    with that status. OK: it is at rest; else there is no such start. words: a Settling.
    """
    at = settling_at(words, 0)
    state = scalars(M)
    if status == NO_CAPACITY:
        return waiting(I, M, kept, go_on_refining(I, M, at, kept))
    if at.begun == 0.0:
        at.begun = 1.0
        return waiting(I, M, kept, begin(I, M, at))
    at.begins = 0.0
    if status != OK:
        status = try_next_way(I, M, at, kept, status)
        if status != SEARCH and at.stage == AT_FLOOR:
            give_back(I, M, kept, 1)  # the mesh follows the floor as the run begins
            return OK
        return status
    if at.way > 0.0:
        if HARDENING[int(at.floor)] != 1.0:
            at.floor += 1.0
            state.floor_depth = HARDENING[int(at.floor)] * at.depth
            return SEARCH
        state.floor_depth = at.depth
    # The new stiffness changes the forces by a little: the state must meet them.
    if at.stabilised == 0.0 and stabilise(I, M):
        at.stabilised = 1.0
        at.way = at.floor = 0.0
        keep(I, M, kept, 0)
        return SEARCH
    stand_at_rest(I, M, at.friction)
    if at.stage == 0.0:
        at.stage = AT_BENDS
    return waiting(I, M, kept, go_on_refining(I, M, at, kept))
