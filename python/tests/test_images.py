"""Images go in without copies, and what is no image is told in one line."""
import pickle

import numpy as np
import pytest

import flies


def process(camera, left, right):
    return flies.Detector(camera).process(left, right)


def test_halves_of_a_side_by_side_picture_will_do(pair, camera):
    both = np.concatenate(pair, axis=1)
    width = pair[0].shape[1]
    left, right = both[:, :width], both[:, width:]
    assert not left.flags["C_CONTIGUOUS"]
    halves, whole = process(camera, left, right), process(camera, *pair)
    assert np.array_equal(halves.obstacle_array, whole.obstacle_array) and len(whole.obstacles) > 3


def test_every_other_row_is_a_view_too(pair, camera):
    tall = np.repeat(pair[0], 2, axis=0), np.repeat(pair[1], 2, axis=0)
    rows = process(camera, tall[0][::2], tall[1][::2])
    assert np.array_equal(rows.obstacle_array, process(camera, *pair).obstacle_array)


def test_images_of_another_process_will_do(pair, camera):
    copies = pickle.loads(pickle.dumps(pair))
    assert np.array_equal(process(camera, *copies).obstacle_array, process(camera, *pair).obstacle_array)


def test_masked_arrays_that_hide_nothing_will_do(pair, camera):
    free = [np.ma.masked_array(image) for image in pair]
    assert np.array_equal(process(camera, *free).obstacle_array, process(camera, *pair).obstacle_array)


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda image: image.astype(np.float32), "left image: dtype: found float32, expected uint8"),
        (lambda image: np.stack([image] * 3, axis=2), "left image: shape: found (240, 640, 3), expected (height, width)"),
        (lambda image: np.ma.masked_equal(image, image[0, 0]), "left image: mask: hides pixels"),
        (lambda image: image[:, ::-1], "left image: strides: "),
        (lambda image: image[::-1], "left image: strides: "),
        (lambda image: image.T, "left image: strides: "),
        (lambda image: image.tolist(), "left image: type: found list, expected a numpy array"),
        (lambda image: None, "left image: type: found NoneType"),
        (lambda image: image[:0], "left image: size: the image is empty"),
        (lambda image: np.lib.stride_tricks.as_strided(image[:1], (240, 640), (0, 1)), "left image: strides: "),
        (lambda image: image[:100], "right image: size: found 640 x 240 px, expected 640 x 100 px"),
    ],
)
def test_what_is_no_image_is_told(pair, camera, change, words):
    with pytest.raises(flies.InputError) as told:
        process(camera, change(pair[0]), pair[1])
    assert str(told.value).startswith(words)
    assert "\n" not in str(told.value)


def test_images_of_another_size_are_told(pair, camera):
    with pytest.raises(flies.InputError, match="320 x 240"):
        process(camera, np.ascontiguousarray(pair[0][:, :320]), np.ascontiguousarray(pair[1][:, :320]))


def test_loaded_images_are_their_own(paths):
    left, right = flies.load_pair(*paths[0])
    assert left.dtype == np.uint8 and left.shape == right.shape == (240, 640)
    assert left.flags["WRITEABLE"] and left.flags["C_CONTIGUOUS"]
    assert left.std() > 5
