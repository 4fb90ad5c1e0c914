"""Zone plates: a source of exact means, and the exact mean over what each pixel of a camera covers."""

from __future__ import annotations

import numpy as np
from scipy.special import fresnel
from terrainav.core.camera.light import encoded, linear
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.mercator import PixelGrid, lat_to_v, lon_to_u
from terrainav.core.geodesy.view import ImageRays
from terrainav.core.picture.camera_frame import parts_of_tiles
from terrainav.core.picture.shot import draw, make_shot

LAT, LON = 35.14, -89.86
GRID = PixelGrid()
#: Metres around the world at the latitude.
_AROUND_M = 2.0 * np.pi * 6378137.0 * np.cos(np.radians(LAT))


class ZonePlate:
    """Rings of linear light around a place ahead: cos(π k r²), r in metres, whose frequency is k r per metre."""

    def __init__(self, per_m2, ahead_m=0.0):
        self.k = per_m2 * _AROUND_M**2
        self.u, self.v = float(lon_to_u(np.array(LON))), float(lat_to_v(np.array(LAT))) - ahead_m / _AROUND_M

    def light(self, u, v):
        return 0.5 + 0.5 * np.cos(np.pi * self.k * ((u - self.u) ** 2 + (v - self.v) ** 2))

    def fetch(self, window):
        """Tile of the exact means of its pixels: the integral of exp(iπkr²) over a box is a product of two."""
        world = float(GRID.world_px(window.zoom))
        along_x = self._means((window.left_px + np.arange(window.width_px + 1)) / world - self.u)
        along_y = self._means((window.top_px + np.arange(window.height_px + 1)) / world - self.v)
        light = 0.5 + 0.5 * (along_y[:, np.newaxis] * along_x).real
        return np.repeat(np.rint(255.0 * encoded(light))[..., np.newaxis], 3, axis=2).astype(np.uint8)

    def _means(self, edges):
        """Means of exp(iπkx²) between edges, by Fresnel's integrals."""
        sine, cosine = fresnel(edges * np.sqrt(2.0 * self.k))
        return np.diff(cosine + 1j * sine) / (np.diff(edges) * np.sqrt(2.0 * self.k))

    def picture(self, planned):
        """Linear light of a plan's first picture, (h, w)."""
        shot = make_shot(planned, 0)
        parts = parts_of_tiles(planned.grid, shot.tiles)
        drawn = draw(shot, parts, {part.window: self.fetch(part.window) for part in parts}).pixels
        return linear(drawn[..., 0] / 255.0)

    def truth(self, planned, across, down):
        """Means over the pixels by dense rays, (h, w); NaN where a part of a pixel is sky."""
        width, height = planned.views.size_px(0)
        pose = planned.poses.take(slice(0, 1))
        rays = ImageRays.from_scene(ImageGeometry(planned.mission.camera, width, height, pose, planned.ground))
        found = np.full((height, width), np.nan)
        x = (np.arange(width * across) + 0.5) / across
        for row in range(height):
            y = row + (np.arange(down) + 0.5) / down
            du, v, hit = rays.map_points(x[np.newaxis, :], y[:, np.newaxis])
            if hit.all():
                light = self.light(float(lon_to_u(np.array(LON))) + du, v)
                found[row] = light.reshape(down, width, across).mean(axis=(0, 2))
        return found
