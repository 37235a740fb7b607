"""Cable that is pressed bends aside, within elements where nothing else holds it.

Cable without bending stiffness folds under any pressure P in waves however short (sqrt(P/m) times
their number grows them), far shorter than elements. An element gets shorter then instead.

A lay that begins with slack is limp: an element gets shorter by T / `yields`, to nothing under a
small part of what its tension may be wrong by. So slack lies where it fell, and what hangs above it
is not pushed: what cable comes to that is ever more flexible (Pipkin 1986, "The relaxed energy
density for isotropic elastic membranes"). What folds dissipates: D = B d|r'|/dt, with a B by which
D is as large as that pressure. Nothing else stops the strain of an element then.

A line that hangs free bears what its tension may be wrong by, and keeps a hundredth of EA beyond;
down to a tolerance from which on the mesh resolves its folds.
"""

from cablemodel.solvers.finite_element.kernels.element.damping import strain_rate
from cablemodel.solvers.finite_element.kernels.element.strain import is_limp, promised_tension
from cablemodel.solvers.finite_element.kernels.floor.contact import touchdown_layer
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import near_floor
from cablemodel.solvers.finite_element.kernels.mesh.payout import material_top
from cablemodel.solvers.shared.access import edge_of, header, scalars
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import FLOOR_TOUCHED, LAYS_SLACK

BORNE = 0.1  # of what tensions may be wrong by: pressure that shortens a limp element to nothing
FOLDED = 5.0  # of w (EI/w)^(1/3): what a heavy elastica that is fed onto a floor pushes back with
SLOWEST_FOLD = 1e-3  # in sqrt(L/g): rate of folding down to which it dissipates as much
PRESSED_EA = 0.01  # of its axial stiffness, what resists where cable that hangs bends aside
FOLDS_WITHIN = 1e-4  # tau down to which it does: finer meshes resolve its folds


@inlined
def push_of(M, edge):
    """What folds of an element's bending push back with [N]."""
    return FOLDED * edge.contact * touchdown_layer(M, edge)


@kernel
def has_slack(I, M, promised):
    """Whether flexible cable of a lay is slack: where it lies its material is pressed, or would
    be if it were not limp, by more than tensions may be wrong by, `promised` [N], and than half of
    what folds of its least bending push back with. What hangs may be pressed by a blow; cable that
    bends and lies straight may bear more than its folds do."""
    head = header(I)
    q = view(M, head.position, 2 * head.dimension * head.nodes)
    if not (scalars(M).yields > 0.0 or head.floor_state == FLOOR_TOUCHED):
        return False
    for node in range(1, head.nodes):
        pressure = -M[head.tension + 2 * node]
        if pressure <= 0.0 or I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        if edge.flexible == 0.0:
            continue
        if is_limp(edge):
            pressure /= edge.yields * edge.compliance
        elif not (near_floor(I, M, node, q) and near_floor(I, M, I[head.parent + node], q)):
            continue
        if pressure > max(promised, 0.5 * push_of(M, edge)):
            return True
    return False


@kernel
def choose_limp(I, M):
    """Under what pressure elements of the state bend aside, by the largest tension so far.

    None where nothing damps what snaps back, in air, and where no tension is promised. A lay with
    slack is limp once it is pressed. Legs of moorings and loads that land would snap until no step
    was small enough: their cable folds by `sea_floor.least_bending`.
    """
    head = header(I)
    state = scalars(M)
    largest = state.largest_tension
    if state.undamped != 0.0 or largest > 1e300:
        return
    promised = 10.0 * state.tolerance * max(largest, state.tolerance * state.tension_scale)
    limp = head.limp == LAYS_SLACK and state.time > 0.0 and has_slack(I, M, promised)
    state.yields = BORNE * promised if limp else 0.0
    bears = promised_tension(M)
    hangs = head.floor_state != FLOOR_TOUCHED and state.tolerance >= FOLDS_WITHIN
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        if edge.flexible == 0.0:
            continue
        edge.bears = 0.0
        edge.yields = 0.0
        if limp:
            edge.yields = state.yields
        elif hangs:
            edge.bears = bears
            edge.yields = PRESSED_EA / (1.0 - PRESSED_EA) / edge.compliance


@kernel
def forget_limp(I, M):
    """No cable bends aside within elements."""
    head = header(I)
    scalars(M).yields = 0.0
    for node in range(1, head.nodes):
        edge_of(I, M, node).yields = 0.0


@kernel
def follow_limp(I, M):
    """What bends aside in the next step, and what damping elements have in it, from the state.

    Flexible cable has so much of its material's that T + D is not below zero where T vanishes; as
    it is pulled taut D comes with T, within what tensions may be wrong by.
    """
    head = header(I)
    choose_limp(I, M)
    if head.payout != 0:
        count = 2 * head.dimension * head.nodes
        q = view(M, head.position, count)
        v = view(M, head.velocity, count)
        material_top(I, M, q, v, view(M, head.acceleration, count))
    promised = promised_tension(M)
    slowest = SLOWEST_FOLD / scalars(M).period
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        if I[head.joint + node] != 0:
            continue
        t0 = M[head.tension + 2 * node]
        if is_limp(edge) and t0 < abs(M[head.tension + 2 * node + 1]):
            mean, slope = strain_rate(I, M, node)
            edge.damping = edge.yields / max(abs(mean), abs(slope), slowest)
        elif edge.damping_full == 0.0 or edge.flexible == 0.0:
            edge.damping = edge.damping_full
        else:
            tension = max(0.0, t0)
            edge.damping = edge.damping_full * min(1.0, tension / promised)
            mean, _slope = strain_rate(I, M, node)
            if edge.damping * mean < -tension:
                edge.damping = -tension / mean
