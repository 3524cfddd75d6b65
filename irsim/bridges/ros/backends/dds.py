"""``dds``: a node of ROS 2 over DDS with Cyclone DDS, without a ROS installation.

These make a participant a node: topics are named ``rt/...`` and types ``...::dds_::Twist_``; the user data of endpoints
has the hash of the type; and the latched topic ``ros_discovery_info`` says which endpoints belong to which node.
"""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.topics import LATCHED, Qos, Topic
from irsim.common.extras import require

require("ros2", "cyclonedds", "rosbags")
from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic as DdsTopic

__all__ = ["CdrSample", "DdsBackend", "dds_type", "dds_type_name", "struct_type"]


_BASE: dict[str, Any] = {
    "bool": bool, "byte": types.byte, "char": types.uint8, "uint8": types.uint8, "int8": types.int8,
    "uint16": types.uint16, "int16": types.int16, "uint32": types.uint32, "int32": types.int32,
    "uint64": types.uint64, "int64": types.int64, "float32": types.float32, "float64": types.float64,
    "octet": types.byte, "string": str,
}  # fmt: skip
"""Name of a primitive type of messages -> type of DDS."""


class CdrSample:
    """A sample of a topic as CDR: it is neither encoded nor decoded by Cyclone DDS.

    Attributes:
        cdr: The content with its header of 4 bytes.
    """

    cdr: bytes

    def serialize(self, buffer: Any = None, endianness: Any = None, use_version_2: Any = None) -> bytes:
        """The bytes that are sent."""
        return self.cdr

    @classmethod
    def deserialize(cls, data: bytes, has_header: bool = True, use_version_2: Any = None) -> CdrSample:
        """A sample from what was received."""
        made = cls.__new__(cls)
        made.cdr = bytes(data)
        return made


def dds_type_name(kind: str, separator: str = "::") -> str:
    """Name of a type of ROS in DDS: ``geometry_msgs::msg::dds_::Twist_``."""
    package, space, name = kind.split("/")
    return separator.join((package, space, "dds_", f"{name}_"))


def struct_type(store: Any, kind: str, made: dict[str, Any] | None = None) -> Any:
    """The ``IdlStruct`` of a message.

    Args:
        store: Type store of rosbags, which has the definitions.
        kind: Type of the message.
        made: Types that exist already.
    """
    made = {} if made is None else made
    if kind not in made:
        _, fields = store.fielddefs[kind]
        members = {name: _member(store, definition, made) for name, definition in fields}
        made[kind] = make_idl_struct(kind.rpartition("/")[2], dds_type_name(kind, "."), members)
    return made[kind]


def dds_type(store: Any, kind: str) -> Any:
    """The type of a topic, whose samples are :class:`CdrSample`."""
    result = struct_type(store, kind)
    result.serialize = CdrSample.serialize
    result.deserialize = classmethod(CdrSample.deserialize.__func__)  # type: ignore[attr-defined]
    return result


def _member(store: Any, definition: Any, made: dict[str, Any]) -> Any:
    """Annotation of a member."""
    form, detail = definition
    if form.name == "BASE":
        kind, bound = detail
        return types.bounded_str[bound] if bound and kind == "string" else _BASE[kind]
    if form.name == "NAME":
        return struct_type(store, detail, made)
    inner, length = detail
    member = _member(store, inner, made)
    if form.name == "ARRAY":
        return types.array[member, length]
    return types.sequence[member, length] if length else types.sequence[member]


_INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_MAX_SAMPLES = 64
"""Samples that are taken from a reader at once; readers keep only the last ones anyway."""
_BLOCKED_NS = 100_000_000
"""Time for which a reliable writer may wait for a slow reader."""
LOOPBACK = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast>
</General><Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>40</MaxAutoParticipantIndex>
<Peers><Peer Address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""
"""Configuration of Cyclone DDS that never leaves this computer."""


class DdsBackend(Backend):
    """A participant of DDS that shows itself as a node of ROS 2.

    Args:
        node: The node.
        domain: Number of the domain (``ROS_DOMAIN_ID``).
        loopback: Whether to stay on this computer.
    """

    def __init__(self, node: Node, *, domain: int, loopback: bool) -> None:
        super().__init__(node)
        self.peer = f"ROS 2 over DDS, domain {domain}"
        self._writers: dict[Topic, Any] = {}
        self._readers: dict[Topic, Any] = {}
        self._owned: list[Any] = []
        try:
            self._open(domain, loopback)
        except DDSException as error:
            self.close()
            what = f"DDS cannot be started in domain {domain}: {error}"
            raise BridgeError("bridge-failed", what, "check the network and the variable CYCLONEDDS_URI") from None

    def _open(self, domain: int, loopback: bool) -> None:
        if loopback and not _domain_is_open(domain):
            self._own(Domain(domain, LOOPBACK))
        self.participant = self._own(DomainParticipant(domain, qos=DdsQos(Policy.Userdata(data=b"enclave=/;"))))
        made: dict[str, Any] = {}
        for topic in self.topics:
            entity = self._topic(f"rt{topic.name}", topic.kind, made)
            qos = _policies(topic.qos, self.messages.store.hash_rihs01(topic.kind))
            if topic.outgoing:
                self._writers[topic] = self._own(DataWriter(self.participant, entity, qos=qos))
            else:
                self._readers[topic] = self._own(DataReader(self.participant, entity, qos=qos))
        info = self._topic("ros_discovery_info", _INFO, made)
        self._discovery = self._own(DataWriter(self.participant, info, qos=_policies(LATCHED, "")))
        self._write(self._discovery, self.messages.cdr(self._entities(), _INFO))

    def publish(self, topic: Topic, message: Any) -> None:
        """Write a message."""
        self._write(self._writers[topic], self.messages.cdr(message, topic.kind))

    def poll(self) -> None:
        """Take what has come from the readers, of which each keeps the last messages only."""
        for topic, reader in self._readers.items():
            samples = [sample for sample in reader.take(N=_MAX_SAMPLES) if sample.sample_info.valid_data]
            for sample in samples:
                self.inbox.put(topic, sample.cdr)

    def close(self) -> None:
        """Delete all entities, which also tells the others that the node is gone."""
        self._writers, self._readers = {}, {}
        while self._owned:
            self._owned.pop().__del__()  # which deletes the entity once, however many references there are

    def _own(self, entity: Any) -> Any:
        self._owned.append(entity)
        return entity

    def _topic(self, name: str, kind: str, made: dict[str, Any]) -> Any:
        if kind not in made:
            made[kind] = dds_type(self.messages.store, kind)
        return self._own(DdsTopic(self.participant, name, made[kind]))

    def _write(self, writer: Any, cdr: bytes) -> None:
        sample = writer.topic.data_type.__new__(writer.topic.data_type)
        sample.cdr = cdr
        writer.write(sample)

    def _entities(self) -> Any:
        """The endpoints of the node, as ``ros_discovery_info`` lists them."""
        make = self.messages
        readers = [self._gid(reader) for reader in self._readers.values()]
        writers = [self._gid(writer) for writer in self._writers.values()]
        node = make("rmw_dds_common", "NodeEntitiesInfo")("/", self.node, readers, writers)
        return make("rmw_dds_common", "ParticipantEntitiesInfo")(self._gid(self.participant), [node])

    def _gid(self, entity: Any) -> Any:
        """Identifier of an endpoint: 16 bytes, in Humble followed by 8 zeros."""
        size = self.messages.gid_size
        content = entity.guid.bytes.ljust(size, b"\0")
        return self.messages("rmw_dds_common", "Gid")(np.frombuffer(content, dtype=np.uint8))


def _policies(qos: Qos, type_hash: str) -> Any:
    reliable = Policy.Reliability.Reliable(max_blocking_time=_BLOCKED_NS)
    return DdsQos(
        reliable if qos.reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if qos.latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(qos.depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        *([Policy.Userdata(data=f"typehash={type_hash};".encode())] if type_hash else []),
    )


def _domain_is_open(domain: int) -> bool:
    """Whether this process has participants in a domain already, which then keeps its configuration."""
    listing = Domain.__new__(Domain)
    listing._id = domain
    try:
        return bool(listing.get_participants())
    except DDSException:
        return False
