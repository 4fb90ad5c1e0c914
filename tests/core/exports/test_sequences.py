"""Sequences as the programs that they are written for read them: rosbags, mcap and evo."""

from __future__ import annotations

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from PIL import Image
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation
from terrainav.core.cli import main
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.errors import InvalidInput
from terrainav.core.exports.kinds import SEQUENCES, export_as, refusals
from terrainav.core.geodesy.contract import CameraContract
from terrainav.core.geodesy.local import LocalFrame

from tests.support.command import command

#: evo brings a numpy of its own.
PEER = Path(__file__).parents[3] / ".venv" / "peers" / "bin" / "python"
GROUND_M = 40.0


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Folder of a short sequence with depth, its camera tilted, turned and away from the inertial unit."""
    folder = tmp_path_factory.mktemp("flown")
    rows = [
        f"{46.2 + 4e-5 * t:.9f},{-122.2 + 3e-6 * t * t:.9f},{200 + 2 * t},{9 * t},{15 + t},{-2 * t},{1.7e9 + t}"
        for t in range(6)
    ]
    (folder / "poses.csv").write_text("lat,lon,agl,yaw,tilt,roll,time\n" + "\n".join(rows))
    asked = ("--coords", str(folder / "poses.csv"), "--ground-height", f"{GROUND_M:g}", "--rate", "4", "--fov", "60")
    small = ("--img-size", "64", "48", "3", "--format", "png", "--products", "depth", "--quiet")
    body = ("--imu-axes", "flu", "--lever-arm", "0.2", "-0.1", "0.3", "--outages", "0.4", "1")
    assert main(("fly", *asked, *small, *body, "--data-dir", str(folder / "out"))) == 0
    return folder / "out"


@pytest.fixture(scope="module")
def exported(flown, tmp_path_factory):
    """Folders of all formats by name."""
    root = tmp_path_factory.mktemp("exported")
    for kind in (*SEQUENCES, "tum"):
        assert export_as(flown, root / kind, kind).written == 21
    return root


def frame_of(folder):
    origin = json.loads((folder / "origin.json").read_text())
    return LocalFrame(origin["lat_deg"], origin["lon_deg"], origin["height_m"])


def columns(path):
    with path.open(encoding="utf-8") as file:
        _, *rows = csv.reader(file)
    return rows


def numbers(path):
    return np.array([[float(cell or "nan") for cell in row] for row in columns(path)])


def test_depth_leads_to_the_ground_by_what_eurocs_files_state(flown, exported):
    """Pixel, K, depth, T_BS and ground truth at a frame's time meet the level ground."""
    mav = exported / "euroc" / "mav0"
    camera = yaml.safe_load((mav / "cam0" / "sensor.yaml").read_text())
    mount = np.array(camera["T_BS"]["data"]).reshape(4, 4)
    fx, fy, cx, cy = camera["intrinsics"]
    truth = {int(row[0]): np.array(row[1:], float) for row in columns(mav / "state_groundtruth_estimate0" / "data.csv")}
    frame, images = frame_of(exported / "euroc"), read_dataset(flown).image_sets["satellite"]
    frames = columns(mav / "cam0" / "data.csv")
    assert len(frames) == 21
    for row, (stamp, name) in enumerate(frames):
        with Image.open(mav / "cam0" / "data" / name) as image:
            assert (np.asarray(image.convert("RGB")) == images.pixels(row, 3)).all()
        state = truth[int(stamp)]
        turn = Rotation.from_quat(state[[4, 5, 6, 3]])
        with Image.open(flown / "depth" / (Path(images.table.img_names[row]).stem + ".tif")) as image:
            depth = np.asarray(image, np.float64)
        v, u = np.mgrid[: depth.shape[0] : 7, : depth.shape[1] : 9]
        seen = np.stack([(u - cx) / fx, (v - cy) / fy, np.ones(u.shape)], axis=-1) * depth[v, u][..., np.newaxis]
        body = seen.reshape(-1, 3) @ mount[:3, :3].T + mount[:3, 3]
        _, _, height = frame.geodetic(turn.apply(body) + state[:3])
        assert height == pytest.approx(GROUND_M, abs=2e-3)


def test_exports_have_the_camera_of_the_sequence(flown, exported):
    stated = json.loads((flown / "camera.json").read_text())
    contract = CameraContract.from_json(stated)
    for kind in (*SEQUENCES, "tum"):
        about = json.loads((exported / kind / "camera.json").read_text())
        assert about == {key: value for key, value in stated.items() if key != "table"}
        assert CameraContract.from_json(about) == contract == read_dataset(flown).image_sets["satellite"].contract(5)


def test_frames_of_several_cameras_are_no_sequence_of_one(tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    asked = ("--coords", "46.2_-122.2_46.199_-122.198_100", "--rate", "0.2", "--img-size", "16", "12", "3")
    assert run("fly", *asked, "--vary", "k1=uniform(-0.1,0.1)", "--data-dir", "out", "--quiet").returncode == 0
    assert "fx_px" not in json.loads((tmp_path / "out" / "camera.json").read_text())
    with pytest.raises(InvalidInput, match="its frames have several cameras, and a sequence has one"):
        export_as(tmp_path / "out", tmp_path / "euroc", "euroc")


def test_inertial_data_are_those_of_the_sequence(flown, exported):
    folder = exported / "euroc" / "mav0" / "imu0"
    assert (numbers(folder / "data.csv") == numbers(flown / "imu.csv")).all()
    stated = yaml.safe_load((folder / "sensor.yaml").read_text())
    assert (stated["gyroscope_noise_density"], stated["accelerometer_random_walk"]) == (1.6968e-4, 3e-3)


def read_bag(path):
    """Messages of a bag by topic, with their times."""
    found = {}
    with AnyReader([path]) as reader:
        for connection, stamp, data in reader.messages():
            found.setdefault(connection.topic, []).append((stamp, reader.deserialize(data, connection.msgtype)))
    return found


def read_mcap(path):
    """Messages of an MCAP file by topic, read by its own library."""
    found = {}
    with path.open("rb") as file:
        for _, channel, message, decoded in make_reader(
            file, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time, decoded))
    return found


@pytest.fixture(scope="module", params=["rosbag2", "mcap by rosbags", "mcap"])
def messages(request, exported):
    kind, _, by = request.param.partition(" by ")
    if kind == "mcap" and not by:
        (file,) = (exported / kind / "bag").glob("*.mcap")
        return read_mcap(file)
    return read_bag(exported / kind / "bag")


def xyz(vector):
    return [vector.x, vector.y, vector.z]


def test_bags_have_what_the_tables_state(flown, messages):
    imu = numbers(flown / "imu.csv")
    found = [
        [stamp, *xyz(one.angular_velocity), *xyz(one.linear_acceleration)] for stamp, one in messages["/imu/data_raw"]
    ]
    assert (np.array(found) == imu).all()
    header = messages["/imu/data_raw"][7][1].header
    assert header.stamp.sec * 1_000_000_000 + header.stamp.nanosec == messages["/imu/data_raw"][7][0]
    gnss = numbers(flown / "gnss.csv")
    fixes = messages["/gnss/fix"]
    assert np.array_equal(
        [[one.latitude, one.longitude, one.altitude] for _, one in fixes], gnss[:, 1:], equal_nan=True
    )
    lost = [one.status.status == -1 for _, one in fixes]
    assert lost == np.isnan(gnss[:, 1]).tolist()
    assert any(lost)
    assert [one.fluid_pressure for _, one in messages["/pressure"]] == numbers(flown / "barometer.csv")[:, 1].tolist()
    field = [xyz(one.magnetic_field) for _, one in messages["/imu/mag"]]
    assert np.array(field) * 1e9 == pytest.approx(numbers(flown / "magnetometer.csv")[:, 1:], rel=1e-12)


def test_bags_have_the_frames_with_their_camera(flown, messages):
    images = read_dataset(flown).image_sets["satellite"]
    assert messages["/camera/image_raw"][-1][0] == 1_700_000_005_000_000_000
    for row, ((_, image), (_, depth), (_, info)) in enumerate(
        zip(*(messages[f"/camera/{name}"] for name in ("image_raw", "depth", "camera_info")))
    ):
        assert (image.width, image.height, image.encoding, image.step) == (64, 48, "rgb8", 192)
        assert (np.frombuffer(bytes(image.data), np.uint8).reshape(48, 64, 3) == images.pixels(row, 3)).all()
        assert np.frombuffer(bytes(depth.data), np.float32).size == 64 * 48
        assert image.header.frame_id == info.header.frame_id == "camera_optical"
        assert info.distortion_model == "plumb_bob"
    assert row == 20
    fx = 40.0 / np.tan(np.radians(30.0))  # of half a diagonal of 80 px
    # Pixels are counted from the centre of the first.
    assert np.array(info.k).reshape(3, 3) == pytest.approx(
        np.array([[fx, 0, 31.5], [0, fx, 23.5], [0, 0, 1]]), abs=1e-4
    )


def test_poses_of_bags_lead_to_those_of_the_cameras(exported, messages):
    """Ground truth and the static transform give the camera's pose of the TUM trajectory."""
    transform = messages["/tf_static"][0][1].transforms[0].transform
    mount = Rotation.from_quat([*xyz(transform.rotation), transform.rotation.w])
    truth = dict(messages["/ground_truth"])
    tum = np.loadtxt(exported / "tum" / "trajectory.txt")
    for stamp, *pose in tum:
        one = truth[round(stamp * 1000) * 1_000_000].pose.pose
        turn = Rotation.from_quat([*xyz(one.orientation), one.orientation.w])
        assert xyz(one.position) + turn.apply(xyz(transform.translation)) == pytest.approx(pose[:3], abs=1e-3)
        assert ((turn * mount).inv() * Rotation.from_quat(pose[3:])).magnitude() < 1e-7


@pytest.mark.skipif(not PEER.exists(), reason="the peers' environment is not there")
def test_evo_finds_one_trajectory_in_all_formats(exported):
    program = """
import sys
from pathlib import Path
from evo.core import metrics, sync
from evo.tools import file_interface
from rosbags.rosbag2 import Reader
root = Path(sys.argv[1])
truth = file_interface.read_euroc_csv_trajectory(root / "euroc/mav0/state_groundtruth_estimate0/data.csv")
for kind in ("rosbag2", "mcap"):
    with Reader(root / kind / "bag") as bag:
        found = file_interface.read_bag_trajectory(bag, "/ground_truth")
    one, other = sync.associate_trajectories(truth, found)
    error = metrics.APE(metrics.PoseRelation.full_transformation)
    error.process_data((one, other))
    print(one.num_poses, error.get_statistic(metrics.StatisticsType.max))
tum = file_interface.read_tum_trajectory_file(root / "tum/trajectory.txt")
print(tum.num_poses, abs(tum.path_length - truth.path_length))
"""
    done = subprocess.run([PEER, "-c", program, exported], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    bag, mcap, tum = ([float(part) for part in line.split()] for line in done.stdout.splitlines())
    assert bag[0] == mcap[0] == 1001
    assert max(bag[1], mcap[1]) < 1e-7
    assert tum[0] == 21
    assert tum[1] < 1.0


def test_what_is_no_sequence_is_refused(tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    assert run("capture", "--coords", "46.2_-122.2_100", "--img-size", "16", "12", "3", "--quiet").returncode == 0
    folder = next(path.parent for path in tmp_path.rglob("mission.json"))
    with pytest.raises(InvalidInput, match="is not a sequence, as it has no sequence"):
        export_as(folder, tmp_path / "x", "euroc")
    assert isinstance(refusals(folder)["mcap"], InvalidInput)
