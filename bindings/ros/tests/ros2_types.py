"""Messages of ROS 2 as Eclipse Cyclone DDS has them, with ROS's names on the wire."""

from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32 = 0
    nanosec: types.uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time = field(default_factory=Time)
    frame_id: str = "base_link"


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str = ""


@dataclass
class Float64(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    data: types.float64 = 0.0


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0
    w: types.float64 = 1.0


Covariance = types.array[types.float64, 9]


@dataclass
class Imu(IdlStruct, typename="sensor_msgs::msg::dds_::Imu_"):
    header: Header = field(default_factory=Header)
    orientation: Quaternion = field(default_factory=Quaternion)
    orientation_covariance: Covariance = (0.0,) * 9
    angular_velocity: Vector3 = field(default_factory=Vector3)
    angular_velocity_covariance: Covariance = (0.0,) * 9
    linear_acceleration: Vector3 = field(default_factory=Vector3)
    linear_acceleration_covariance: Covariance = (0.0,) * 9


@dataclass
class Spyke(IdlStruct, typename="spyke_msgs::msg::dds_::Spyke_"):
    spike: types.int8
    start: types.float32
    min_input: types.float32
    max_input: types.float32
    threshold: types.float32
    input: types.float32
    scheme: str
    timestamp: Time


@dataclass
class SpykeArray(IdlStruct, typename="spyke_msgs::msg::dds_::SpykeArray_"):
    spike: types.sequence[types.int8]
    start: types.float32
    min_input: types.float32
    max_input: types.float32
    threshold: types.float32
    input: types.float32
    scheme: str
    timestamp: Time


@dataclass
class SpykeValue(IdlStruct, typename="spyke_msgs::msg::dds_::SpykeValue_"):
    value: types.float64
    timestamp: Time


@dataclass
class Spike(IdlStruct, typename="spikewire_msgs::msg::dds_::Spike_"):
    address: types.uint16
    slot: types.uint16
    polarity: types.int8


@dataclass
class Spikes(IdlStruct, typename="spikewire_msgs::msg::dds_::Spikes_"):
    header: Header
    sample: types.uint64
    spikes: types.sequence[Spike]
    start: types.sequence[types.float32]


@dataclass
class Values(IdlStruct, typename="spikewire_msgs::msg::dds_::Values_"):
    header: Header
    values: types.sequence[types.float64]


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: types.byte
    name: str
    message: str
    hardware_id: str
    values: types.sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: types.sequence[DiagnosticStatus]
