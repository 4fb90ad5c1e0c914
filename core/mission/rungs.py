"""Which method each stage of a plan uses: the cheapest whose bounds together fit the error budget, and why."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..errors import InvalidInput
from ..geodesy import accuracy
from ..geodesy.accuracy import Scene
from .choices import AUTO, MESH_TOLERANCES_PX, MESHES


@dataclass(frozen=True)
class Rung:
    """A method of a stage, and what it may be wrong by in one scene.

    Attributes
    ----------
    stage, name : str
    bound_px : float
        Infinite where the method has no bound.
    bound_m : float
        The same on the ground, where a pixel spans most of it.
    outside : str
        Why the method has no bound here; empty where it has one.
    """

    stage: str
    name: str
    bound_px: float
    bound_m: float
    outside: str = ""


@dataclass(frozen=True)
class Choice:
    """What a stage uses, and the first cheaper method that was rejected with the reason; None where there was none."""

    rung: Rung
    rejected: Rung | None = None
    reason: str = ""


@dataclass(frozen=True)
class Accuracy:
    """What a plan chose, and what it may be wrong by.

    Attributes
    ----------
    budget_px : float
    footprint, picture : Choice
    mesh : Choice or None
        Of a camera frame.
    condition : float
        Condition number of the scene; infinite where the horizon is in the picture.
    terrain_px_per_m : float
        Displacement per metre of relief, which is not modelled and not in the bound.
    left_out : tuple of (str, str)
        What the scene does not need, and why.
    """

    budget_px: float
    footprint: Choice
    picture: Choice
    mesh: Choice | None
    condition: float
    terrain_px_per_m: float
    left_out: tuple[tuple[str, str], ...]

    @property
    def choices(self) -> tuple[Choice, ...]:
        """Of each stage that the plan has."""
        return tuple(choice for choice in (self.footprint, self.picture, self.mesh) if choice is not None)

    @property
    def bound_px(self) -> float:
        """Sum of the stages' bounds."""
        return sum(choice.rung.bound_px for choice in self.choices)

    @property
    def mesh_tolerance_px(self) -> float:
        """What a cell of the mesh may be wrong by; 0 for rays and where there is no mesh."""
        name = self.mesh.rung.name if self.mesh else "rays"
        return dict(zip(MESHES, MESH_TOLERANCES_PX)).get(name, 0.0)

    def text(self) -> str:
        """One line for people: methods, bounds, what was left out, and what is not bounded."""
        stages = "; ".join(
            f"{choice.rung.stage}: {choice.rung.name}, ≤ {bound_text(choice.rung.bound_px)} px"
            for choice in self.choices
        )
        left_out = ", ".join(what for what, _ in self.left_out)
        return f"{stages}; left out: {left_out or 'nothing'}; {self.terrain_text()}"

    def lines(self) -> list[tuple[str, str]]:
        """Label and value of what was chosen and why, in words for people."""
        lines = []
        for choice in self.choices:
            name, bound, rejected = choice.rung.name, bound_text(choice.rung.bound_px), choice.rejected
            text = (
                f"{name}, ≤ {bound} px"
                if rejected is None
                else f"{name}, ≤ {bound} px (not {rejected.name}: {choice.reason})"
            )
            lines.append((f"method of {choice.rung.stage}", text))
        left_out = "; ".join(f"{what} ({why})" for what, why in self.left_out)
        return [
            *lines,
            ("error", f"≤ {bound_text(self.bound_px)} px of a budget of {self.budget_px:g} px"),
            ("left out", left_out or "nothing"),
            ("terrain", self.terrain_text().partition(": ")[2]),
            (
                "condition number",
                f"{self.condition:.3g}" if math.isfinite(self.condition) else "infinite (horizon)",
            ),
        ]

    def terrain_text(self) -> str:
        """What relief may add."""
        if not math.isfinite(self.terrain_px_per_m):
            return "terrain: not bounded, without limit at the horizon"
        return f"terrain: not bounded, up to {self.terrain_px_per_m:.2g} px per metre of relief"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping; what is infinite is null."""
        stages = {
            choice.rung.stage: {
                "chosen": _plain(choice.rung),
                "rejected": None if choice.rejected is None else _plain(choice.rejected),
                "reason": choice.reason,
            }
            for choice in self.choices
        }
        return {
            "budget_px": self.budget_px,
            "bound_px": _finite(self.bound_px),
            **stages,
            "condition": _finite(self.condition),
            "terrain_px_per_m": _finite(self.terrain_px_per_m),
            "left_out": [{"what": what, "why": why} for what, why in self.left_out],
        }


def _plain(rung: Rung) -> dict[str, Any]:
    return {**asdict(rung), "bound_px": _finite(rung.bound_px), "bound_m": _finite(rung.bound_m)}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def bound_text(bound_px: float) -> str:
    """A bound in two digits, rounded up so that it stays one."""
    if not (math.isfinite(bound_px) and bound_px > 0.0):
        return str(bound_px)
    unit = 10.0 ** (math.floor(math.log10(bound_px)) - 1)
    return f"{math.ceil(bound_px / unit * (1.0 - 1e-12)) * unit:.2g}"


def footprint_rungs(scene: Scene) -> list[Rung]:
    """Methods of the footprint in a scene."""
    outside = accuracy.outside_flat_domain(scene)
    # A pixel spans most ground at the corners of a level picture: its rays are slanted there by 1 + t².
    slant = 1.0 + scene.diagonal_tangent**2
    rungs = []
    for name, bound in (("loc1", accuracy.loc1_px), ("loc2", accuracy.loc2_px)):
        if outside:
            rungs.append(Rung("footprint", name, math.inf, math.inf, outside))
            continue
        px = bound(scene)
        rungs.append(Rung("footprint", name, float(np.max(px)), float(np.max(px * scene.nadir_px_m)) * slant))
    exact = float(np.max(accuracy.exact_px(scene)))
    return [*rungs, Rung("footprint", "exact", exact, exact * accuracy.ground_m_per_px(scene))]


def picture_rungs(scene: Scene, *, map_outside: str = "", camera_outside: str = "") -> list[Rung]:
    """Methods of the picture in a scene.

    Parameters
    ----------
    map_outside, camera_outside : str
        Why there is no map frame, or no camera frame, apart from what the scene itself says; or empty.
    """
    outside = map_outside or accuracy.outside_flat_domain(scene)
    if outside:
        map_frame = Rung("picture", "map", math.inf, math.inf, outside)
    else:
        px = accuracy.map_frame_px(scene)
        metres = float(np.max(px * scene.nadir_px_m)) * (1.0 + scene.diagonal_tangent**2)
        map_frame = Rung("picture", "map", float(np.max(px)), metres)
    traced = math.inf if camera_outside else float(np.max(accuracy.camera_frame_px(scene)))
    metres = traced * accuracy.ground_m_per_px(scene)
    return [map_frame, Rung("picture", "camera", traced, metres, camera_outside)]


def mesh_rungs(scene: Scene) -> list[Rung]:
    """Methods of a camera frame's reprojection: meshes by their tolerance, and a ray for every pixel."""
    noise = float(np.max(accuracy.mesh_noise_px(scene)))
    span = accuracy.ground_m_per_px(scene)
    rungs = []
    for tolerance, name in zip(MESH_TOLERANCES_PX, MESHES):
        # A mesh cannot be finer than float64 places its corners.
        outside = "" if tolerance >= noise else f"its cells' own noise is {noise:.2g} px"
        bound = math.inf if outside else tolerance
        rungs.append(Rung("mesh", name, bound, bound * span, outside))
    # A ray for every pixel adds nothing to the camera frame's own noise.
    return [*rungs, Rung("mesh", "rays", 0.0, 0.0)]


def choose(
    budget_px: float,
    ladders: Sequence[Sequence[Rung]],
    wanted: Sequence[str],
) -> tuple[list[Choice], float] | None:
    """Cheapest combination of one rung from each ladder whose bounds sum within a budget.

    Ladders come dearest first: a step on an earlier one costs more than any on the later ones (a picture that is
    resampled costs thousands of footprints), so that the cheapest is the first in the order of their products.

    Parameters
    ----------
    budget_px : float
        Infinite to take whatever has a bound.
    ladders : sequence of sequence of Rung
        From cheap to exact each.
    wanted : sequence of str
        Name of the rung each ladder is held to, or ``auto``.

    Returns
    -------
    tuple of list of Choice and float, or None
        With the sum of the bounds; None where no combination fits.

    Raises
    ------
    InvalidInput
        A rung that was asked for by name has no bound in this scene.
    """
    held = [_held(ladder, name) for ladder, name in zip(ladders, wanted)]
    chosen = _first_fit(budget_px, held)
    if chosen is None:
        return None
    total = sum(rung.bound_px for rung in chosen)
    choices = []
    for rung, ladder in zip(chosen, held):
        cheaper = ladder[0] if ladder[0] is not rung else None
        choices.append(Choice(rung, cheaper, _why_not(cheaper, total - rung.bound_px, budget_px)))
    return choices, total


def _held(ladder: Sequence[Rung], name: str) -> list[Rung]:
    if name == AUTO:
        return list(ladder)
    rung = next((rung for rung in ladder if rung.name == name), None)
    if rung is None:
        names = ", ".join(rung.name for rung in ladder)
        raise InvalidInput(f"method {name!r}: must be {AUTO} or one of {names}")
    if rung.outside:
        raise InvalidInput(f"{rung.stage} {name!r} was asked for, but has no bound here: {rung.outside}")
    return [rung]


def _first_fit(budget_px: float, ladders: Sequence[Sequence[Rung]]) -> list[Rung] | None:
    if not ladders:
        return []
    least = sum(min(rung.bound_px for rung in ladder) for ladder in ladders[1:])
    for rung in ladders[0]:
        if rung.outside or rung.bound_px + least > budget_px:
            continue
        rest = _first_fit(budget_px - rung.bound_px, ladders[1:])
        if rest is not None:
            return [rung, *rest]
    return None


def _why_not(rung: Rung | None, others_px: float, budget_px: float) -> str:
    if rung is None:
        return ""
    return rung.outside or too_much(rung.bound_px, others_px, budget_px)


def too_much(bound_px: float, others_px: float, budget_px: float) -> str:
    """Why a bound was rejected."""
    return (
        f"its bound of {bound_text(bound_px)} px and {bound_text(others_px)} px of the other stages exceed the "
        f"budget of {budget_px:g} px"
    )
