"""AirSim's unmodified client: its pixels are those that a capture of its poses writes."""

from __future__ import annotations

import io
import json
import socket

import numpy as np
import pytest
from PIL import Image
from pyproj import Transformer

pytest.importorskip("cosysairsim", reason="AirSim's own client asks")
pytest.importorskip("scipy", reason="its rotations are those to compare with")

import cosysairsim as airsim
import msgpack
import msgpackrpc
from scipy.spatial.transform import Rotation
from terrainav.core.capture.labels import open_labels
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.geotiff import parse_geotiff
from terrainav.core.geodesy.camera import image_axes
from terrainav.core.live.airsim import AirSim, BodyPose, serve
from terrainav.core.live.serving import FrameServer
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.plan import plan

from tests.core.live.scenes import HERE, live_camera, mission
from tests.core.live.serving import served

DOWN, AHEAD = "3", "0"
SCENE, DEPTH, RANGE, SEGMENTATION = 0, 1, 2, 5


def fields(folder):
    """A layer of squares, as GeoJSON."""
    lat, lon = HERE
    squares = []
    for row in range(-6, 6):
        for column in range(-6, 6):
            south, west = lat + row * 1e-3, lon + column * 1e-3
            ring = [
                [west, south],
                [west + 8e-4, south],
                [west + 8e-4, south + 8e-4],
                [west, south + 8e-4],
                [west, south],
            ]
            squares.append(
                {
                    "type": "Feature",
                    "properties": {"kind": "even" if (row + column) % 2 == 0 else "odd"},
                    "geometry": {"type": "Polygon", "coordinates": [ring]},
                }
            )
    path = folder / "fields.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": squares}))
    return path


def labelled(folder, **more):
    pytest.importorskip("pyogrio")
    camera = live_camera(labels=(f"{fields(folder)}:kind",), **more)
    camera.labels = open_labels(camera.plan(camera.start._replace(products=("classes", "instances"))))
    return camera


def random_poses(count, seed):
    rng = np.random.default_rng(seed)
    poses = []
    for _ in range(count):
        angles = rng.uniform(-180.0, 180.0), rng.uniform(-20.0, 20.0), rng.uniform(-20.0, 20.0)
        x, y, z, w = Rotation.from_euler("ZYX", angles, degrees=True).as_quat().tolist()
        place = [*rng.uniform(-300.0, 300.0, 2).tolist(), float(rng.uniform(-300.0, -80.0))]
        poses.append(airsim.Pose(airsim.Vector3r(*place), airsim.Quaternionr(x, y, z, w)))
    return poses


def carried(world, camera, pose):
    """Request for a camera of a vehicle at a pose."""
    placed = BodyPose.read({"position": pose.position.to_msgpack(), "orientation": pose.orientation.to_msgpack()})
    return world.request(world.cameras[camera].on(placed), 0.0)


def colours(response):
    """Red, green and blue of an uncompressed response, which has blue first."""
    data = np.frombuffer(response.image_data_uint8, np.uint8)
    return data.reshape(response.height, response.width, 3)[..., ::-1]


@pytest.mark.parametrize("count", [20, pytest.param(1000, marks=pytest.mark.thorough)])
def test_every_pixel_is_that_of_a_capture(tmp_path, count):
    camera = labelled(tmp_path, image_px=64)
    world, poses = AirSim(FrameServer(camera)), random_poses(count, 11)
    asked = [airsim.ImageRequest(DOWN, kind, kind == DEPTH, False) for kind in (SCENE, DEPTH, SEGMENTATION)]
    with served(camera, serve) as port:
        client = airsim.VehicleClient(port=port)
        client.confirmConnection()
        answers = []
        for pose in poses:
            client.simSetVehiclePose(pose, True)
            answers.append(client.simGetImages(asked))
    columns = list(zip(*(carried(world, DOWN, pose)[:6] for pose in poses)))
    points = Points(tuple(zip(*columns[:3])), yaws_deg=columns[3], tilts_deg=columns[4], rolls_deg=columns[5])
    products = {"frame": "camera", "products": ("depth", "instances"), "labels": camera.mission.labels.labels}
    planned = plan(mission(image_px=64, **products).replace(area=points), camera.source.grid)
    capture(planned, camera.source, tmp_path / "capture")
    for name, (scene, depth, segmentation) in zip(planned.names, answers):
        assert scene.time_stamp == depth.time_stamp == segmentation.time_stamp
        picture = np.asarray(Image.open(tmp_path / "capture" / "satellite" / f"{name}.tif"))
        assert np.array_equal(colours(scene), picture[..., :3])
        expected = parse_geotiff((tmp_path / "capture" / "depth" / f"{name}.tif").read_bytes()).values()[..., 0]
        metres = np.asarray(depth.image_data_float, np.float32).reshape(depth.height, depth.width)
        assert np.array_equal(metres, np.where(np.isfinite(expected), expected, np.float32(65504.0)))
        instances = np.asarray(Image.open(tmp_path / "capture" / "instances" / f"{name}.tif"))
        ids = colours(segmentation).astype(np.uint32)
        assert np.array_equal(ids[..., 0] << 16 | ids[..., 1] << 8 | ids[..., 2], instances)
        assert instances.any()


def test_positions_and_axes_are_those_of_other_programs():
    """The pose of each camera, by PROJ's topocentric conversion and SciPy's rotations."""
    camera = live_camera()
    world = AirSim(FrameServer(camera))
    home = f"+lat_0={HERE[0]} +lon_0={HERE[1]} +h_0=0"
    to_enu = Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
        f"+step +proj=topocentric +ellps=WGS84 {home}"
    )
    look = {AHEAD: np.eye(3), DOWN: Rotation.from_euler("Y", -90.0, degrees=True).as_matrix()}
    for pose in random_poses(20, 5):
        place, turn = pose.position, pose.orientation
        body = Rotation.from_quat([turn.x_val, turn.y_val, turn.z_val, turn.w_val]).as_matrix()
        for name, of_camera in look.items():
            request = carried(world, name, pose)
            east, north, up = to_enu.transform(request.lon_deg, request.lat_deg, request.up_m)
            assert (north, east, -up) == pytest.approx((place.x_val, place.y_val, place.z_val), abs=1e-6)
            right, top, view = image_axes(request.yaw_deg, request.tilt_deg, request.roll_deg)
            # Axes at the camera: a few hundred metres turn north, east and down by microradians.
            ned = (body @ of_camera).T
            for axis, expected in zip((view, right, -top), ned):
                assert axis[[1, 0, 2]] * [1.0, 1.0, -1.0] == pytest.approx(expected, abs=2e-4)


def test_several_cameras_share_one_stamp_and_say_where_they_are():
    with served(live_camera(), serve) as port:
        client = airsim.MultirotorClient(port=port)
        client.simSetVehiclePose(random_poses(1, 3)[0], True)
        ahead = airsim.Pose(airsim.Vector3r(0.5, 0.0, 0.1), airsim.Quaternionr(0.0, np.sin(-0.3), 0.0, np.cos(-0.3)))
        client.simSetCameraPose(AHEAD, ahead)
        images = client.simGetImages(
            [airsim.ImageRequest(name, SCENE, False, packed) for name in (AHEAD, DOWN) for packed in (True, False)]
        )
        assert len({one.time_stamp for one in images}) == 1
        for packed, plain in (images[:2], images[2:]):
            assert np.array_equal(np.asarray(Image.open(io.BytesIO(packed.image_data_uint8))), colours(plain))
            info = client.simGetCameraInfo(AHEAD if packed is images[0] else DOWN)
            assert info.pose.position.x_val == packed.camera_position.x_val
        assert not np.array_equal(colours(images[1]), colours(images[3]))


def test_range_along_each_ray_is_depth_times_the_rays_length():
    with served(live_camera(), serve) as port:
        client = airsim.VehicleClient(port=port)
        asked = [airsim.ImageRequest(DOWN, kind, True, False) for kind in (DEPTH, RANGE)]
        depth, along = (np.array(one.image_data_float).reshape(one.height, -1) for one in client.simGetImages(asked))
        info = client.simGetCameraInfo(DOWN)
        height, width = depth.shape
        tangent = np.tan(np.radians(info.fov) / 2.0)
        x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2.0, np.arange(height) + 0.5 - height / 2.0)
        assert along / depth == pytest.approx(np.sqrt(1.0 + (x**2 + y**2) * (2.0 * tangent / width) ** 2), rel=1e-6)


@pytest.mark.parametrize(
    "call",
    [
        lambda client: client.simGetImages([airsim.ImageRequest("tail", SCENE)]),
        lambda client: client.simGetImages([airsim.ImageRequest(DOWN, 7)]),
        lambda client: client.simGetImages([airsim.ImageRequest(DOWN, SEGMENTATION)]),
        lambda client: client.simGetImages([]),
        lambda client: client.simSetVehiclePose(airsim.Pose(airsim.Vector3r(float("nan"), 0, -9)), True),
        lambda client: client.simSetVehiclePose(airsim.Pose(None, airsim.Quaternionr(0, 0, 0, 0)), True),
        lambda client: client.simSpawnObject("a", "b", airsim.Pose(), airsim.Vector3r()),
        lambda client: client.client.call("ping", 1, 2, 3),
    ],
    ids=["camera", "type", "no labels", "no images", "nan", "no turn", "method", "parameters"],
)
def test_what_a_camera_cannot_do_is_refused_and_the_service_goes_on(call):
    with served(live_camera(), serve) as port:
        client = airsim.VehicleClient(port=port)
        with pytest.raises(msgpackrpc.error.RPCError) as refused:
            call(client)
        assert "\n" not in str(refused.value)
        assert client.ping()


def test_rubbish_ends_its_own_connection_alone():
    with served(live_camera(), serve) as port:
        for rubbish in (b"GET / HTTP/1.1\r\n\r\n", b"\xc1" * 50, msgpack.packb([0, 1]), b"\xdf\xff\xff\xff\xff"):
            with socket.create_connection(("127.0.0.1", port), 30.0) as other:
                other.sendall(rubbish)
                other.shutdown(socket.SHUT_WR)
                assert other.recv(100) == b""
        assert airsim.VehicleClient(port=port).ping()
