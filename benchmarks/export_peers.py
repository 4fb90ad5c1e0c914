r"""What COLMAP and evo say of the exports of a dataset of camera frames.

    python -m venv peers && peers/bin/pip install pycolmap evo
    terrainav capture --coords "35.1450_-89.8620_35.1435_-89.8600_100" --frame camera --tilt 10 --yaw 20 \
        --overlap 0.7 --format jpg --data-dir out
    terrainav export out model --as colmap && terrainav export out tum --as tum && terrainav export out kitti --as kitti
    peers/bin/python benchmarks/export_peers.py out/satellite model tum kitti

Lenses that distort: add --fov 80 --lens fisheye --k1 0.03 --k2=-0.01 --sampling area, or --k1 -0.1 --p1 0.001, to the
capture. Without tum and kitti, COLMAP alone is asked, and .venv/peers will do.

COLMAP finds and matches features of its own, and triangulates them with the exported poses held fixed. Prints the mean
reprojection error in px, also at the centre and the corners of images, and, over level ground, how far the points are
from it.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
import pycolmap


def triangulated(images: Path, model: Path, folder: Path) -> pycolmap.Reconstruction:
    """Points of an exported model."""
    pycolmap.set_random_seed(1)
    told = pycolmap.Reconstruction(model / "sparse" / "0")
    poses = {image.name: image.cam_from_world() for image in told.images.values()}
    reader = pycolmap.ImageReaderOptions()
    (camera,) = told.cameras.values()
    reader.camera_model = camera.model.name
    reader.camera_params = ",".join(repr(float(value)) for value in camera.params)
    database = folder / "database.db"
    pycolmap.extract_features(
        database, images, sorted(poses), camera_mode=pycolmap.CameraMode.SINGLE, reader_options=reader
    )
    pycolmap.match_exhaustive(database)
    # The same views by the numbers that the database gives them.
    known = pycolmap.Reconstruction()
    with pycolmap.Database.open(database) as opened:
        for one in opened.read_all_cameras():
            known.add_camera_with_trivial_rig(one)
        for one in opened.read_all_images():
            bare = pycolmap.Image(name=one.name, camera_id=one.camera_id, image_id=one.image_id)
            known.add_image_with_trivial_frame(bare, poses[one.name])
    (folder / "sparse").mkdir()
    return pycolmap.triangulate_points(known, database, images, folder / "sparse")


def by_radius(found: pycolmap.Reconstruction) -> list[float]:
    """Mean errors, px, of features within a fifth of the way from the middle of images to a corner, and in the last."""
    off, radius = [], []
    for point in found.points3D.values():
        for element in point.track.elements:
            image = found.images[element.image_id]
            seen, size = image.points2D[element.point2D_idx].xy, (image.camera.width, image.camera.height)
            off.append(np.linalg.norm(image.project_point(point.xyz) - seen))
            radius.append(np.hypot(*(2.0 * seen / size - 1.0) * size) / np.hypot(*size))
    return [float(np.mean(np.array(off)[which])) for which in (np.array(radius) < 0.2, np.array(radius) > 0.8)]


def main() -> None:
    """Print what they say."""
    images, model, *trajectories = map(Path, sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        found = triangulated(images, model, Path(folder))
    heights = np.array([point.xyz[2] for point in found.points3D.values()])
    off = np.percentile(np.abs(heights - np.median(heights)), [50, 90])
    print(f"COLMAP: {len(heights):,} points of {len(found.images)} images")
    print(f"mean reprojection error {found.compute_mean_reprojection_error():.3f} px")
    inner, outer = by_radius(found)
    print(f"mean over features: {inner:.3f} px at the centre of images, {outer:.3f} px at the corners")
    print(
        f"heights: median {np.median(heights):.4f} m, half within {off[0]:.3f} m of it, 9 of 10 within {off[1]:.3f} m"
    )
    if trajectories:
        _say_trajectories(*trajectories)


def _say_trajectories(tum: Path, kitti: Path) -> None:
    """Print what evo reads."""
    from evo.tools import file_interface

    trajectory = file_interface.read_tum_trajectory_file(tum / "trajectory.txt")
    print(f"evo: {trajectory.num_poses} poses, {trajectory.path_length:.1f} m")
    path = file_interface.read_kitti_poses_file(kitti / "poses.txt")
    off = np.abs(np.array(path.poses_se3) - np.array(trajectory.poses_se3)).max()
    print(f"evo: {path.num_poses} poses of KITTI, {off:.1g} from those of TUM at most")


if __name__ == "__main__":
    main()
