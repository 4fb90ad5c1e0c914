r"""What the readers of public sets for localisers say of a benchmark in their layouts.

    python -m venv peers && peers/bin/pip install torch torchvision opencv-python-headless scipy matplotlib pyyaml \
        tqdm pytorch_metric_learning albumentations shapely geopy loguru roma appdirs beautifulsoup4 rasterio \
        scikit-learn py-cpuinfo gputil psutil tueplots
    terrainav benchmark make --coords "35.1480_-89.8650_35.1400_-89.8540_100" --tilt 20 --yaw 30 --fov 70 \
        --image-px 320 --format jpg --split same-area --shares 0.5 0.1 0.4 --queries air=world road=world:roadmap \
        --reference air=world --data-dir bench
    for f in university-1652 denseuav uav-visloc gta-uav ortholoc anyvisloc; do terrainav export bench $f --as $f; done
    peers/bin/python benchmarks/format_peers.py . --university1652 University1652-Baseline --denseuav DenseUAV \
        --game4loc GTA-UAV --ortholoc OrthoLoC --anyvisloc Benchmark

The folders are checkouts of layumi/University1652-Baseline, Dmmm1997/DenseUAV, Yux1angJi/GTA-UAV, deepscenario/OrthoLoC
and UAV-AVL/Benchmark. Their files run as they are, on a machine without a graphics card: scripts in copies of their
folders, with random weights instead of downloaded ones, and moving tensors to a card does nothing; packages of networks
that no reader needs are empty stand-ins.
"""

from __future__ import annotations

import argparse
import csv
import importlib
import json
import os
import pickle
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest.mock import MagicMock

import numpy as np

#: Half of a side of the piece of a map in which SIFT looks for a query.
_CROP_PX = 300
#: Fewest inliers from which a pose is believed.
_INLIERS = 15
#: What matches may be off the truth by.
_NEAR_PX = 2.0


def university1652(peer: Path, root: Path) -> None:
    """Train for an epoch with the baseline's script; open what its test opens; score by its evaluation."""
    import torch
    from torchvision import datasets, models

    with tempfile.TemporaryDirectory() as work:
        copy = shutil.copytree(peer, Path(work) / "peer")
        (copy / "model").mkdir(exist_ok=True)
        weights = Path(work) / "torch" / "hub" / "checkpoints"
        weights.mkdir(parents=True)
        for name in ("resnet50-0676ba61.pth", "resnet50-11ad3fa6.pth"):
            torch.save(models.resnet50().state_dict(), weights / name)
        environment = {**os.environ, "TORCH_HOME": str(Path(work) / "torch")}
        small = ["--batchsize", "4", "--h", "64", "--w", "64"]
        for views in (["--views", "2"], ["--views", "3", "--extra_Google"]):
            arguments = ["--data_dir", str(root / "train"), "--gpu_ids", "-1", *small, *views]
            with subprocess.Popen(
                _command(copy / "train.py", arguments),
                cwd=copy,
                env=environment,
                text=True,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
            ) as run:
                for line in run.stdout or ():
                    if line.startswith("{'") or "Loss:" in line or "Error" in line:
                        print(f"  train.py {' '.join(views)}: {line.strip()}", flush=True)
                    if "Loss:" in line:
                        break
                run.kill()
    names = [f"{kind}_{view}" for kind in ("gallery", "query") for view in ("satellite", "drone", "street")]
    opened = {name: datasets.ImageFolder(str(root / "test" / name)) for name in names}
    print("  test.py opens", {name: len(one) for name, one in opened.items()})
    _score(peer, opened["query_drone"], opened["gallery_satellite"], ["evaluate_gpu.py"], "pytorch_result.mat")


def denseuav(peer: Path, root: Path) -> None:
    """Load by the training's own loader; score by both evaluations."""
    from torchvision import datasets, transforms

    sys.path.insert(0, str(peer))
    loader = importlib.import_module("datasets.Dataloader_University")
    tensors = transforms.Compose([transforms.Resize((64, 64)), transforms.ToTensor()])
    found = loader.Dataloader_University(str(root / "train"), {"train": tensors, "satellite": tensors})
    satellite, drone, _ = found[len(found) - 1]
    print(f"  {len(found)} places to train on, of {tuple(satellite.shape)} and {tuple(drone.shape)}")
    opened = [datasets.ImageFolder(str(root / "test" / name)) for name in ("query_drone", "gallery_satellite")]
    scripts = ["evaluate_gpu.py", f"evaluateDistance.py --root_dir {root}"]
    _score(peer, *opened, scripts, "pytorch_result_1.mat")


def _score(peer: Path, queries: object, gallery: object, scripts: list[str], result: str) -> None:
    """Print what a peer's evaluations say of features that tell the label of each image, and of random ones."""
    import scipy.io

    def labels(folder: object) -> np.ndarray:
        return np.array([int(Path(path).parent.name) for path, _ in folder.imgs])

    asked, found = labels(queries), labels(gallery)
    rng = np.random.default_rng(1)
    told = rng.normal(size=(max(asked.max(), found.max()) + 1, 64))
    for title, features in (("labels", told), ("noise", None)):
        qf, gf = (rng.normal(size=(len(some), 64)) if features is None else features[some] for some in (asked, found))
        with tempfile.TemporaryDirectory() as work:
            scipy.io.savemat(
                Path(work) / result,
                {"query_f": qf, "query_label": asked, "gallery_f": gf, "gallery_label": found},
            )
            for script in scripts:
                name, *arguments = script.split()
                command = _command(peer / name, arguments)
                done = subprocess.run(command, cwd=work, text=True, capture_output=True, check=False)
                said = [line for line in done.stdout.splitlines() if "Recall" in line or "metric" in line]
                print(f"  {name} of {title}:", "; ".join(said) or done.stderr[-300:])


def _command(script: Path, arguments: list[str]) -> list[str]:
    """Command that runs a script of a peer as it is, where moving things to a graphics card does nothing."""
    code = (
        "import runpy, sys, torch; torch.Tensor.cuda = torch.nn.Module.cuda = lambda self, *_, **__: self; "
        f"sys.path.insert(0, {str(script.parent)!r}); sys.argv = {[script.name, *arguments]!r}; "
        f"runpy.run_path({str(script)!r}, run_name='__main__')"
    )
    return [sys.executable, "-u", "-W", "ignore", "-c", code]


def game4loc(peer: Path, root: Path) -> None:
    """GTA-UAV's datasets and figures; UAV-VisLoc's preparation of raw folders."""
    sys.path.insert(0, str(peer / "Game4Loc"))
    gta = importlib.import_module("game4loc.dataset.gta")
    exported = root / "gta-uav"
    area = "cross" if (exported / "cross-area-drone2sate-test.json").exists() else "same"
    train, test = (f"{area}-area-drone2sate-{part}.json" for part in ("train", "test"))
    for mode in ("pos", "pos_semipos"):
        pairs = gta.GTADatasetTrain(train, str(exported), mode=mode, prob_flip=0.0, shuffle_batch_size=4)
        query, tile, weight = pairs[0]
        print(f"  GTADatasetTrain, {mode}: {len(pairs)} pairs, of {query.shape} and {tile.shape}, weight {weight:.3f}")
    pairs.shuffle()
    queries = gta.GTADatasetEval(test, str(exported), "drone")
    gallery = gta.GTADatasetEval(test, str(exported), "sate", sate_img_dir="satellite")
    sys.modules["game4loc.matcher.gim_dkm"] = MagicMock()
    figures = importlib.import_module("game4loc.evaluate.gta")
    places = np.array(gallery.images_center_loc_xy)
    own = np.array(queries.images_center_loc_xy)
    nearest = [np.argsort(np.hypot(*(places - one).T), kind="stable") for one in own]
    names = np.array(gallery.images_name)
    right = [
        bool(names[one[0]] in queries.pairs_drone2sate_dict[name]) for one, name in zip(nearest, queries.images_name)
    ]
    sdm = np.mean([figures.sdm(one, [1, 5], index, places) for one, index in zip(own, nearest)], axis=0)
    far = np.mean([figures.get_dis(one, index, places, [1])[0] for one, index in zip(own, nearest)])
    print(f"  GTADatasetEval: {len(queries)} queries of {queries[0].shape}, {len(gallery)} tiles of {gallery[0].shape}")
    print(f"  of the nearest tile: R@1 {100 * np.mean(right):.1f} %, SDM@1, 5 {np.round(sdm, 4)}, Dis@1 {far:.2f} m")
    _visloc(peer, root / "uav-visloc")


def _visloc(peer: Path, exported: Path) -> None:
    """Run the preparation of UAV-VisLoc's raw folders, told of these maps where it holds the published ones'."""
    with tempfile.TemporaryDirectory() as work:
        root = shutil.copytree(exported, Path(work) / "raw")
        sys.path.insert(0, str(peer / "scripts" / "prepare_dataset"))
        prepare = importlib.import_module("visloc")
        with (root / "satellite_coordinates_range.csv").open(newline="") as file:
            ranges = list(csv.reader(file))[1:]
        numbers = [int(row[0][9:11]) for row in ranges]
        import cv2

        for row, number in zip(ranges, numbers):
            prepare.SATE_LATLON[f"{number:02d}"] = [float(value) for value in row[1:5]]
            prepare.SATE_SIZE[f"{number:02d}"] = cv2.imread(str(root / f"{number:02d}" / row[0])).shape[:2]
        # Its tiling skips flights that are not in both lists.
        prepare.TRAIN_LIST = prepare.TEST_LIST = numbers
        # Its angles of view, along the heading and across, are those of the published flights' camera; here as above.
        prepare.calculate_coverage_endpoints.__defaults__ = (45.6, 58.5, False)
        prepare.tile_satellite(str(root))
        prepare.copy_satellite(str(root))
        prepare.process_visloc_data(str(root), str(Path(work) / "made"), "same-area")
        for part in ("train", "test"):
            # What its own script has just written.
            with (Path(work) / "made" / f"{part}_pair_meta.pkl").open("rb") as file:
                made = pickle.load(file)["pairs_drone2sate_list"]  # noqa: S301
            pairs = sum(len(one["pair_pos_semipos_sate_img_list"]) for one in made)
            print(f"  visloc.py, {part}: {len(made)} images, {pairs} pairs")


def ortholoc(peer: Path, root: Path) -> None:
    """Poses by PnP from its ground truth of matches, and from SIFT's, lifted by its own code."""
    for name in ("imcui", "imcui.ui", "imcui.ui.utils"):
        sys.modules[name] = MagicMock()
    sys.path.insert(0, str(peer))
    dataset = importlib.import_module("ortholoc.dataset")
    correspondences = importlib.import_module("ortholoc.correspondences")
    utils = importlib.import_module("ortholoc.utils")
    for part in sorted(one.name for one in root.iterdir() if one.is_dir()):
        samples = dataset.OrthoLoC(dataset_dir=str(root / part), shuffle=False, return_tensor=False)
        truth, sift, confidences = [], [], []
        for at in np.linspace(0, len(samples) - 1, 8).astype(int):
            sample = samples[int(at)]
            matches = dataset.OrthoLoC.get_correspondences_2d2d(sample, normalized=True, covisible_only=True)
            confidences.append(float(np.median(matches.confidences)))
            found = {"truth": matches}
            pts0, pts1 = _sift(sample["image_query"], sample["image_dop"])
            if len(pts0) > 10:
                found["sift"] = correspondences.Correspondences2D2D(
                    pts0=pts0, pts1=pts1, confidences=np.ones(len(pts0)), is_normalized=False
                ).normalized(w0=sample["w_query"], h0=sample["h_query"], w1=sample["w_dop"], h1=sample["h_dop"])
            for kind, one in found.items():
                lifted = one.to_2d3d(grid3d_1=sample["dsm"])
                ok, pose, *_ = lifted.calibrate(
                    num_points=2000,
                    intrinsics_matrix=sample["intrinsics_query"],
                    width=sample["w_query"],
                    height=sample["h_query"],
                    pnp_mode="cv2",
                )
                if ok:
                    error = utils.metrics.pose_error(pose.astype(np.float32), sample["pose_query2world"])
                    (truth if kind == "truth" else sift).append(error)
        print(
            f"  OrthoLoC {part}: {len(samples)} samples, types",
            {k: len(v) for k, v in samples.sample_ids_by_type.items()},
        )
        for kind, errors in (("its own matches", truth), ("SIFT's", sift)):
            if errors:
                metres, degrees = np.median(errors, axis=0)
                print(f"    pose from {kind}, {len(errors)} samples: median {metres:.3f} m, {degrees:.3f} deg")
        print(f"    median confidence of its matches {np.median(confidences):.3f}")


def anyvisloc(peer: Path, root: Path) -> None:
    """Poses by its PnP, from SIFT's matches with its map, lifted by its reader of the surface."""
    import cv2

    for name in (
        "Matching_Models.RoMa.demo.Roma_match",
        "Retrieval_Models.feature_extract",
        "Retrieval_Models.multi_model_loader",
    ):
        sys.modules[name] = MagicMock()
    for name in ("Matching_Models", "Matching_Models.RoMa", "Matching_Models.RoMa.demo", "Retrieval_Models"):
        sys.modules[name] = MagicMock(__path__=[])
    sys.path.insert(0, str(peer))
    data, utils = importlib.import_module("avl_data"), importlib.import_module("avl_utils")
    samples = data.AnyVisLocNPZDataset(str(root), load_reference=True)
    by_scene: dict[str, list[tuple[float, float, float]]] = {}
    centred = []
    for at in range(0, len(samples), max(len(samples) // 40, 1)):
        sample = samples[at]
        view = utils.build_anyvisloc_reference_view(sample, "aerial")
        true = utils.anyvisloc_sample_to_truepos(sample)
        # Where its formula puts the middle of the image, by xyz and euler_deg, and where the pose does.
        col, row = utils.view_center_anyvisloc(true, view["map_resolution"], view["map_origin_local"], np.eye(3))
        pose = sample["pose_c2w"].numpy()
        ahead = pose[:3, 3] + pose[:3, 2] * (-pose[2, 3] / pose[2, 2])
        res = view["map_resolution"]
        centred.append(np.hypot(col * res[0] - ahead[0], row * res[1] + ahead[1]))
        image = utils.tensor_rgb_to_bgr_uint8(sample["image"])
        # As its runs without retrieval do: in a piece of the map about the middle of the view.
        left, top = max(int(col) - _CROP_PX, 0), max(int(row) - _CROP_PX, 0)
        pts0, pts1 = _sift(image, view["map"][top : top + 2 * _CROP_PX, left : left + 2 * _CROP_PX])
        pts1 = pts1 + np.array([left, top], np.float32)
        x, y = (pts1 * view["map_resolution"] + view["map_origin_local"]).T
        z, valid = utils.sample_dsm_local(view["dsm"], x, y, view["dsm_resolution"], view["dsm_origin_local"])
        cv2.setRNGSeed(1)
        pts0, x, y, z = pts0[valid], x[valid], y[valid], z[valid]
        # Where the pose puts the matched places of the map, with y to the north.
        camera = sample["pose_w2c"].numpy()
        ahead = np.stack([x, -y, z], axis=1) @ camera[:3, :3].T + camera[:3, 3]
        seen = ahead @ sample["K"].numpy().T
        off = np.hypot(*(seen[:, :2] / seen[:, 2:] - pts0).T)
        title = json.loads(Path(view["ref_json_path"]).read_text())["title"]
        told = by_scene.setdefault(f"{sample['scene_name']} ({title})", [])
        cv2.setRNGSeed(1)
        found, _, inliers, _ = utils.estimate_drone_pose_anyvisloc(
            pts0, sample["K"].numpy(), x, y, z, sample["dist"].numpy(), reprojection_error=2.0
        )
        if inliers >= _INLIERS:
            good = off[off < _NEAR_PX]
            error = np.hypot(found["X"] - true["x"], found["Y"] - true["y"])
            told.append((len(good) / len(off), float(np.median(good)), float(error)))
    print(f"  AnyVisLocNPZDataset: {len(samples)} samples; its middle of view is {max(centred):.3f} m off at most")
    for scene, told in by_scene.items():
        if told:
            share, px, metres = np.median(told, axis=0)
            print(
                f"  {scene}: {len(told)} samples, {100 * share:.0f} % of SIFT's matches within {_NEAR_PX} px of where"
            )
            print(f"    pose and surface put them, median {px:.2f} px; its PnP is off {metres:.3f} m, median")


def _sift(query: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Matches of SIFT, (n, 2) each."""
    import cv2

    finder = cv2.SIFT_create()
    (k0, d0), (k1, d1) = (
        finder.detectAndCompute(cv2.cvtColor(one, cv2.COLOR_BGR2GRAY), None) for one in (query, reference)
    )
    if d0 is None or d1 is None or len(d1) < 2:
        return np.zeros((0, 2)), np.zeros((0, 2))
    pairs = [one for one, two in cv2.BFMatcher().knnMatch(d0, d1, k=2) if one.distance < 0.8 * two.distance]
    return tuple(
        np.array([points[getattr(one, side)].pt for one in pairs], np.float32).reshape(-1, 2)
        for points, side in ((k0, "queryIdx"), (k1, "trainIdx"))
    )


PEERS = {
    "university1652": (university1652, "university-1652"),
    "denseuav": (denseuav, "denseuav"),
    "game4loc": (game4loc, ""),
    "ortholoc": (ortholoc, "ortholoc"),
    "anyvisloc": (anyvisloc, "anyvisloc"),
}


def main() -> None:
    """Run each peer in a process of its own, as their modules share names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("exports", type=Path, help="folder of the exports, each named as its format")
    parser.add_argument("--alone", choices=PEERS, help=argparse.SUPPRESS)
    for name in PEERS:
        parser.add_argument(f"--{name}", type=Path, metavar="FOLDER")
    asked = parser.parse_args()
    for name, (reader, inside) in PEERS.items():
        peer = getattr(asked, name)
        if peer is None:
            continue
        if asked.alone:
            reader(peer.resolve(), (asked.exports / inside).resolve())
            continue
        print(name, flush=True)
        subprocess.run(
            [
                sys.executable,
                "-W",
                "ignore",
                __file__,
                str(asked.exports),
                "--alone",
                name,
                f"--{name}",
                str(peer),
            ],
            check=False,
        )


if __name__ == "__main__":
    main()
