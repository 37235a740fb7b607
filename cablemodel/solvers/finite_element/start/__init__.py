"""From a scene to a block at its initial state, ready for the kernels.

`from_scene.build` is the way through, top-down: what the finite elements cannot do is refused
(refusals), the line becomes nodes and edges (line, winch), numbers go into the block (tables,
line_tables), and the first state is found (first_shape, first_state), on a mesh that a static shape
refines (refinement).
"""
