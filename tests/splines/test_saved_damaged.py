"""A file that is no saved fit, or one no longer, is refused in one line and at no cost."""

from __future__ import annotations

import itertools
import os
import tracemalloc
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.saving import about, fields_of, fit_with_shape, version_1, with_about

Fields = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("fit") / "fit.npz"
    fit_with_shape().save(path)
    return path.read_bytes()


@pytest.fixture(scope="module")
def fields(whole: bytes, tmp_path_factory: pytest.TempPathFactory) -> Fields:
    path = tmp_path_factory.mktemp("fit") / "fit.npz"
    path.write_bytes(whole)
    return fields_of(path)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "fit.npz"


def refused(path: Path, message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.load(path)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 1000


def read_or_refused(path: Path) -> ss.SplineSDF | None:
    """The fit, or None if it was refused in one line; any other error or warning is raised."""
    try:
        return ss.load(path)
    except ss.InputError as caught:
        error = caught
    assert "\n" not in str(error)
    return None


TWO_63 = 2**63 - 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"version": np.array(4)}, "update splinesdf"),
        ({"version": np.array(1)}, "'name'"),
        ({"version": np.array(2.0)}, "version"),
        ({"format": np.array("other")}, "another .npz"),
        ({"format": np.array("x").view(np.uint32).reshape(())}, "format"),
        ({"domain": np.array([0.0, 0.0, -1.0, 1.0])}, "domain"),
        ({"domain": np.array([0.0, 0.0, np.nan, 1.0])}, "finite"),
        ({"domain": np.array([0.0, 0.0, 1e200, 1.0])}, r"up to 1e\+100"),
        ({"domain": np.array([1e9, 0.0, 1e9 + 1e-7, 1.0])}, "rounding"),
        ({"split": np.zeros(3, dtype=bool)}, "too few"),
        ({"split": np.zeros(10_000, dtype=bool)}, "too many"),
        ({"split": np.ones(10_000, dtype=bool)}, "too few"),
        (
            {
                "domain": np.array([0.0, 0.0, 1.0, 1.0]),
                "shape": np.array([1, 1]),
                "split": np.array([1] + 27 * [1, 0, 0, 0] + 4 * [0], dtype=bool),
            },
            "26 halvings",
        ),
        ({"shape": np.array([0, 4])}, "at least one cell"),
        ({"shape": np.array([-4, -4])}, "at least one cell"),
        ({"shape": np.array([2**62, 2**62])}, "too few"),
        ({"shape": np.array([2**63, 2], dtype=np.uint64)}, "too few"),
        ({"ordinates": np.zeros((3, 8))}, "ordinates"),
        ({"ordinates": np.full((1, 8), np.inf)}, "ordinates"),
        ({"ordinates": np.zeros((3, 8), dtype=complex)}, "ordinates"),
        ({"ordinates": np.zeros((3, 8), dtype=np.float32)}, "ordinates"),
        ({"extra": np.array(1)}, "fields"),
        ({"x\ny": np.array(1)}, "fields"),
        ({"x" * 5000: np.array(1)}, "fields"),
        ({"x": np.array([0.0, 1.0]), "y": np.array([0.0, 1.0])}, "fields"),
        ({"control": np.zeros((0, 2))}, "size"),
        ({"control": np.full((18, 2), 7.0)}, "size"),
        ({"control": np.full((18, 2), 1e61)}, "use another unit"),
        ({"control": np.full((18, 2), np.nan)}, "finite"),
        ({"control": np.zeros((18, 3))}, "control"),
        ({"control": np.random.default_rng(0).random((15, 2))}, "closed"),
        ({"starts": np.array([0, 2, 4, 6, 10, 13])}, "'starts' to go from 0 to 15"),
        ({"starts": np.array([0, 2, 3, 6, 10, 13, 15])}, "steps of at least 2"),
        ({"starts": np.array([0, 2, -TWO_63, TWO_63, 10, 13, 15])}, "steps of at least 2"),
        ({"starts": np.array([0, 2, 2**64 - 1, 15], dtype=np.uint64)}, "steps of at least 2"),
        ({"starts": np.array([2, 4, 6, 10, 13, 15])}, "'starts' to go from 0 to 15"),
        # Each is above the last one, if the differences are taken modulo 2 ** 64.
        (
            {"starts": np.array([0, 2**62, TWO_63, -(2**63) + 2**62 - 1, -1, 15])},
            "steps of at least 2",
        ),
        ({"starts": np.array([], dtype=int)}, "'starts' to go"),
        ({"starts": np.array([0.0, 2.0])}, "starts"),
        ({"loops": np.array([0, 4, 4, 6])}, "steps of at least 1"),
        ({"loops": np.array([0, 3, 6])}, "closed"),
        ({"loops": np.array([0])}, "'loops' to go"),
        ({"about": np.zeros(3, dtype=np.uint8)}, "JSON"),
        ({"about": np.array("{}")}, "about"),
    ],
)
def test_tampered_arrays_are_refused(
    fields: Fields, path: Path, change: Fields, message: str
) -> None:
    np.savez(path, **{**fields, **change})
    refused(path, message)


def change_about(key: str, value: Any) -> Callable[[dict[str, Any]], Any]:
    """A change of one entry, as "made.error"; None takes the entry away."""

    def change(said: dict[str, Any]) -> Any:
        *outer, last = key.split(".")
        inner = said
        for name in outer:
            inner = inner[name]
        if value is None:
            del inner[last]
        else:
            inner[last] = value
        return said

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda _: b"\xff{}", "JSON"),
        (lambda _: b"[" * 100_000, "JSON"),
        (lambda _: b'{"name": ' + b"9" * 5000 + b"}", "JSON"),
        (lambda _: [], "got 'list'"),
        (lambda said: {**said, "made": []}, "got 'list'"),
        (lambda said: {**said, "shape": None}, "no shape"),
        (change_about("name", None), "in 'about'"),
        (change_about("name", 1), "name as str"),
        (change_about("y_down", 1), "y_down as bool"),
        (change_about("more", 1), "in 'about'"),
        (change_about("shape.fill", "odd"), "fill"),
        (change_about("shape.fill", ["evenodd"]), "fill"),
        (change_about("shape.notes", "note"), "notes as list"),
        (change_about("shape.notes", [1]), "note as str"),
        (change_about("made.error", None), "in 'made'"),
        (change_about("made.error", "0"), "error"),
        (change_about("made.error", float("nan")), "error"),
        (change_about("made.error", 10**4000), "error"),
        (change_about("made.tolerance", -1), "tolerance"),
        (change_about("made.bands", [[1, 2, 3]]), "pairs"),
        (change_about("made.bands", {"0": 1}), "pairs"),
        (change_about("made.space", "tensor"), "mesh of the tensor space, got a quadtree"),
        (change_about("made.operator", "w"), "operator"),
        (change_about("made.evaluations", True), "count"),
        (change_about("made.evaluations", 1e3), "count"),
        (change_about("made.version", {}), "version"),
    ],
)
def test_tampered_words_are_refused(
    fields: Fields, path: Path, change: Callable[[dict[str, Any]], Any], message: str
) -> None:
    np.savez(path, **with_about(fields, change(about(fields))))
    refused(path, message)


@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([0.0], "grid lines in 'x'"),
        ([0.0, 0.0, 1.0], "grid lines in 'x'"),
        (list(range(999, 0, -1)), "grid lines in 'x'"),
        ([0.0, 5e-324], "grid lines in 'x'"),
        ([0.0, np.inf], "finite"),
        ([0.0, 1e-120], "domain"),
        ([0.0, 1.0, 2.0], "ordinates"),
    ],
)
def test_tampered_grids_are_refused(path: Path, x: list[float], message: str) -> None:
    grid = ss.fit(ss.Shape.from_points(((0, 0), (1, 0), (0, 1))), tolerance=0.5, space="uniform")
    grid.spline.save(path)
    np.savez(path, **{**fields_of(path), "x": np.array(x, dtype=float)})
    refused(path, message)


def test_every_missing_and_swapped_field(fields: Fields, path: Path) -> None:
    for missing in fields:
        np.savez(path, **{key: values for key, values in fields.items() if key != missing})
        refused(path, "expected")
    for one, other in itertools.combinations(fields, 2):
        np.savez(path, **{**fields, one: fields[other], other: fields[one]})
        refused(path, "expected")


def test_every_field_as_every_type_and_in_every_shape(fields: Fields, path: Path) -> None:
    kinds = [
        "?",
        "u1",
        "i2",
        "i4",
        "i8",
        ">i8",
        "u8",
        "f2",
        "f4",
        ">f8",
        "c16",
        "U3",
        "S3",
        "M8[s]",
    ]
    same = fit_with_shape()
    for key, values in fields.items():
        changed = [np.zeros(values.shape, dtype=kind) for kind in kinds]
        if values.dtype.kind in "iufb":
            changed += [values.astype(kind) for kind in ("i4", "u8", ">f8", ">i8")]
        changed += [values[None], values.ravel()[:0], np.repeat(values.ravel(), 2)]
        changed += [np.asfortranarray(values), np.zeros((0,) * 33), np.array(None)]
        for array in changed:
            np.savez(path, **{**fields, key: array})
            loaded = read_or_refused(path)
            if array.dtype.kind == "c" or array.dtype in ("f2", "f4", "i2"):
                assert loaded is None
            elif loaded is not None and key != "ordinates":
                assert np.array_equal(loaded.ordinates, same.ordinates)


@pytest.mark.parametrize("old", [False, True])
def test_flipped_bits_within_the_arrays(fields: Fields, path: Path, old: bool) -> None:
    """With checksums that are right: a fit that answers without a warning, or one line."""
    if old:
        np.savez(path, **version_1(fields))
        fields = fields_of(path)
    rng = np.random.default_rng(1)
    loaded = 0
    points = rng.uniform(-0.1, 1.1, (50, 2))
    for key, count in itertools.product(fields, range(25)):
        data = bytearray(fields[key].tobytes())
        for _ in range(1 + count % 2):
            data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
        array = np.frombuffer(data, dtype=fields[key].dtype).reshape(fields[key].shape)
        np.savez(path, **{**fields, key: array})
        spline = read_or_refused(path)
        if spline is not None:
            loaded += 1
            spline.value_and_gradient(points)
            assert spline.shape is None or np.isfinite(spline.shape.control).all()
    assert loaded > 20  # most bits of coordinates and ordinates may well be others


def test_files_cut_short(whole: bytes, path: Path) -> None:
    for length in range(0, len(whole), len(whole) // 50):
        path.write_bytes(whole[:length])
        refused(path, "damaged")


def test_flipped_bits_in_the_file(whole: bytes, path: Path) -> None:
    rng = np.random.default_rng(0)
    same = fit_with_shape()
    found = 0
    for _ in range(500):
        broken = bytearray(whole)
        broken[rng.integers(len(broken))] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        loaded = read_or_refused(path)
        if loaded is None:
            found += 1
        else:  # a bit that says nothing, as that of a date
            assert np.array_equal(loaded.ordinates, same.ordinates)
    assert found > 400


def test_other_bytes_at_either_end(whole: bytes, path: Path) -> None:
    rng = np.random.default_rng(2)
    for count in range(1, 60, 7):
        noise = rng.bytes(count)
        for data in (noise + whole, whole + noise, noise, whole[count:], whole + whole):
            path.write_bytes(data)
            read_or_refused(path)


def test_foreign_files(path: Path, tmp_path: Path) -> None:
    path.write_bytes(b"x,y\n0,0\n")
    refused(path, "damaged")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "hello")
    refused(path, "'readme.txt' is no array")
    np.savez(path, a=np.arange(3))
    refused(path, "another .npz")
    np.savez(path)
    refused(path, "another .npz")
    refused(tmp_path / "missing.npz", "does not exist")
    refused(tmp_path, "folder")
    os.mkfifo(tmp_path / "pipe.npz")
    refused(tmp_path / "pipe.npz", "not a regular file")
    refused(tmp_path / "null\0.npz", "null")
    refused(tmp_path / ("long" * 100), "cannot read")


def test_pickled_objects_are_not_run(fields: Fields, path: Path) -> None:
    np.savez(path, **{**fields, "about": np.array([print], dtype=object)})
    refused(path, "no array of plain numbers")


def test_members_encrypted_doubled_and_packed(fields: Fields, path: Path, whole: bytes) -> None:
    path.write_bytes(
        whole.replace(b"PK\x01\x02\x2d\x03\x2d\x00\x00", b"PK\x01\x02\x2d\x03\x2d\x00\x01")
    )
    refused(path, "damaged")
    path.write_bytes(whole)
    with (
        zipfile.ZipFile(path, "a") as archive,
        pytest.warns(UserWarning, match="Duplicate"),
    ):
        archive.writestr("about.npy", archive.read("about.npy"))
    refused(path, "two arrays have one name")
    np.savez_compressed(path, **fields)
    refused(path, "compressed")


def test_a_member_that_ends_before_its_claim(fields: Fields, path: Path) -> None:
    """The list of members says fewer bytes than the array has, with their checksum."""
    with zipfile.ZipFile(path, "w") as archive:
        for key, values in fields.items():
            with archive.open(f"{key}.npy", "w") as member:
                np.lib.format.write_array(member, values)
        info = archive.getinfo("ordinates.npy")
        info.compress_size -= 8
        stored = path.read_bytes()
        begin = info.header_offset + 30 + len(info.filename)
        info.CRC = zlib.crc32(stored[begin : begin + info.compress_size])
    refused(path, "'ordinates.npy' is cut short")


def test_flags_that_are_neither_0_nor_1(fields: Fields, path: Path) -> None:
    """NumPy counts them by adding them, so that a mask of them writes where it must not."""
    split = fields["split"].view(np.uint8).copy()
    split[split > 0] = 2
    np.savez(path, **{**fields, "split": split.view(bool)})
    refused(path, "flags other than 0 and 1")


def test_sizes_that_only_are_claimed(fields: Fields, path: Path) -> None:
    """A file of a few KB that claims terabytes is refused without asking for them."""
    for count in (10**6, 10**9, 2**40, 2**61, 10**19):
        with zipfile.ZipFile(path, "w") as archive:
            for key, values in fields.items():
                with archive.open(f"{key}.npy", "w") as member:
                    if key == "ordinates":
                        claim = {"descr": "<f8", "fortran_order": False, "shape": (count, 8)}
                        np.lib.format.write_array_header_1_0(member, claim)
                        member.write(values.tobytes())
                    else:
                        np.lib.format.write_array(member, values)
        refused_at_no_cost(path, "not as long as it claims")
    with zipfile.ZipFile(path, "w") as archive:
        for key, values in fields.items():
            with archive.open(f"{key}.npy", "w") as member:
                np.lib.format.write_array(member, values)
        info = archive.getinfo("ordinates.npy")
        info.file_size = info.compress_size = 2**31  # in the list of members, at the end
    refused_at_no_cost(path, "longer than the file")
    np.savez_compressed(path, **{**fields, "ordinates": np.zeros((10**6, 8))})
    refused_at_no_cost(path, "compressed")


def refused_at_no_cost(path: Path, message: str) -> None:
    tracemalloc.start()
    try:
        refused(path, message)
        assert tracemalloc.get_traced_memory()[1] < 4e6
    finally:
        tracemalloc.stop()


def test_headers_that_numpy_warns_of(whole: bytes, path: Path) -> None:
    """Python 2's long numbers, escapes that do not exist, and code."""
    header = b"'shape': (2,), }"
    assert header in whole
    for odd in (b"'shape': (2L), }", b"'sh\\pe': (2,),}", b"'shape': (x,), }", b"'shape': (-2,),}"):
        path.write_bytes(whole.replace(header, odd))
        refused(path, "damaged")
