"""What a search fails for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.random_scenes.judge import Verdict

BY_THE_PROMISE = {"position", "tension"}
"""Kinds of being wrong that depend on the tolerance: further from a finer run than is promised."""


def failures(
    verdicts: Sequence[Verdict], before: Mapping[int, str], *, claimed: bool
) -> list[tuple[int, str]]:
    """Seeds and reasons, in the order of the verdicts.

    before: the outcome of each seed that was stored. claimed: whether each run says of itself that
    it keeps what its tolerance promises, as one that is asked to converge does.

    Always a failure: what crashes; energy from nowhere, a limit broken, a line that does not carry
    its weight, numbers that are not finite; a claim that is wrong. A single run claims nothing:
    where it only misses the promise, or takes too long, it fails if it did not before.
    """
    found = []
    for verdict in verdicts:
        seed, outcome = verdict.seed, verdict.outcome
        impossible = sorted(set(verdict.kinds) - BY_THE_PROMISE)
        if outcome == "crashed":
            found.append((seed, f"crashed: {verdict.why}"))
        elif outcome == "wrong" and impossible:
            found.append((seed, f"wrong by {', '.join(impossible)}: {verdict.why}"))
        elif outcome == "wrong" and claimed:
            found.append((seed, f"wrong, and says that it is not: {verdict.why}"))
        elif outcome in ("wrong", "too slow") and not claimed and before.get(seed) != outcome:
            was = before.get(seed, "not judged")
            found.append((seed, f"{outcome}, and {was} before: {verdict.why}"))
    return found
