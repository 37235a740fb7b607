"""Mixed cubic Hermite finite elements: block, mesh, starts, small motions; the main solver."""
