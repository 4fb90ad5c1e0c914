"""PyTorch's loader: the same batches as the plain iterator's, with any number of workers, in every epoch."""

from __future__ import annotations

import pickle
import sys

import numpy as np
import pytest
from terrainav.core.dataset.loading import Batches
from terrainav.core.errors import InvalidInput, OutputError

from tests.support.command import command
from tests.support.datasets import write_dataset

torch = pytest.importorskip("torch")
SIZE = (20, 16, 3)
#: Python 3.12 warns of a fork beside threads, such as those that torch has made; its workers start none.
pytestmark = pytest.mark.filterwarnings("default:This process:DeprecationWarning")


@pytest.fixture
def folder(tmp_path):
    return write_dataset(tmp_path / "OUT")


def torch_dataset(folder, **choice):
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    return TorchDataset(folder, **choice)


def meant(folder, epoch, **choice):
    batches = Batches(folder, 4, **choice)
    batches.set_epoch(epoch)
    return list(batches)


def assert_same(found, wanted):
    assert len(found) == len(wanted)
    for (images, labels), (pixels, values) in zip(found, wanted):
        np.testing.assert_array_equal(images.permute(0, 2, 3, 1).numpy(), pixels)
        np.testing.assert_array_equal(labels.numpy(), values)


@pytest.mark.parametrize(("workers", "method"), [(0, None), (1, "fork"), (2, "fork")])
def test_batches_are_the_plain_iterators_in_every_epoch(folder, workers, method):
    """Workers that stay from one epoch to the next hear of it, too."""
    dataset = torch_dataset(folder, img_size=SIZE)
    loader = dataset.batches(4, workers, multiprocessing_context=method)
    assert len(loader) == 4
    for epoch in (0, 1, 5, 1):
        dataset.set_epoch(epoch)
        assert dataset.epoch == epoch
        assert_same(list(loader), meant(folder, epoch, img_size=SIZE))


def test_workers_that_are_started_afresh_are_told_the_epoch(folder):
    """As on Windows and macOS: the dataset is pickled for them, and hears of the next epoch even so."""
    dataset = torch_dataset(folder, img_size=SIZE)
    loader = dataset.batches(4, 1, multiprocessing_context="spawn")
    for epoch in (2, 3):
        dataset.set_epoch(epoch)
        assert_same(list(loader), meant(folder, epoch, img_size=SIZE))


def test_samples_are_tensors_with_channels_first(folder):
    dataset = torch_dataset(folder, part="validation", dtype="uint8")
    assert isinstance(dataset, torch.utils.data.Dataset)
    image, label = dataset[1]
    assert (image.shape, image.dtype) == ((3, 30, 40), torch.uint8)
    assert (label.shape, label.dtype) == ((2,), torch.float32)
    images, labels = dataset.samples.take([1])
    np.testing.assert_array_equal(image.numpy(), images[0].transpose(2, 0, 1))
    np.testing.assert_array_equal(label.numpy(), labels[0])
    assert torch_dataset(folder)[0][0].dtype == torch.float32


def test_pytorchs_own_loader_and_subsets_take_it(folder):
    dataset = torch_dataset(folder, part="all", img_size=(8, 8, 1))
    first, second = torch.utils.data.random_split(dataset, [10, 12])
    images, labels = next(iter(torch.utils.data.DataLoader(first, batch_size=5, shuffle=True)))
    assert (images.shape, labels.shape) == ((5, 1, 8, 8), (5, 2))
    assert len(list(torch.utils.data.DataLoader(second, batch_size=5))) == 3


def test_a_smaller_last_batch_can_be_left_out(folder):
    dataset = torch_dataset(folder, img_size=SIZE)
    assert [len(labels) for _, labels in dataset.batches(4)] == [4, 4, 4, 2]
    assert [len(labels) for _, labels in dataset.batches(4, drop_last=True)] == [4, 4, 4]
    with pytest.raises(InvalidInput, match="batch size 15: must be 14 or less"):
        dataset.batches(15, drop_last=True)


def test_it_can_be_pickled(folder):
    dataset = torch_dataset(folder, img_size=SIZE)
    dataset.set_epoch(3)
    again = pickle.loads(pickle.dumps(dataset))
    assert again.epoch == 3
    assert torch.equal(again[2][0], dataset[2][0])


def test_images_that_cannot_be_read_are_named(folder):
    dataset = torch_dataset(folder, img_size=SIZE)
    path = dataset.samples.path(3)
    path.write_bytes(b"no image")
    with pytest.raises(InvalidInput, match=f"^image {path}: cannot be read"):
        list(dataset.batches(4))


def test_the_command_names_them_in_one_line(folder, tmp_path, monkeypatch, capsys):
    path = torch_dataset(folder).samples.path(3)
    path.write_bytes(b"no image")
    run = command(tmp_path, monkeypatch, capsys)
    done = run("load", str(folder), "--loader", "torch", "--workers", "1", "--img-size", "8", "8", "3")
    assert done.returncode == 2
    assert done.stderr.startswith(f"terrainav: image {path}: cannot be read")
    done = run("load", str(folder), "--loader", "torch", "--part", "test")
    assert "1 batch: images (3, 3, 30, 40) float32" in done.stdout


def test_without_pytorch_one_line_says_so(folder, monkeypatch):
    torch_dataset(folder)
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(OutputError, match="PyTorch is not installed"):
        torch_dataset(folder)


def test_the_module_has_nothing_else():
    from terrainav.core.dataset.loading import torch_loader

    assert torch_loader.TorchDataset is torch_loader.TorchDataset
    with pytest.raises(AttributeError, match="TorchData"):
        torch_loader.TorchData  # noqa: B018


@pytest.mark.filterwarnings("ignore:This DataLoader will create:UserWarning")
def test_workers_are_checked_and_no_more_than_there_are_batches(folder):
    dataset = torch_dataset(folder, img_size=SIZE)
    with pytest.raises(InvalidInput, match="workers -1: must be 0 or more"):
        dataset.batches(4, -1)
    assert dataset.batches(4, 1_000_000).num_workers == 4
