"""The reducer's rule: which case wins, and why there may be none.

Trust comes first: a case that a check rejected loses against any that none did. Then the detections that its points
verify count (`core.mapping.support`; the final choice only), then the thesis's score (3.3.3).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict

from core.errors import NoReconstruction, StageFailed
from core.flags import Flag, Severity, error_codes
from core.products.contract import Products
from core.products.search import CaseProduct, ChoiceProduct, PassedProduct, Ranked, RefinedProduct
from core.scene.case import CaseKind, CaseRow, StartMode


@dataclass(frozen=True)
class Candidate:
    """A case that ended, and what it is worth to the inspection."""

    row: CaseRow
    checks: Sequence[Flag]
    """Of its model."""
    verified: int | None = None
    """Detections that its points verify; None where they are not asked for."""

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.row.name


Standing = tuple[bool, int, tuple[int, int]]


def standing(candidate: Candidate, reject: bool = True) -> Standing:
    """What cases are ranked by: those not rejected (unless `reject` is off), verified detections, the score."""
    return not (reject and candidate.row.vetoed), candidate.verified or 0, candidate.row.score


def rank(candidates: Sequence[Candidate], reject: bool = True) -> list[Candidate]:
    """Cases that have a model, best first; equal ones keep the order of their names."""
    with_model = [candidate for candidate in candidates if candidate.row.succeeded]
    by_name = sorted(with_model, key=lambda candidate: candidate.name)
    return sorted(by_name, key=lambda candidate: standing(candidate, reject), reverse=True)


def reduce_cases(candidates: Sequence[Candidate], reject: bool = True) -> ChoiceProduct:
    """The choice among the cases that ended.

    A rejected case can win here when all are: refinement may still find a model to trust around it.
    Raises `NoReconstruction` with the reasons counted when no case has a model.
    """
    ranking = rank(candidates, reject)
    if not ranking:
        raise NoReconstruction(f"no case has a model: {_reasons(candidates)}", where="search")
    return ChoiceProduct(**_choice(ranking[0], ranking))


def reduce_refined(coarse_best: Candidate, refined: Sequence[Candidate], reject: bool = True) -> RefinedProduct:
    """The choice among the best coarse case and the refined ones: a refined case wins only if strictly better.

    Verified detections are counted for all of them or for none. `vetoed` says that the winner is, which with `reject`
    means that every candidate is; `codes` are then those of the findings.
    """
    ranking = rank(refined, reject)
    better = ranking and standing(ranking[0], reject) > standing(coarse_best, reject)
    winner = ranking[0] if better else coarse_best
    others = [candidate for candidate in (*ranking, coarse_best) if candidate.name != winner.name]
    ranked = [winner, *sorted(others, key=lambda candidate: standing(candidate, reject), reverse=True)]
    return RefinedProduct(
        **_choice(winner, ranked),
        vetoed=not standing(winner, reject)[0],
        codes=error_codes(winner.checks),
    )


def reduce_parts(rejected: RefinedProduct, parts: Sequence[Candidate]) -> PassedProduct:
    """The choice among parts of a rejected model: the one that verifies most detections wins, of equals the largest.

    Args:
        rejected: what `reduce_refined` chose.
        parts: cases of kind `part`, with verified detections or all without.

    Raises:
        NoReconstruction: no part has a model that the checks let pass.
    """
    ranking = rank(parts)
    if not ranking or ranking[0].row.vetoed:
        passed = f"; none of its {len(parts)} parts passes them" if parts else ""
        raise NoReconstruction(
            f"every model was vetoed by the checks; the largest, {rejected.best}: {rejected.codes}{passed}",
            where="search",
        )
    row = ranking[0].row
    where = f"frames {row.start}-{row.end - 1} of {rejected.best}, vetoed for {rejected.codes}"
    flag = Flag("parts_after_veto", Severity.WARNING, where=where)
    return PassedProduct(**_choice(ranking[0], ranking), flags=(flag,))


def reduce_perspective(rejected: RefinedProduct, why: str, cases: Sequence[Candidate]) -> PassedProduct:
    """The choice among the cases of a perspective lens, of which the checks let the winner pass.

    Args:
        rejected: what `reduce_refined` chose.
        why: what spoke against the fisheye lens, as a sentence without its full stop.
        cases: of kind `perspective`.

    Raises:
        NoReconstruction: no case has a model that the checks let pass.
    """
    ranking = rank(cases)
    if not ranking or ranking[0].row.vetoed:
        raise NoReconstruction(f"{why}; nor does a model of a perspective lens", where="search")
    where = f"{rejected.best}, vetoed for {rejected.codes}"
    flag = Flag("perspective_after_veto", Severity.WARNING, where=where)
    return PassedProduct(**_choice(ranking[0], ranking), flags=(flag,))


def candidates_of(products: Products, kind: CaseKind) -> list[Candidate]:
    """Cases of a kind among the products of a task's inputs, ordered by key."""
    found = products.parts(CaseProduct, kind)
    return [Candidate(case.row(seconds=None, selected=False), case.checks) for case in found]


def find_candidate(candidates: Sequence[Candidate], name: str) -> Candidate:
    """The case `name`; `StageFailed` when it is missing."""
    for candidate in candidates:
        if candidate.name == name:
            return candidate
    raise StageFailed(f"the case {name} has no row", where="search")


class _Choice(TypedDict):
    """The members of every choice."""

    best: str
    start: int
    end: int
    kind: CaseKind
    registered_images: int
    points3D: int
    start_mode: StartMode | None
    ranking: tuple[Ranked, ...]


def _choice(winner: Candidate, ranking: Sequence[Candidate]) -> _Choice:
    row = winner.row
    return {
        "best": row.name,
        "start": row.start,
        "end": row.end,
        "kind": row.kind,
        "registered_images": row.registered_images,
        "points3D": row.points3D,
        "start_mode": row.start_mode,
        "ranking": tuple(_place(candidate) for candidate in ranking),
    }


def _place(candidate: Candidate) -> Ranked:
    row = candidate.row
    return Ranked(
        name=row.name,
        verified_detections=candidate.verified,
        registered_images=row.registered_images,
        points3D=row.points3D,
    )


def _reasons(candidates: Sequence[Candidate]) -> str:
    if not candidates:
        return "every case failed"
    counts = Counter(str(candidate.row.reason or "") for candidate in candidates)
    return ", ".join(f"{reason} in {count} of {len(candidates)} cases" for reason, count in sorted(counts.items()))
