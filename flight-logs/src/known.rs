//! Definitions of common ROS 2 messages. `SQLite` bags recorded before ROS 2 Iron need them, because they contain no
//! definitions.

use super::definition::short;

/// Returns the definition of a common ROS 2 message type, such as `sensor_msgs/msg/Imu`; `None` for other types.
pub(crate) fn known(name: &str) -> Option<String> {
    let name = short(name);
    let (package, message) = name.split_once('/')?;
    if let Some(of) = message.strip_suffix("Stamped").filter(|_| package == "geometry_msgs") {
        let field = match of {
            "Vector3" => "vector",
            "PoseWithCovariance" => "pose",
            "TwistWithCovariance" => "twist",
            _ => &of.to_lowercase(),
        };
        let child = if of == "Transform" { "string child_frame_id\n" } else { "" };
        fields(&format!("geometry_msgs/{of}"))?;
        return Some(format!("std_msgs/Header header\n{child}{of} {field}"));
    }
    fields(&name).map(str::to_owned)
}

fn fields(name: &str) -> Option<&'static str> {
    Some(match name {
        "std_msgs/Bool" => "bool data",
        "std_msgs/Int8" => "int8 data",
        "std_msgs/UInt8" => "uint8 data",
        "std_msgs/Int16" => "int16 data",
        "std_msgs/UInt16" => "uint16 data",
        "std_msgs/Int32" => "int32 data",
        "std_msgs/UInt32" => "uint32 data",
        "std_msgs/Int64" => "int64 data",
        "std_msgs/UInt64" => "uint64 data",
        "std_msgs/Float32" => "float32 data",
        "std_msgs/Float64" => "float64 data",
        "std_msgs/String" => "string data",
        "geometry_msgs/Vector3" | "geometry_msgs/Point" => "float64 x\nfloat64 y\nfloat64 z",
        "geometry_msgs/Quaternion" => "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
        "geometry_msgs/Pose" => "Point position\nQuaternion orientation",
        "geometry_msgs/Transform" => "Vector3 translation\nQuaternion rotation",
        "geometry_msgs/Twist" | "geometry_msgs/Accel" => "Vector3 linear\nVector3 angular",
        "geometry_msgs/Wrench" => "Vector3 force\nVector3 torque",
        "geometry_msgs/PoseWithCovariance" => "Pose pose\nfloat64[36] covariance",
        "geometry_msgs/TwistWithCovariance" => "Twist twist\nfloat64[36] covariance",
        "nav_msgs/Odometry" => {
            "std_msgs/Header header\nstring child_frame_id\n\
             geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist"
        }
        "sensor_msgs/Imu" => {
            "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
             geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
             geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance"
        }
        "sensor_msgs/MagneticField" => {
            "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance"
        }
        "sensor_msgs/FluidPressure" => {
            "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance"
        }
        "sensor_msgs/Temperature" => {
            "std_msgs/Header header\nfloat64 temperature\nfloat64 variance"
        }
        "sensor_msgs/Range" => {
            "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n\
             float32 max_range\nfloat32 range"
        }
        "sensor_msgs/LaserScan" => {
            "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
             float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n\
             float32[] ranges\nfloat32[] intensities"
        }
        "sensor_msgs/JointState" => {
            "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort"
        }
        "sensor_msgs/Joy" => "std_msgs/Header header\nfloat32[] axes\nint32[] buttons",
        "sensor_msgs/NavSatStatus" => "int8 status\nuint16 service",
        "sensor_msgs/NavSatFix" => {
            "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n\
             float64[9] position_covariance\nuint8 position_covariance_type"
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::definition::{Definition, Dialect};
    use super::known;

    #[test]
    fn what_is_known_leads_to_numbers() {
        for (name, field) in [
            ("sensor_msgs/msg/Imu", "angular_velocity.x"),
            ("geometry_msgs/msg/PoseWithCovarianceStamped", "pose.pose.orientation.w"),
            ("geometry_msgs/msg/TransformStamped", "transform.rotation.w"),
            ("nav_msgs/msg/Odometry", "twist.twist.linear.x"),
            ("sensor_msgs/msg/NavSatFix", "status.service"),
            ("std_msgs/msg/Float32", "data"),
        ] {
            let text = known(name).unwrap();
            let definition = Definition::parse(name, &text, Dialect::Ros2).unwrap();
            assert!(definition.number(field).is_ok(), "{name}");
        }
        assert_eq!(known("own_msgs/msg/Own"), None);
    }
}
