"""Live cameras over known ground, and random poses for them."""

from __future__ import annotations

import numpy as np
from terrainav.core.imagery.opening import named_source
from terrainav.core.live.camera import FrameRequest, LiveCamera
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.picture.heights import mission_heights

HERE = 46.6, 8.1


def mission(**more):
    return Mission(Points(((*HERE, 150.0),)), 150.0, **{"image_px": 96, "source": "world", **more})


def live_camera(opened=None, *, accept_terms=False, **more):
    asked = mission(**more)
    source = named_source(asked.imagery.source).open() if opened is None else opened
    return LiveCamera(asked, source, mission_heights(asked), accept_terms=accept_terms)


def random_requests(count, seed, *, most_tilt=75.0, products=()):
    rng = np.random.default_rng(seed)
    return [
        FrameRequest(
            HERE[0] + rng.uniform(-0.01, 0.01),
            HERE[1] + rng.uniform(-0.01, 0.01),
            rng.uniform(60.0, 300.0),
            rng.uniform(-180.0, 180.0),
            rng.uniform(0.0, most_tilt),
            rng.uniform(-20.0, 20.0),
            float(number),
            products,
        )
        for number in range(count)
    ]
