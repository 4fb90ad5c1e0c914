"""Choose the method of each stage of a plan: the cheapest whose bounds together fit the error budget."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..errors import InvalidInput, Message, OptionName
from ..geodesy import accuracy
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.camera import Poses
from ..geodesy.ellipsoid import Ellipsoid
from ..geodesy.frames import plane_frame_px, plane_runs
from ..geodesy.mercator import MERCATOR, PixelGrid, Plane
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
from .layout.rows import point_angles_deg, turns_at_random
from .mission import Mission
from .parts import NORTH, RAYS
from .relief.ground import Relief

#: Largest error of a mesh, px: coarser cells save nothing, and kernels have one pixel to spare
#: (`view.KERNEL_REACH_PX`).
COARSEST_MESH_PX = 1.0
_PICTURE, _PIXELS = Message("image"), Message("pixels")


@dataclass(frozen=True)
class Method:
    """A method of a stage, with the bound of its error in one scene.

    Attributes
    ----------
    bound_px : float
        Infinite where the method has no bound.
    bound_m : float
        The bound on the ground, at the pixel that spans most of it.
    outside : str
        Why the method has no bound here; else empty.
    """

    stage: str
    name: str
    bound_px: float
    bound_m: float
    outside: str = ""


@dataclass(frozen=True)
class Choice:
    """The method of a stage, and the cheaper method that was rejected for a reason, if any."""

    method: Method
    rejected: Method | None = None
    reason: str = ""


@dataclass(frozen=True)
class ChosenMethods:
    """The methods of a plan, and the bounds of their errors.

    Attributes
    ----------
    footprint, picture : Choice
        The method of footprints is always the exact camera.
    pixels : Choice or None
        Method that finds the ground under each pixel of a camera frame; None for map frames.
    condition : float
        Condition number of the scene; infinite where the horizon is in the image.
    terrain_px_per_m : float
        Displacement per metre of height that is not modelled; not part of the bound.
    left_out : tuple of (str, str)
        Work that the scene does not need, and why.
    relief : str
        Description of the relief; empty over level ground.
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
        """Choices of the stages that the plan has."""
        return tuple(choice for choice in (self.footprint, self.picture, self.pixels) if choice is not None)

    @property
    def bound_px(self) -> float:
        """Sum of the stages' bounds."""
        return sum(choice.method.bound_px for choice in self.choices)

    @property
    def mesh_tolerance_px(self) -> float:
        """Bound of the error of pixel positions; 0 for one ray per pixel and for map frames."""
        return self.pixels.method.bound_px if self.pixels is not None else 0.0

    def lines(self) -> list[tuple[str, str]]:
        """Label and value of each choice with its reason, for people."""
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
            (Message("left out"), left_out or Message("nothing")),
            (Message("terrain"), self.terrain_text()),
            (Message("condition number"), self.condition_text()),
        ]

    def condition_text(self) -> Message:
        """Condition number of the scene."""
        if not math.isfinite(self.condition):
            return Message("infinite (horizon)")
        return Message("{0:.3g}", self.condition)

    def terrain_text(self) -> Message:
        """Error that relief, or errors of its heights, may add."""
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
        """JSON-ready mapping; infinite numbers become null."""
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
    """A bound in two digits, rounded up so that it still holds."""
    if not (math.isfinite(bound_px) and bound_px > 0.0):
        return Message("{0}", bound_px)
    unit = 10.0 ** (math.floor(math.log10(bound_px)) - 1)
    return Message("{0:.2g}", math.ceil(bound_px / unit * (1.0 - 1e-12)) * unit)


def exact_footprint(scene: ImageGeometry) -> Method:
    """Method of footprints: as the exact camera sees them."""
    bound_px = float(np.max(accuracy.exact_px(scene)))
    return Method(Message("footprint"), "exact", bound_px, bound_px * accuracy.ground_m_per_px(scene))


def map_frame(scene: ImageGeometry, outside: str = "", plane: Plane = MERCATOR) -> Method:
    """Method of pictures that are rectangles of the map, or of the plane of the source's CRS.

    Parameters
    ----------
    outside : str
        Reason against map frames that does not follow from the scene; else empty.
    """
    bend = plane.frame_bend(scene.poses.lat_deg, scene.poses.lon_deg)
    outside = outside or accuracy.outside_flat_domain(scene, bend)
    if outside:
        return Method(_PICTURE, "map", math.inf, math.inf, outside)
    px = plane_frame_px(scene, plane, bend)
    # Pixels span most ground at the corners of a level picture, where slanted rays stretch them by 1 + t².
    metres = float(np.max(px * scene.nadir_px_m)) * (1.0 + scene.diagonal_tangent**2)
    return Method(_PICTURE, "map", float(np.max(px)), metres)


def camera_frame(scene: ImageGeometry, outside: str = "") -> Method:
    """Method of pictures as the camera sees them; ``outside`` is a reason against such pictures, or empty."""
    traced = math.inf if outside else float(np.max(accuracy.camera_frame_px(scene)))
    return Method(_PICTURE, "camera", traced, traced * accuracy.ground_m_per_px(scene), outside)


def mesh(scene: ImageGeometry, tolerance_px: float) -> Method:
    """Method that places the pixels of a camera frame by a mesh, as coarse as the tolerance allows."""
    # A mesh finer than twice the rounding of its corners would leave most pixels to rays.
    finest = 2.0 * float(np.max(accuracy.mesh_noise_px(scene)))
    bound_px = max(min(tolerance_px, COARSEST_MESH_PX), finest)
    return Method(_PIXELS, "mesh", bound_px, bound_px * accuracy.ground_m_per_px(scene))


def relief_rays(scene: ImageGeometry, tolerance_px: float) -> Method:
    """Method that places each pixel of a camera frame where its ray first meets the relief."""
    # Rays coarser than this are hardly faster.
    coarsest_px = 0.02
    bound_px = min(max(tolerance_px, 0.0), coarsest_px) or coarsest_px
    return Method(_PIXELS, "relief", bound_px, bound_px * accuracy.ground_m_per_px(scene))


#: One ray per pixel adds nothing to the noise of the camera frame.
TRACED = Method(_PIXELS, RAYS, 0.0, 0.0)


def choose_methods(
    mission: Mission, grid: PixelGrid, disturbed: Disturbed, relief: Relief
) -> tuple[Framed, ChosenMethods]:
    """Frame a mission with the cheapest methods whose bounds sum to no more than its error budget.

    A map frame is the cheapest picture, as nothing is resampled; a mesh as coarse as the budget allows is cheaper than
    one ray per pixel. Over relief, each pixel is traced to the first point that it sees.

    Raises
    ------
    InvalidInput
        No methods fit the budget, and the mission does not accept to exceed it; the mission asks for a method without
        a bound; or as `plan` raises it.
    """
    no_camera_frame = ""
    if grid.centre_decimals is not None:
        no_camera_frame = Message("the source gives images by their centre, not tiles that others can be made from")
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
                # Camera frames have other limits.
                outside = wrong.message
        if not outside:
            (scene,) = scenes = _resolved(image_geometries(flown, grid, ground_ellipsoid(mission)))
            found, footprint = map_frame(scene, plane=grid.plane), exact_footprint(scene)
            fits = found.bound_px + footprint.bound_px <= mission.accuracy.error_budget_px
            if fits or mission.accuracy.frame == "map" or no_camera_frame:
                return flown, _gather(mission, grid, scenes, Choice(footprint), Choice(found), None)
            reason = _rejection(found.bound_px, footprint.bound_px, mission.accuracy.error_budget_px)
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
    return flown, camera_methods(mission, grid, flown, relief, picture)


def camera_methods(
    mission: Mission, grid: PixelGrid, flown: Framed, relief: Relief, rejected: Choice | None = None
) -> ChosenMethods:
    """Methods of camera frames, and the choice that was rejected for them; raises InvalidInput as `choose_methods`."""
    check_windows(flown, mission, grid)
    scenes = _resolved(image_geometries(flown, grid, ground_ellipsoid(mission)))
    found, footprint = _worst(map(camera_frame, scenes)), _worst(map(exact_footprint, scenes))
    picture = Choice(found) if rejected is None else Choice(found, rejected.rejected, rejected.reason)
    others_px = found.bound_px + footprint.bound_px
    if relief.is_level:
        pixels = choose_pixels(mission, scenes, others_px)
    else:
        left_px = _remaining_px(mission, others_px)
        pixels = Choice(_worst(relief_rays(scene, left_px) for scene in scenes))
    made = _gather(mission, grid, scenes, Choice(footprint), picture, pixels)
    return replace(made, relief=relief.text())


def _no_map_frame(mission: Mission, grid: PixelGrid, relief: Relief) -> str:
    """Reason why a mission cannot have map frames whatever its budget; empty where it may."""
    if not mission.camera.is_ideal:
        return Message("the lens distorts images, which windows of a map do not")
    if mission.varied.of_lens:
        return Message("each image has a lens of its own, which windows of a map do not")
    if not relief.is_level:
        return Message(
            "the ground is from {0:.1f} to {1:.1f} m high, and seen from aside",
            relief.lowest_m,
            relief.highest_m,
        )
    if mission.takes_time:
        return Message("the camera moves on while an image is taken")
    if is_rotated(mission) and not _is_quarter_turned(mission, grid):
        return Message("the rows are turned from east, and the camera with them")
    if mission.wind is not None and mission.wind.sigma_m_per_s > 0.0:
        return Message("wind turns the camera")
    if turns_at_random(mission) or mission.varied.turns_images:
        return Message("images are turned at random")
    return accuracy.outside_flat_domain(_extreme_geometry(mission), None if grid.plane.wraps else 0.0)


def _is_quarter_turned(mission: Mission, grid: PixelGrid) -> bool:
    """Whether images of rotated rows may be map frames: at quarter turns, apart from a plane's convergence.

    On the map, cameras that face north and turn with their rows always make camera frames.
    """
    if mission.flight.row_azimuth_deg % 90.0:
        return False
    return not grid.plane.wraps or mission.flight.facing != NORTH


def choose_pixels(mission: Mission, scenes: Sequence[ImageGeometry], others_px: float) -> Choice:
    """Choose a mesh that fits the budget less ``others_px``, the bounds of the other stages, or one ray per pixel."""
    if mission.accuracy.mesh == RAYS:
        return Choice(TRACED)
    left_px = _remaining_px(mission, others_px)
    found = _worst(mesh(scene, left_px) for scene in scenes)
    if found.bound_px <= left_px:
        return Choice(found)
    return Choice(TRACED, found, _rejection(found.bound_px, others_px, mission.accuracy.error_budget_px))


def _remaining_px(mission: Mission, others_px: float) -> float:
    """Part of the error budget that the other stages leave, less the rounding of the bounds' sum."""
    return mission.accuracy.error_budget_px * (1.0 - 1e-12) - others_px


def image_geometries(flown: Framed, grid: PixelGrid, ground: Ellipsoid) -> tuple[ImageGeometry, ...]:
    """Geometries that the bounds of a framed mission depend on, one for each camera.

    Of poses that differ in longitude only, there is one.
    """
    first = np.arange(len(flown.poses.lat_deg))
    if not flown.cameras.vary:
        first, _ = flown.frames.runs(plane_runs(grid, flown.poses))
    (width, height), poses = flown.frames.scene_sizes_px(flown.windows, first), flown.poses.take(first)
    return tuple(
        ImageGeometry(camera, width[which], height[which], poses.take(which), ground)
        for camera, which in flown.cameras.groups()
    )


def _worst(methods: Iterable[Method]) -> Method:
    """A method with the greatest bounds of several scenes."""
    each = list(methods)
    return replace(each[0], bound_px=max(one.bound_px for one in each), bound_m=max(one.bound_m for one in each))


def _resolved(scenes: tuple[ImageGeometry, ...]) -> tuple[ImageGeometry, ...]:
    """Return the scenes if float64 resolves their pixels, else raise InvalidInput."""
    finest = min(float(np.min(accuracy.finest_px_m(scene))) for scene in scenes)
    if finest < accuracy.RESOLVED_M:
        raise InvalidInput(
            "pixels of {0:.2g} m on the ground: degrees in float64 resolve {1:g} m",
            finest,
            accuracy.RESOLVED_M,
            field="agl_m",
            remedy="fly higher or widen the field of view",
        )
    return scenes


def _extreme_geometry(mission: Mission) -> ImageGeometry:
    """Geometry of the captures that the flat model may stretch most, before any is placed; image sizes are nominal."""
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


def _gather(
    mission: Mission,
    grid: PixelGrid,
    scenes: Sequence[ImageGeometry],
    footprint: Choice,
    picture: Choice,
    pixels: Choice | None,
) -> ChosenMethods:
    """Gather the choices; raises InvalidInput if their bounds exceed a budget that the mission does not relax."""
    made = ChosenMethods(
        budget_px=mission.accuracy.error_budget_px,
        footprint=footprint,
        picture=picture,
        pixels=pixels,
        condition=max(accuracy.condition_number(scene, on_mercator=grid.plane.wraps) for scene in scenes),
        terrain_px_per_m=max(map(accuracy.terrain_px_per_m, scenes)),
        left_out=tuple(_left_out(mission, scenes[0], picture.method, pixels)),
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
    """Work that the scene does not need, and why."""
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
    """Whether the mesh saves rays in the first image; from very high, every pixel needs a ray."""
    width, height = (float(np.ravel(side)[0]) for side in (scene.width_px, scene.height_px))
    one = ImageGeometry(scene.camera, width, height, scene.poses.take(slice(0, 1)), scene.ground)
    return mesh_serves(ImageRays.from_scene(one), tolerance_px)


def _rejection(bound_px: float, others_px: float, budget_px: float) -> str:
    """Reason why a bound was rejected."""
    return Message(
        "its bound of {0} px and {1} px of the other stages exceed the budget of {2:g} px",
        bound_text(bound_px),
        bound_text(others_px),
        budget_px,
    )
