"""What both solvers say alike in a Summary."""

from cablemodel.solvers.shared.compile import kernel


@kernel
def clear_floor(found, place):
    """Nothing touches the floor; place: what stands for the touchdown point."""
    for i in range(3):
        found.floor_force[i] = 0.0
        found.touchdown_position[i] = place
    found.floor_length = 0.0
    found.touchdown_reaction = 0.0
