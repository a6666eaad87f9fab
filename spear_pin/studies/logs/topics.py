"""Topics of an MCAP file as columns: numbers of JSON or protobuf messages by topic and field, on the log's clock."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin.errors import BadFile, import_extra, list_names
from spear_pin.studies.tables.columns import Table
from spear_pin.studies.tables.units import TIME

PURPOSE = "a log in an MCAP file"
LONGEST = 64  # entries of a list, beyond which it is a picture or a shape


def read_topics(path: Path, wanted: Sequence[str]) -> list[Table]:
    """Reads the first message of each topic, and all messages of topics that have wanted columns.

    Columns have names by topic and field, such as "/joint_states.knee.position"; "time" is in ns.

    Raises:
        BadFile: the file cannot be read.
        MissingExtra: the library that reads it is not installed.
    """
    reader, decoder = (import_extra(name, "logs", PURPOSE) for name in ("mcap.reader", "mcap_protobuf.decoder"))
    rows, closed = dict[str, list[tuple[int, dict[str, float]]]](), set[str]()
    factory = decoder.DecoderFactory()
    decoders = dict[int, Callable[[bytes], Any] | None]()
    try:
        with path.open("rb") as file:
            for schema, channel, message in reader.make_reader(file).iter_messages():
                topic = channel.topic
                if topic in rows and not any(name.startswith(f"{topic}.") for name in wanted):
                    continue
                if channel.id not in decoders:
                    decoders[channel.id] = _decoder(factory, channel.message_encoding, schema)
                if (decode := decoders[channel.id]) is None:
                    closed.add(topic)
                else:
                    rows.setdefault(topic, []).append((message.log_time, dict(_numbers(topic, decode(message.data)))))
    except Exception as error:  # a damaged file may raise anything
        raise BadFile(path, f"not an MCAP file that can be read: {str(error) or type(error).__name__}") from None
    remarks = (f"topics in neither JSON nor protobuf: {list_names(sorted(closed))}",) if closed else ()
    return [_topic(path, each, remarks if i == 0 else ()) for i, each in enumerate(rows.values())]


def _topic(path: Path, rows: Sequence[tuple[int, dict[str, float]]], remarks: tuple[str, ...]) -> Table:
    names = dict.fromkeys(name for _, numbers in rows for name in numbers)
    values = {name: np.array([numbers.get(name, np.nan) for _, numbers in rows]) for name in names}
    times = np.array([time for time, _ in rows], dtype=float)
    return Table(path, {TIME: times, **values}, {TIME: "ns"}, remarks=remarks)


def _decoder(factory: Any, encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
    """Returns the function that decodes messages, None if there is none."""
    if encoding == "json":
        return json.loads
    if (decode := factory.decoder_for(encoding, schema)) is None:
        return None
    from google.protobuf.json_format import MessageToDict

    return lambda data: MessageToDict(
        decode(data), preserving_proto_field_name=True, always_print_fields_with_no_presence=True
    )


def _numbers(name: str, content: Any) -> Iterator[tuple[str, float]]:
    """Yields the numbers of a message with the names of the fields that lead to them.

    Entries of a list are named by their own `name`, by the list of names beside it, as in ROS's JointState, or counted.
    """
    if isinstance(content, bool | int | float):
        yield name, float(content)
    elif isinstance(content, Mapping):
        found = content.get("name")
        names = found if isinstance(found, list) else []
        for key, each in content.items():
            numbers = isinstance(each, list) and all(isinstance(entry, int | float) for entry in each)
            if numbers and names and len(names) == len(each):
                yield from ((f"{name}.{own}.{key}", float(entry)) for own, entry in zip(names, each, strict=True))
            else:
                yield from _numbers(f"{name}.{key}", each)
    elif isinstance(content, list) and len(content) <= LONGEST:
        for i, each in enumerate(content):
            own = each.get("name", i) if isinstance(each, Mapping) else i
            yield from _numbers(f"{name}.{own}", each)
