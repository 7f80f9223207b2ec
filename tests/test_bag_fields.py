"""Fields of CDR messages as columns, against rosbags' deserialisation of each message."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any
from uuid import UUID

import numpy as np
import pytest
from bag_support import STORE, WORDS, random_message

from ltlc.inputs.messages.definitions import FieldType, MessageTypes, shipped
from ltlc.inputs.recordings.bags import passing
from ltlc.inputs.recordings.bags.cdr import columns
from ltlc.inputs.recordings.bags.messages import Messages, batch_of
from ltlc.inputs.recordings.bags.scalars import MisfitError
from ltlc.inputs.recordings.blocks import Samples
from ltlc.specification.expressions import Bytes, Each, Match, OfSlice, Parallel, PathStep

TYPES = MessageTypes(shipped())
NAMES = sorted(set(STORE.fielddefs) & set(TYPES.messages))
NOTHING = object()


def paths_from(type_: FieldType, chance: random.Random, depth: int = 0) -> list[tuple[PathStep, ...]]:
    """All paths to values from a value of `type_`, with some of the ways into each list."""
    if type_.is_list:
        if type_.base not in TYPES.messages:
            return [(), (chance.randrange(type_.length or 4),)]
        steps: list[PathStep] = [chance.randrange(type_.length or 4)]
        strings = [n for n, of in TYPES.messages[type_.base].fields.items() if of == FieldType("string")]
        if strings:
            steps.append(Match(chance.choice(strings), chance.choice(WORDS)))
        inner = paths_from(FieldType(type_.base), chance, depth + 1)
        each = [(Each(), *path) for path in inner if Each() not in path and is_plain(type_.base, path)]
        return [(step, *path) for step in steps for path in inner] + each
    if type_.base not in TYPES.messages:
        return [()]
    fields = TYPES.messages[type_.base].fields
    found = [(name, *path) for name, of in fields.items() for path in paths_from(of, chance, depth + 1)]
    names = [name for name, of in fields.items() if of == FieldType("string", 0)]
    lists = [name for name, of in fields.items() if of.is_list and of != FieldType("string", 0)]
    for name in lists if names else ():
        step = Parallel(chance.choice(names), chance.choice(WORDS))
        inner = paths_from(FieldType(fields[name].base), chance, depth + 1)
        found += [(name, step, *path) for path in inner]
    return found


def is_plain(base: str, path: tuple[PathStep, ...]) -> bool:
    """Whether `path` leads to one value in every message of the type."""
    type_ = FieldType(base)
    for step in path:
        if isinstance(step, str):
            type_ = TYPES.messages[type_.base].fields[step]
        elif type_.length and isinstance(step, int):
            type_ = FieldType(type_.base)
        else:
            return False
    return not type_.is_list


def value_at(message: Any, path: Sequence[PathStep]) -> Any:
    """The value by definition: NOTHING where the path leads nowhere."""
    for depth, step in enumerate(path):
        match step:
            case str():
                outer, message = message, getattr(message, step)
            case int():
                if len(message) <= step:
                    return NOTHING
                message = message[step]
            case Match(key, value):
                found = [each for each in message if getattr(each, key) == value]
                if not found:
                    return NOTHING
                message = found[0]
            case Parallel(names, value):
                beside = getattr(outer, names)
                if value not in beside or len(message) <= beside.index(value):
                    return NOTHING
                message = message[beside.index(value)]
            case Bytes():
                return str(UUID(bytes=bytes(message))) if len(message) == 16 else bytes(message).hex()
            case OfSlice():
                raise AssertionError(step)
            case Each():
                return tuple(value_at(each, path[depth + 1 :]) for each in message)
    return tuple(getattr(message, "tolist", lambda: message)()) if is_list(message) else plain(message)


def is_list(value: Any) -> bool:
    return isinstance(value, list | np.ndarray) and not np.isscalar(value)


def plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def listed(samples: Samples | None, count: int) -> list[Any]:
    values: list[Any] = [NOTHING] * count
    if samples is not None:
        for row, value in zip(samples.rows.tolist(), samples.listed(), strict=True):
            values[row] = value
    return values


def packed(name: str, written: Sequence[Any], chance: random.Random, endless: bool = False) -> Messages:
    data = [bytes(STORE.serialize_cdr(each, name, little_endian=endless or chance.random() < 0.8)) for each in written]
    return batch_of(data, list(range(len(data))), list(range(len(data))))


@pytest.mark.parametrize("seed", range(4))
def test_every_path_through_every_type_gives_what_rosbags_gives(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where elements that nobody reads are stepped over in all messages at once."""
    monkeypatch.setattr(passing, "WORTH", passing.WORTH if seed % 2 else 0)
    chance = random.Random(seed)
    compared = 0
    for name in NAMES:
        messages = [random_message(name, chance) for _ in range(chance.randint(1, 6))]
        cdr = packed(name, messages, chance, endless=seed == 0)
        possible = sorted(set(paths_from(FieldType(name), chance)), key=repr)
        paths = chance.sample(possible, min(len(possible), chance.choice((1, 3, 20))))
        found = columns(TYPES, name, paths, cdr)
        for path in paths:
            expected = [value_at(each, path) for each in messages]
            assert listed(found.get(path), len(messages)) == expected, (name, path)
            compared += len(messages)
    assert compared > 2000


def test_rows_of_samples_ascend() -> None:
    chance = random.Random(7)
    name = "tf2_msgs/msg/TFMessage"
    messages = [random_message(name, chance) for _ in range(50)]
    path = ("transforms", Match("child_frame_id", "map"), "transform", "translation", "x")
    rows = columns(TYPES, name, [path], packed(name, messages, chance))[path].rows
    assert 0 < len(rows) < 50
    assert (np.diff(rows) > 0).all()


@pytest.mark.parametrize("name", ["nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/LaserScan"])
def test_a_message_that_is_cut_off_is_a_misfit(name: str) -> None:
    chance = random.Random(3)
    raw = bytes(STORE.serialize_cdr(random_message(name, chance), name))
    paths = paths_from(FieldType(name), chance)
    whole = batch_of([raw, raw], [0, 1], [0, 1])
    assert columns(TYPES, name, paths, whole)
    for length in range(0, len(raw) - 8, 5):
        with pytest.raises(MisfitError):
            columns(TYPES, name, paths, batch_of([raw, raw[:length], raw], [0, 1, 2], [0, 1, 2]))


def test_a_message_ends_where_its_definition_says_or_is_padded_to_four_bytes() -> None:
    chance = random.Random(11)
    for name in NAMES:
        raw = packed(name, [random_message(name, chance)], chance).data.tobytes()
        path = chance.choice(sorted(set(paths_from(FieldType(name), chance)), key=repr) or [()])
        padded = raw + chance.randbytes(-len(raw) % 4)
        assert fits(name, path, raw), name
        assert fits(name, path, padded), name
        for more in range(1, 12):
            if (len(raw) + more) != len(padded):
                assert not fits(name, path, raw + bytes(more)), (name, more)
        assert not fits(name, path, raw[:-1]), name


def fits(name: str, path: Sequence[PathStep], raw: bytes) -> bool:
    """Whether messages, of which one is `raw` and two are others, are as they are defined."""
    other = bytes(STORE.serialize_cdr(random_message(name, random.Random(1)), name))
    try:
        columns(TYPES, name, [tuple(path)], batch_of([other, raw, other], [0, 1, 2], [0, 1, 2]))
    except MisfitError:
        return False
    return True


def test_noise_is_a_misfit_or_a_value_and_never_another_error() -> None:
    chance = random.Random(5)
    misfits = 0
    for name in NAMES:
        data = [bytes([0, 1, 0, 0]) + chance.randbytes(chance.randint(0, 300)) for _ in range(2)]
        try:
            columns(TYPES, name, paths_from(FieldType(name), chance)[:20], batch_of(data, [0, 1], [0, 1]))
        except MisfitError:
            misfits += 1
    assert misfits > 50


def test_an_unknown_encoding_is_a_misfit() -> None:
    raw = bytes([0, 7, 0, 0]) + bytes(100)
    with pytest.raises(MisfitError):
        columns(TYPES, "std_msgs/msg/Float64", [("data",)], batch_of([raw], [0], [0]))


def test_text_that_is_not_utf_8_is_read_as_rclpy_reads_it() -> None:
    raw = bytes([0, 1, 0, 0, 4, 0, 0, 0]) + b"a\xfcb\0"
    found = columns(TYPES, "std_msgs/msg/String", [("data",)], batch_of([raw], [0], [0]))
    assert found[("data",)].listed() == ["a\ufffdb"]


def test_integers_of_a_matched_element_stay_exact_beside_one_that_has_none() -> None:
    name, types = "rcl_interfaces/msg/ParameterEventDescriptors", STORE.types

    def descriptor(called: str, *steps: int) -> Any:
        ranges = [types["rcl_interfaces/msg/IntegerRange"](0, 1, step) for step in steps]
        return types["rcl_interfaces/msg/ParameterDescriptor"](called, 0, "", "", False, False, [], ranges)

    message = types[name]([descriptor("a"), descriptor("b", 2**64 - 1)], [], [])
    other = types[name]([descriptor("b")], [], [])
    path = ("new_parameters", Match("name", "b"), "integer_range", Each(), "step")
    found = columns(TYPES, name, [path], packed(name, [other, message], random.Random(0)))
    assert listed(found.get(path), 2) == [(), (2**64 - 1,)]
