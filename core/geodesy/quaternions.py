"""Unit quaternions, w first: from rotation matrices and angles, and to matrices."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats


def rotation_matrices(quaternions: Floats) -> Floats:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4), w first."""
    w, x, y, z = quaternions.T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quaternions_from_matrices(rotations: Floats) -> Floats:
    """Unit quaternions (n, 4), w first and not negative, of rotation matrices (n, 3, 3).

    Each is computed from the largest of its four components, which keeps all digits (Shepperd, Journal of Guidance and
    Control 1(3), 1978).
    """
    r = rotations
    trace = r[:, 0, 0] + r[:, 1, 1] + r[:, 2, 2]
    squares = np.stack([trace, r[:, 0, 0], r[:, 1, 1], r[:, 2, 2]], axis=1)
    # Products of components: of w with x, y, z; of x with y, z; of y with z.
    wx, wy, wz = r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]
    xy, xz, yz = r[:, 0, 1] + r[:, 1, 0], r[:, 0, 2] + r[:, 2, 0], r[:, 1, 2] + r[:, 2, 1]
    square = 1.0 + 2.0 * squares - trace[:, np.newaxis]
    square[:, 0] = 1.0 + trace
    rows = np.stack(
        [
            np.stack([square[:, 0], wx, wy, wz], axis=1),
            np.stack([wx, square[:, 1], xy, xz], axis=1),
            np.stack([wy, xy, square[:, 2], yz], axis=1),
            np.stack([wz, xz, yz, square[:, 3]], axis=1),
        ],
        axis=1,
    )
    found = rows[np.arange(len(r)), square.argmax(axis=1)]
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return np.where(found[:, :1] < 0.0, -found, found)


def quaternions_from_angles(yaw_deg: Floats, pitch_deg: Floats, roll_deg: Floats) -> Floats:
    """Unit quaternions (n, 4) from an aircraft's body axes to north, east, down, for its yaw, then pitch, then roll."""
    (sy, cy), (sp, cp), (sr, cr) = (
        (np.sin(np.radians(angle) / 2.0), np.cos(np.radians(angle) / 2.0)) for angle in (yaw_deg, pitch_deg, roll_deg)
    )
    parts = [
        cy * cp * cr + sy * sp * sr,
        cy * cp * sr - sy * sp * cr,
        cy * sp * cr + sy * cp * sr,
        sy * cp * cr - cy * sp * sr,
    ]
    return np.stack(parts, axis=1)
