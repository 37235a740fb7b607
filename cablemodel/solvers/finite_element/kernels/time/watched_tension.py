"""Which tensions steps are chosen by, and what they may be wrong by."""

from cablemodel.solvers.finite_element.kernels.element.strain import promised_tension
from cablemodel.solvers.shared.access import cable_of, edge_of, header, scalars, tension_of
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import JOINT_ROOT
from cablemodel.solvers.shared.numbers import PROMISE

STEP_PROMISE = 0.5  # of the error of tension that is promised


@kernel
def tension_tolerance(M):
    """Error of a step's top tension that is allowed [N]."""
    return STEP_PROMISE * promised_tension(M)


@inlined
def watched(I):
    """One beyond the last of the elements whose tension is controlled: of one line the top element,
    1; of a system all."""
    head = header(I)
    return 2 if head.parts == 0 else head.nodes


@inlined
def is_watched(I, node):
    """Whether the tension above that node, of those, is: joints of a system have none."""
    head = header(I)
    return head.parts == 0 or I[head.joint + node] == 0


@inlined
def allowed_in(M, cable):
    """Error of a step's tension that is allowed in a cable of a system [N]: by the largest tension
    of its own line."""
    return STEP_PROMISE * PROMISE * scalars(M).tolerance * cable.tension


@kernel
def allowed_at(I, M, node):
    """Error of a step's tension in a watched element that is allowed [N]."""
    if header(I).parts == 0:
        return tension_tolerance(M)
    return allowed_in(M, cable_of(I, M, int(edge_of(I, M, node).segment)))


@kernel
def least_tolerance(I, M):
    """The least error of a step's tension that is allowed in what may lie on a floor [N]."""
    head = header(I)
    least = tension_tolerance(M)
    if head.parts == 0:
        return least
    for n in range(head.cable_count):
        cable = cable_of(I, M, n)
        if cable.edge.contact > 0.0:
            least = min(least, allowed_in(M, cable))
    return least


@inlined
def is_root(I, node):
    """Whether a tree begins at that node."""
    return node == 0 or I[header(I).joint + node] >= JOINT_ROOT


@inlined
def watched_element(I, row):
    """The element next to a constraint, whose tension is looked at."""
    node = int(row.node)
    return node + 1 if is_root(I, node) else node


@kernel
def remember_tensions(I, M):
    """In a system: the largest tension of each cable, by which errors are measured."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            cable = cable_of(I, M, int(edge_of(I, M, node).segment))
            cable.tension = max(cable.tension, abs(tension_of(I, M, node).mean))
