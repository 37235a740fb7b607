"""What both solvers use: records of the block, water and motion, what a caller drives."""
