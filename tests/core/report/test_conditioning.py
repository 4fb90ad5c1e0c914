"""Curves of condition numbers beside the closed form over flat ground."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report.conditioning import conditioning
from terrainav.core.world import WorldSource


@pytest.mark.parametrize("tilt_deg", [0.0, 45.0])
def test_curves_are_those_of_flat_ground_near_it_and_end_at_the_horizon(tilt_deg):
    worked_out = plan(Mission(Points(((35.0, 10.0, 120.0),)), 120.0, tilt_deg=tilt_deg), WorldSource().grid)
    found = conditioning(worked_out)
    assert (found.height_m, found.tilt_deg) == (120.0, tilt_deg)
    tan_x, tan_y = worked_out.mission.camera.half_tangents
    own = found.over_tilt[0]
    # The upper corners look farthest off nadir: a ray (x, y, 1) tilted about the axis of x.
    tilt = np.radians(own.x)
    off_nadir = np.arccos((np.cos(tilt) - tan_y * np.sin(tilt)) / np.sqrt(1.0 + tan_x**2 + tan_y**2))
    # Ground at h tan(a): its relative change per relative change of the angle is a / (sin a cos a).
    flat = np.maximum(off_nadir / (np.sin(off_nadir) * np.cos(off_nadir)), 1.0 / np.cos(np.radians(35.0)))
    far_from_it = np.degrees(off_nadir) < 80.0
    np.testing.assert_allclose(own.condition[far_from_it], flat[far_from_it], rtol=1e-3)
    assert np.isnan(own.condition[off_nadir > np.pi / 2.0]).all()
    # The same scene lies on curves of both kinds.
    at_height = np.interp(120.0, found.over_height[0].x, found.over_height[0].condition)
    assert at_height == pytest.approx(np.interp(tilt_deg, own.x, own.condition), rel=1e-3)
    assert at_height == pytest.approx(worked_out.accuracy.condition, rel=1e-3)
