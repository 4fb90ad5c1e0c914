"""Ground sample distances of a plan: requested, planned, written, of the source, and of the camera."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..geodesy.camera import Poses
from ..geodesy.mercator import PixelGrid
from .layout.frames import Frames, camera_gsd_m_per_px
from .mission import Mission


@dataclass(frozen=True, eq=False)
class Resolution:
    """Median ground sample distances of the captures.

    Attributes
    ----------
    zoom : int
        Zoom of the plan.
    poses, meant : Poses
        Poses as flown, and as planned, (n,).
    """

    mission: Mission
    grid: PixelGrid
    zoom: int
    frames: Frames
    poses: Poses
    meant: Poses

    @cached_property
    def requested_m_per_px(self) -> float:
        """Distance that the mission requests, else the distance of the camera's image looking straight down."""
        pixels = self.mission.pixels
        if pixels.gsd_m_per_px is not None:
            return pixels.gsd_m_per_px
        return self.mission.camera.gsd_m_per_px(float(np.median(self.meant.agl_m)), pixels.image_px)

    @cached_property
    def picture_m_per_px(self) -> float:
        """Distance of the planned pictures: of the zoom's pixels, or of camera frames looking straight down."""
        return self.frames.gsd_m_per_px(self.mission, self.poses, self.grid, self.zoom)

    @cached_property
    def delivered_m_per_px(self) -> float:
        """Distance of the written images along their longer side, after any resizing."""
        size, frames = self.mission.output.img_size, self.frames
        if size is None:
            return self.picture_m_per_px
        wide = self.mission.camera.aspect_ratio >= 1.0
        planned, written = (frames.width_px, size[0]) if wide else (frames.height_px, size[1])
        return self.picture_m_per_px * float(np.median(planned)) / written

    @cached_property
    def source_m_per_px(self) -> float:
        """Distance of the finest pixels that the source has."""
        grid, poses = self.grid, self.poses
        return float(np.median(grid.ground_m_per_px(poses.lat_deg, poses.lon_deg, grid.native_zoom)))

    @cached_property
    def camera_m_per_px(self) -> float:
        """Distance of the exact camera with as many pixels as its picture."""
        return camera_gsd_m_per_px(self.mission, self.poses, self.frames)
