"""Around the search for an equilibrium: what is free in a system comes to rest without friction,
which holds it from there."""

from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import update_springs
from cablemodel.solvers.finite_element.kernels.floor.feet import rest_feet
from cablemodel.solvers.finite_element.kernels.time.begin import (
    count_from_zero,
    hold_supports,
    rest_here,
)
from cablemodel.solvers.finite_element.kernels.time.time_stepping import update_bending
from cablemodel.solvers.shared.access import foot_of, header, scalars
from cablemodel.solvers.shared.compile import kernel, outlined


@outlined
def choose_bending(I, M):
    """Decide whether a hybrid's elements keep bending, and how stiff clamps are."""
    update_bending(I, M)
    update_springs(I, M, 1.0)


@kernel
def set_friction(I, M, lines, feet):
    """Friction of the floor on lines, and on all feet."""
    scalars(M).friction = lines
    for n in range(header(I).foot_count):
        foot_of(I, M, n).friction = feet


@outlined
def end_search(I, M):
    """What finding a start took is forgotten; elements of a hybrid choose how they bend, and clamps
    of a line alone get the stiffness of their tensions."""
    head = header(I)
    count_from_zero(I)
    if head.hybrid != 0 or (head.parts == 0 and (head.rigid > 0 or head.payout != 0)):
        choose_bending(I, M)


@kernel
def stand_at_rest(I, M, friction):
    """The equilibrium that was found is where a system starts: friction holds it there, of which a
    search for it has left lines none."""
    hold_supports(I, M)
    rest_here(I, M)
    rest_feet(I, M)
    set_friction(I, M, friction, friction)
    end_search(I, M)
