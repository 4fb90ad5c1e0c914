"""Places of files: folders, and object stores by their addresses."""

from __future__ import annotations

import gc
import pickle
import threading
import weakref
from pathlib import Path
from uuid import uuid4

import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.storage import stores
from terrainav.core.storage.files import write_whole

from tests.support.objects import SECRET, s3_store


@pytest.fixture(scope="module")
def bucket():
    with pytest.MonkeyPatch.context() as monkeypatch, s3_store(monkeypatch) as address:
        yield address


@pytest.fixture(params=["memory", "s3"])
def folder(request, bucket):
    return stores.store_path(f"{'memory://x' if request.param == 'memory' else bucket}/{uuid4().hex}")


@pytest.mark.parametrize("text", ["/tmp/x", "x/y", "C:\\x", "C://x", "file:///tmp/x"])
def test_folders_of_this_machine_are_paths(text):
    assert not stores.is_address(text)
    assert isinstance(stores.store_path(text), Path)


def test_an_object_is_put_and_got(folder):
    assert stores.is_address(folder)
    write_whole(folder / "a" / "b.txt", b"hello")
    assert stores.get(folder / "a" / "b.txt") == b"hello"
    assert stores.get_range(folder / "a" / "b.txt", 1, 3) == b"ell"
    assert stores.get(folder / "a" / "none.txt") is None
    assert stores.list_sizes(folder / "a") == {"b.txt": 5}
    assert stores.list_sizes(folder / "none") == {}
    stores.remove(folder / "a" / "b.txt")
    stores.remove(folder / "a" / "b.txt")
    assert stores.get(folder / "a" / "b.txt") is None


def test_of_many_that_put_a_new_object_one_does(folder):
    outcomes: list[bool] = []
    threads = [
        threading.Thread(target=lambda n=n: outcomes.append(stores.put_new(folder / "lock", b"%d" % n)))
        for n in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcomes) == [False] * 7 + [True]


def test_what_others_have_put_is_listed(folder):
    assert stores.list_sizes(folder) == {}
    stores.put(pickle.loads(pickle.dumps(folder)) / "a", b"123")
    assert stores.list_sizes(folder) == {"a": 3}


@pytest.mark.parametrize("ask", [stores.get, stores.list_sizes, stores.is_file, stores.remove])
def test_what_is_not_there_keeps_nothing_of_who_asks(folder, ask):
    """Not until garbage is collected, either: it may be a loader with worker processes."""

    class Held:
        pass

    def asks():
        held = Held()
        ask(folder / "nothing")
        return weakref.ref(held)

    gc.disable()
    try:
        assert asks()() is None
    finally:
        gc.enable()


def test_a_bucket_that_is_not_there_is_one_line(bucket):
    with pytest.raises(OutputError, match=r"^s3://nobody/x: is not there, or s3://nobody is not") as wrong:
        stores.put(stores.store_path("s3://nobody/x"), b"1")
    assert SECRET not in str(wrong.value)
    assert wrong.value.__cause__ is None


@pytest.mark.parametrize(
    ("raised", "said"),
    [
        (PermissionError("The provided token has expired."), "x: the credentials have expired: new ones are"),
        (PermissionError("Forbidden"), "x: access is refused: the credentials do not allow it"),
        (OSError(16, "Please reduce your request rate."), "x: cannot be reached (Please reduce your"),
        # Azure's own words.
        (ValueError("Server failed to authenticate the request."), "x: access is refused: the credentials"),
        (
            ValueError("This request is not authorized to perform it."),
            "x: access is refused: the credentials",
        ),
        (ValueError("Connection string is malformed."), "x: no valid credentials: they are taken from"),
        (ValueError("ErrorCode:InvalidResourceName"), "x: is not there, or memory://data is not; make the"),
    ],
)
def test_what_a_store_refuses_is_one_line(raised, said):
    with pytest.raises(OutputError) as wrong, stores.store_errors(stores.store_path("memory://data/x")):
        raise raised
    assert str(wrong.value).startswith(f"memory://data/{said}")
    assert "\n" not in str(wrong.value)


def test_an_address_of_another_kind_is_refused():
    with pytest.raises(InvalidInput, match=r"^address 'foo://x': must be a folder, or begin with s3://"):
        stores.store_path("foo://x")
