"""Which method each stage of a plan uses: the cheapest whose bounds together fit the error budget, and why."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..errors import InvalidInput, Message, OptionName
from ..geodesy import accuracy
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.camera import Poses
from ..geodesy.frames import own_frame_px, runs_on
from ..geodesy.mercator import PixelGrid
from ..geodesy.planes import ProjectedPlane
from ..geodesy.view import ImageRays, mesh_serves
from .areas.area import ANGLES, Points
from .layout.framing import (
    CameraFraming,
    Disturbed,
    Framed,
    MapFraming,
    check_sizes,
    check_windows,
    framed,
    ground_ellipsoid,
)
from .layout.rotated import is_rotated
from .layout.rows import point_angles_deg
from .mission import Mission
from .parts import NORTH, RAYS
from .relief.ground import Relief

#: Coarsest mesh, px: larger cells save nothing, and kernels have one pixel to spare (`view.KERNEL_REACH_PX`).
COARSEST_MESH_PX = 1.0
#: Share of the budget that is left for the rounding of the bounds' sum.
_ROUNDING = 1e-12


#: Stages of a plan.
_FOOTPRINT, _PICTURE, _PIXELS = Message("footprint"), Message("image"), Message("pixels")
_NOTHING = Message("nothing")
_NO_CAMERA_FRAME = Message("the source gives images by their centre, not tiles that others can be made from")
_WIND = Message("wind turns the camera")
_ROTATED = Message("the rows are turned from east, and the camera with them")


@dataclass(frozen=True)
class Method:
    """A way of doing a stage, and what it may be wrong by in one scene.

    Attributes
    ----------
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
    """What a stage uses, and the cheaper method that was rejected with the reason; None where there was none."""

    method: Method
    rejected: Method | None = None
    reason: str = ""


@dataclass(frozen=True)
class ChosenMethods:
    """What a plan chose, and what it may be wrong by.

    Attributes
    ----------
    footprint, picture : Choice
        Footprints are always those of the exact camera.
    pixels : Choice or None
        How the ground under each pixel of a camera frame is worked out.
    condition : float
        Condition number of the scene; infinite where the horizon is in the picture.
    terrain_px_per_m : float
        Displacement per metre of relief, which is not modelled and not in the bound.
    left_out : tuple of (str, str)
        What the scene does not need, and why.
    relief : str
        What heights pictures are made over; empty where the ground is level.
    """

    budget_px: float
    footprint: Choice
    picture: Choice
    pixels: Choice | None
    condition: float
    terrain_px_per_m: float
    left_out: tuple[tuple[str, str], ...]
    relief: str = ""

    @property
    def choices(self) -> tuple[Choice, ...]:
        """Of each stage that the plan has."""
        return tuple(choice for choice in (self.footprint, self.picture, self.pixels) if choice is not None)

    @property
    def bound_px(self) -> float:
        """Sum of the stages' bounds."""
        return sum(choice.method.bound_px for choice in self.choices)

    @property
    def mesh_tolerance_px(self) -> float:
        """What a cell of the mesh may be wrong by; 0 for rays and where there is no mesh."""
        return self.pixels.method.bound_px if self.pixels is not None else 0.0

    def lines(self) -> list[tuple[str, str]]:
        """Label and value of what was chosen and why, in words for people."""
        lines = []
        for choice in self.choices:
            name, bound, rejected = choice.method.name, bound_text(choice.method.bound_px), choice.rejected
            text = (
                Message("{0}, ≤ {1} px", name, bound)
                if rejected is None
                else Message("{0}, ≤ {1} px (not {2}: {3})", name, bound, rejected.name, choice.reason)
            )
            lines.append((Message("method of {0}", choice.method.stage), text))
        left_out = Message.joined("; ", [Message("{0} ({1})", what, why) for what, why in self.left_out])
        return [
            *lines,
            (
                Message("error"),
                Message("≤ {0} px of a budget of {1:g} px", bound_text(self.bound_px), self.budget_px),
            ),
            (Message("left out"), left_out or _NOTHING),
            (Message("terrain"), self.terrain_text()),
            (Message("condition number"), self.condition_text()),
        ]

    def condition_text(self) -> Message:
        """Condition number of the scene."""
        if not math.isfinite(self.condition):
            return Message("infinite (horizon)")
        return Message("{0:.3g}", self.condition)

    def terrain_text(self) -> Message:
        """What relief may add, or what is wrong with the heights of it."""
        if self.relief and math.isfinite(self.terrain_px_per_m):
            return Message(
                "{0}; up to {1:.2g} px per metre that its heights are off", self.relief, self.terrain_px_per_m
            )
        if self.relief:
            return Message("{0}", self.relief)
        if not math.isfinite(self.terrain_px_per_m):
            return Message("not bounded, without limit at the horizon")
        return Message("not bounded, up to {0:.2g} px per metre of relief", self.terrain_px_per_m)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping; what is infinite is null."""
        stages = {
            choice.method.stage: {
                "chosen": _plain(choice.method),
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
            **({"relief": self.relief} if self.relief else {}),
        }


def _plain(method: Method) -> dict[str, Any]:
    return {**asdict(method), "bound_px": _finite(method.bound_px), "bound_m": _finite(method.bound_m)}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def bound_text(bound_px: float) -> Message:
    """A bound in two digits, rounded up so that it stays one."""
    if not (math.isfinite(bound_px) and bound_px > 0.0):
        return Message("{0}", bound_px)
    unit = 10.0 ** (math.floor(math.log10(bound_px)) - 1)
    return Message("{0:.2g}", math.ceil(bound_px / unit * (1.0 - 1e-12)) * unit)


def exact_footprint(scene: ImageGeometry) -> Method:
    """Footprints of the exact camera."""
    bound_px = float(np.max(accuracy.exact_px(scene)))
    return Method(_FOOTPRINT, "exact", bound_px, bound_px * accuracy.ground_m_per_px(scene))


def map_frame(scene: ImageGeometry, outside: str = "", own: ProjectedPlane | None = None) -> Method:
    """Pictures that are rectangles of the map, or of a plane of the source's own.

    Parameters
    ----------
    outside : str
        Why there are none, apart from what the scene itself says; or empty.
    """
    bend = None if own is None else own.greatest_bend(scene.poses.lat_deg, scene.poses.lon_deg)
    outside = outside or accuracy.outside_flat_domain(scene, bend)
    if outside:
        return Method(_PICTURE, "map", math.inf, math.inf, outside)
    px = accuracy.map_frame_px(scene) if own is None or bend is None else own_frame_px(scene, own, bend)
    # A pixel spans most ground at the corners of a level picture: its rays are slanted there by 1 + t².
    metres = float(np.max(px * scene.nadir_px_m)) * (1.0 + scene.diagonal_tangent**2)
    return Method(_PICTURE, "map", float(np.max(px)), metres)


def camera_frame(scene: ImageGeometry, outside: str = "") -> Method:
    """Pictures as the camera sees them; ``outside`` says why there are none, or is empty."""
    traced = math.inf if outside else float(np.max(accuracy.camera_frame_px(scene)))
    return Method(_PICTURE, "camera", traced, traced * accuracy.ground_m_per_px(scene), outside)


def mesh(scene: ImageGeometry, tolerance_px: float) -> Method:
    """Pixels of a camera frame placed by a mesh as coarse as a tolerance allows, or else as fine as a mesh can be."""
    # A mesh finer than twice the rounding of its corners leaves most pixels to rays anyway.
    finest = 2.0 * float(np.max(accuracy.mesh_noise_px(scene)))
    bound_px = max(min(tolerance_px, COARSEST_MESH_PX), finest)
    return Method(_PIXELS, "mesh", bound_px, bound_px * accuracy.ground_m_per_px(scene))


#: What rays over relief may be off by, px: finer costs hardly more.
_OVER_RELIEF_PX = 0.02


def relief_rays(scene: ImageGeometry, tolerance_px: float) -> Method:
    """Pixels of a camera frame placed by a ray each, as far as the first point of the relief that it meets."""
    bound_px = min(max(tolerance_px, 0.0), _OVER_RELIEF_PX) or _OVER_RELIEF_PX
    return Method(_PIXELS, "relief", bound_px, bound_px * accuracy.ground_m_per_px(scene))


#: A ray for every pixel adds nothing to the camera frame's own noise.
TRACED = Method(_PIXELS, RAYS, 0.0, 0.0)


def choose_methods(
    mission: Mission, grid: PixelGrid, disturbed: Disturbed, relief: Relief
) -> tuple[Framed, ChosenMethods]:
    """Frame a mission with the cheapest methods whose bounds sum within its error budget.

    A map frame is the cheapest picture, as nothing is resampled; a camera frame by a mesh that is as coarse as the
    budget allows is cheaper than one with a ray for every pixel. Over relief pixels are traced to the first point that
    they see.

    Raises
    ------
    InvalidInput
        Where none fit and the mission does not accept that; where a method that it names has no bound; and as `plan`
        does.
    """
    no_camera_frame = _NO_CAMERA_FRAME if grid.centre_decimals is not None else ""
    picture: Choice | None = None
    if mission.accuracy.frame != "camera":
        outside = _no_map_frame(mission, grid, relief)
        if not outside:
            flown = framed(mission, grid, MapFraming(mission, grid), disturbed, relief)
            check_sizes(flown, mission, grid)
            try:
                check_windows(flown, mission, grid)
            except InvalidInput as wrong:
                if mission.accuracy.frame == "map" or no_camera_frame:
                    raise
                # A camera's image has no such limits, or is refused for its own.
                outside = wrong.message
        if not outside:
            scene = _resolved(image_geometry(mission, flown, grid))
            found, footprint = map_frame(scene, own=grid.own), exact_footprint(scene)
            fits = found.bound_px + footprint.bound_px <= mission.accuracy.error_budget_px
            if fits or mission.accuracy.frame == "map" or no_camera_frame:
                return flown, _accuracy(mission, grid, scene, Choice(footprint), Choice(found), None)
            reason = _too_much(found.bound_px, footprint.bound_px, mission.accuracy.error_budget_px)
        elif mission.accuracy.frame == "map":
            raise InvalidInput("image 'map' was asked for, but has no bound here: {0}", outside, field="frame")
        else:
            found, reason = Method(_PICTURE, "map", math.inf, math.inf, outside), outside
        picture = Choice(found, found, reason)
    if no_camera_frame:
        raise InvalidInput(
            "image as the camera sees it: {0}",
            no_camera_frame,
            field="source",
            remedy="choose a source of tiles",
        )
    flown = framed(mission, grid, CameraFraming(mission, grid), disturbed, relief)
    check_windows(flown, mission, grid)
    scene = _resolved(image_geometry(mission, flown, grid))
    found, footprint = camera_frame(scene), exact_footprint(scene)
    picture = Choice(found) if picture is None else Choice(found, picture.rejected, picture.reason)
    others_px = found.bound_px + footprint.bound_px
    if relief.is_level:
        pixels = choose_pixels(mission, scene, others_px)
    else:
        pixels = Choice(relief_rays(scene, mission.accuracy.error_budget_px * (1.0 - _ROUNDING) - others_px))
    made = _accuracy(mission, grid, scene, Choice(footprint), picture, pixels)
    return flown, replace(made, relief=relief.text())


def _no_map_frame(mission: Mission, grid: PixelGrid, relief: Relief) -> str:
    """Why a mission has no map frames whatever its budget; empty where it may have some."""
    if not relief.is_level:
        return Message(
            "the ground is from {0:.1f} to {1:.1f} m high, and seen from aside",
            relief.lowest_m,
            relief.highest_m,
        )
    if is_rotated(mission) and not _is_quarter_turned(mission, grid):
        return _ROTATED
    if mission.wind is not None and mission.wind.sigma_m_per_s > 0.0:
        return _WIND
    return accuracy.outside_flat_domain(_ends(mission), None if grid.plane.wraps else 0.0)


def _is_quarter_turned(mission: Mission, grid: PixelGrid) -> bool:
    """Whether images of turned rows may lie by quarter turns on the map, but for a plane's convergence.

    North-up cameras, which turn with their rows, made camera frames of all turned rows on the map before others did.
    """
    # On the grid of a source's CRS, images of rows at quarter turns may be map frames.
    if mission.flight.row_azimuth_deg % 90.0:
        return False
    return not grid.plane.wraps or mission.flight.facing != NORTH


def choose_pixels(mission: Mission, scene: ImageGeometry, others_px: float) -> Choice:
    """Mesh or rays of a mission's camera frames: a mesh as coarse as the other stages' bounds leave of the budget."""
    if mission.accuracy.mesh == RAYS:
        return Choice(TRACED)
    left_px = mission.accuracy.error_budget_px * (1.0 - _ROUNDING) - others_px
    found = mesh(scene, left_px)
    if found.bound_px <= left_px:
        return Choice(found)
    return Choice(TRACED, found, _too_much(found.bound_px, others_px, mission.accuracy.error_budget_px))


def image_geometry(mission: Mission, flown: Framed, grid: PixelGrid) -> ImageGeometry:
    """What the bounds of a framed mission depend on, once for each run of poses that share it."""
    first, _ = flown.frames.runs(runs_on(grid, flown.poses))
    width, height = flown.frames.scene_sizes_px(flown.windows, first)
    return ImageGeometry(mission.camera, width, height, flown.poses.take(first), ground_ellipsoid(mission))


def _resolved(scene: ImageGeometry) -> ImageGeometry:
    """A scene whose pixels float64 resolves; raises InvalidInput where they are finer."""
    finest = float(np.min(accuracy.finest_px_m(scene)))
    if finest < accuracy.RESOLVED_M:
        raise InvalidInput(
            "pixels of {0:.2g} m on the ground: degrees in float64 resolve {1:g} m",
            finest,
            accuracy.RESOLVED_M,
            field="agl_m",
            remedy="fly higher or widen the field of view",
        )
    return scene


def _ends(mission: Mission) -> ImageGeometry:
    """ImageGeometry of the captures whose flat model is stretched most, before any is placed; of any image size."""
    area = mission.area
    if isinstance(area, Points):
        lat, _, agl = np.array(area.poses, np.float64).reshape(-1, 3).T
        attitude = [point_angles_deg(mission, area, name) for name in ANGLES]
    else:
        lat = np.array([area.bounds.north_deg, area.bounds.south_deg])
        agl = np.full(2, mission.flight.agl_m)
        attitude = [
            np.broadcast_to(np.float64(angle), 2)
            for angle in (mission.attitude.yaw_deg, mission.attitude.tilt_deg, mission.attitude.roll_deg)
        ]
    return ImageGeometry(
        mission.camera,
        1.0,
        1.0,
        Poses(lat, np.zeros_like(lat), agl, *attitude),
        ground_ellipsoid(mission),
    )


def _accuracy(
    mission: Mission,
    grid: PixelGrid,
    scene: ImageGeometry,
    footprint: Choice,
    picture: Choice,
    pixels: Choice | None,
) -> ChosenMethods:
    """What was chosen; raises InvalidInput where its bounds exceed the budget and the mission does not accept that."""
    made = ChosenMethods(
        budget_px=mission.accuracy.error_budget_px,
        footprint=footprint,
        picture=picture,
        pixels=pixels,
        condition=accuracy.condition_number(scene, on_mercator=grid.plane.wraps),
        terrain_px_per_m=accuracy.terrain_px_per_m(scene),
        left_out=tuple(_left_out(mission, scene, picture.method, pixels)),
    )
    budget, total = made.budget_px, made.bound_px
    if total > budget and not mission.accuracy.accept_error:
        chosen = (choice.method for choice in (picture, pixels) if choice is not None)
        methods = Message.joined(", ", [Message("{0} {1}", method.stage, method.name) for method in chosen])
        raise InvalidInput(
            "error budget {0:g} px: no methods fit; the closest are {1} with {2} px, {3} times as much",
            budget,
            methods,
            bound_text(total),
            bound_text(total / budget),
            field="error_budget_px",
            remedy=Message("raise {0}, or go on with {1}", OptionName("error_budget"), OptionName("accept_error")),
        )
    return made


def _left_out(mission: Mission, scene: ImageGeometry, picture: Method, pixels: Choice | None) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    if picture.name == "map":
        found.append((Message("resampling"), Message("a map frame shows the source's own pixels")))
    if pixels is not None and pixels.method.name == "mesh" and _mesh_serves(scene, pixels.method.bound_px):
        found.append(
            (
                Message("rays for every pixel"),
                Message("the mesh's bound of {0} px fits", bound_text(pixels.method.bound_px)),
            )
        )
    if mission.wind is None or mission.wind.sigma_m_per_s == 0.0:
        found.append(
            (
                Message("wind"),
                Message("air without gusts was asked for") if mission.wind else Message("still air was asked for"),
            )
        )
    return found


def _mesh_serves(scene: ImageGeometry, tolerance_px: float) -> bool:
    """Whether a mesh is of use in the first image at least: from very high, every pixel has a ray of its own."""
    width, height = (float(np.ravel(side)[0]) for side in (scene.width_px, scene.height_px))
    one = ImageGeometry(scene.camera, width, height, scene.poses.take(slice(0, 1)), scene.ground)
    return mesh_serves(ImageRays.of(one), tolerance_px)


def _too_much(bound_px: float, others_px: float, budget_px: float) -> str:
    """Why a bound was rejected."""
    return Message(
        "its bound of {0} px and {1} px of the other stages exceed the budget of {2:g} px",
        bound_text(bound_px),
        bound_text(others_px),
        budget_px,
    )
