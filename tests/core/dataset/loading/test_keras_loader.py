"""Keras's loader: the same batches as the plain iterator's, in training too, and epoch after epoch."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest
from terrainav.core.dataset.loading import Batches
from terrainav.core.errors import InvalidInput, OutputError

from tests.support.datasets import write_dataset
from tests.support.shards import write_folders, write_shards

pytest.importorskip("torch")
# Keras reads it once, when it is imported.
os.environ.setdefault("KERAS_BACKEND", "torch")
keras = pytest.importorskip("keras")
SIZE = (20, 16, 3)


@pytest.fixture
def folder(tmp_path):
    return write_dataset(tmp_path / "OUT")


def keras_dataset(folder, *sizes, **choice):
    from terrainav.core.dataset.loading.keras_loader import KerasDataset

    return KerasDataset(folder, *sizes, **choice)


def meant(folder, epoch, **choice):
    batches = Batches(folder, 4, **choice)
    batches.set_epoch(epoch)
    return list(batches)


def assert_same(found, wanted):
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted):
        for array, expected in zip(one, other):
            np.testing.assert_array_equal(array, expected)


def test_batches_are_the_plain_iterators(folder):
    dataset = keras_dataset(folder, 4, img_size=SIZE)
    assert isinstance(dataset, keras.utils.PyDataset)
    assert len(dataset) == 4
    for epoch in range(3):
        assert dataset.epoch == epoch
        assert_same([dataset[index] for index in range(4)], meant(folder, epoch, img_size=SIZE))
        dataset.on_epoch_end()
    dataset.set_epoch(7)
    assert_same([dataset[index] for index in range(4)], meant(folder, 7, img_size=SIZE))


def test_shards_are_streamed_in_the_plain_iterators_order(tmp_path):
    place = str(write_shards(f"memory://{tmp_path.name}", write_folders(tmp_path / "OUT"), 3))
    choice = {"part": "all", "img_size": SIZE, "shuffle": True, "shards_at_once": 2}
    dataset = keras_dataset(place, 4, **choice)
    assert_same([dataset[index] for index in range(len(dataset))], meant(place, 0, **choice))


class Noting(keras.Model):
    """Learns nothing: keeps the images and labels of each step."""

    def __init__(self):
        super().__init__()
        self.seen = []

    def call(self, images):
        return images

    def train_step(self, data):
        self.seen.append([np.array(keras.ops.convert_to_numpy(one)) for one in data])
        return {}


@pytest.mark.parametrize("workers", [1, 2])
def test_training_gets_every_image_of_every_epoch_with_its_own_augmentation(folder, workers):
    """Threads that make batches for what comes next change neither images nor their order."""
    model = Noting()
    model.compile(run_eagerly=True)
    if workers > 1:
        # A model that is not built yet takes a batch from Keras's queue that its training then does without.
        model(np.zeros((1, 16, 20, 3), np.float32))
    dataset = keras_dataset(folder, 4, img_size=SIZE, workers=workers, max_queue_size=3)
    model.fit(dataset, epochs=3, verbose=0, shuffle=False)
    assert_same(model.seen, [one for epoch in (1, 2, 3) for one in meant(folder, epoch, img_size=SIZE)])


def test_channels_come_where_keras_has_them(folder):
    before = keras.config.image_data_format()
    try:
        keras.config.set_image_data_format("channels_first")
        images, labels = keras_dataset(folder, 4, img_size=SIZE)[0]
    finally:
        keras.config.set_image_data_format(before)
    assert (images.shape, labels.shape) == ((4, 3, 16, 20), (4, 2))
    np.testing.assert_array_equal(images, np.moveaxis(meant(folder, 0, img_size=SIZE)[0][0], 3, 1))


def test_images_that_cannot_be_read_are_named(folder):
    dataset = keras_dataset(folder, 4, img_size=SIZE)
    path = dataset.samples.path(3)
    path.write_bytes(b"no image")
    with pytest.raises(InvalidInput, match=f"^image {path}: cannot be read"):
        [dataset[index] for index in range(4)]
    with pytest.raises(InvalidInput, match="batch size 0"):
        keras_dataset(folder, 0)


def test_without_keras_one_line_says_so(folder, monkeypatch):
    keras_dataset(folder)
    monkeypatch.setitem(sys.modules, "keras", None)
    with pytest.raises(OutputError, match="Keras is not installed"):
        keras_dataset(folder)


def test_the_module_has_nothing_else():
    from terrainav.core.dataset.loading import keras_loader

    assert keras_loader.KerasDataset is keras_loader.KerasDataset
    with pytest.raises(AttributeError, match="KerasData"):
        keras_loader.KerasData  # noqa: B018
