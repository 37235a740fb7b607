"""The job book: ordinary jobs at sea, each with a scene, an answer and an independent one.

`python -m validation.jobs` computes all, writes docs/jobs/answers.csv and pictures, and the tables
of the pages beside the scenes. Independent answers are closed forms, small differential equations
or published values: nothing of this project's kernels.
"""
