"""One element: tables, strains, damping, residual and matrix in a plane and in space."""
